// SPDX-License-Identifier: Apache-2.0
#include "options/help.hpp"
#include <CLI/CLI.hpp>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <utility>

#include "options/values.hpp"
#include "output/output.hpp"

namespace cde::cli {
namespace {

constexpr std::size_t kIndent = 2, kColumn = 26;

std::size_t terminal_width() {
  std::size_t columns = 0;
  winsize size{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0) columns = size.ws_col;
  // COLUMNS is what a user sets for a pipe into a pager.
  if (columns == 0)
    if (const char* text = std::getenv("COLUMNS"))  // NOLINT(concurrency-mt-unsafe)
      columns = std::strtoul(text, nullptr, 10);
  if (columns == 0) columns = 80;
  return std::clamp<std::size_t>(columns, 40, 120);
}

/// Text of a help page, wrapped as it comes.
class Page {
 public:
  Page(std::size_t width, bool colour) : width_(width), colour_(colour) {}

  void paragraph(std::string_view text, std::size_t indent = 0) {
    for (const std::string& line : wrapped(text, width_ - indent))
      text_ += std::string(indent, ' ') + line + "\n";
  }
  /// As it is: a command is there to be copied.
  void line(const std::string& text) { text_ += text + "\n"; }
  void heading(const std::string& text) { text_ += "\n" + in_bold(text, colour_) + "\n"; }

  /// A name to the left, what it is to the right of it, or below if the name is long.
  void entry(const std::string& name, std::string_view text) {
    const std::size_t column = std::min(kColumn, width_ / 2);
    std::string line = std::string(kIndent, ' ') + in_bold(name, colour_);
    std::size_t used = kIndent + name.size();
    if (used + 1 >= column) {
      text_ += line + "\n";
      line.clear();
      used = 0;
    }
    for (const std::string& part : wrapped(text, width_ - column)) {
      text_ += line + std::string(column - used, ' ') + part + "\n";
      line.clear();
      used = 0;
    }
    if (!line.empty()) text_ += line + "\n";
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::size_t width_;
  bool colour_;
  std::string text_;
};

void add_options(Page& page, const CLI::App& app) {
  const auto positional = shown_options(app, true), options = shown_options(app, false);
  if (!positional.empty()) page.heading("Arguments");
  for (const CLI::Option* o : positional) page.entry(option_head(*o), option_text(*o));
  for (const bool advanced : {false, true}) {
    bool first = true;
    for (const CLI::Option* o : options) {
      if ((o->get_group() == kAdvancedGroup) != advanced) continue;
      if (std::exchange(first, false)) page.heading(advanced ? kAdvancedGroup : "Options");
      page.entry(option_head(*o), option_text(*o));
    }
  }
}

class Formatter : public CLI::FormatterBase {
 public:
  std::string make_help(const CLI::App* app, std::string /*name*/,
                        CLI::AppFormatMode mode) const override {
    Page page(terminal_width(), may_colour(STDOUT_FILENO));
    page.paragraph(app->get_description());
    page.heading("Usage");
    page.paragraph(usage_line(*app), kIndent);
    const auto verbs = shown_verbs(*app);
    if (!verbs.empty()) page.heading("Verbs");
    for (const CLI::App* verb : verbs) {
      const std::string text = verb->get_description();
      page.entry(verb->get_name(), text.substr(0, text.find(". ")));
    }
    add_options(page, *app);
    const auto& all = examples(verb_name(*app));
    if (!all.empty()) page.heading("Examples");
    for (const Example& example : all) {
      page.paragraph(example.what + ":", kIndent);
      page.line("    " + example.command);
    }
    page.heading("Exit status");
    for (const HelpEntry& e : exit_statuses()) page.entry(e.name, e.text);
    page.heading("Environment");
    for (const HelpEntry& e : environment()) page.entry(e.name, e.text);
    std::string text = page.text();
    if (mode == CLI::AppFormatMode::All)
      for (const CLI::App* verb : verbs)
        text += "\n" + make_help(verb, "", CLI::AppFormatMode::Sub);
    return text;
  }
};

}  // namespace

const std::vector<Example>& examples(std::string_view verb) {
  static const std::map<std::string_view, std::vector<Example>> kAll = {
      {"",
       {{"cde render bunny.ply", "Draw a mesh, every pixel a ray through the simulated card"},
        {"cde run meshes/scenes/mixed.toml --report page.html", "Play a scene and see it"}}},
      {"cast",
       {{"cde cast bunny.ply --grid 64x64 -o hits.csv", "A grid of rays straight down"},
        {"cde cast terrain --ray 1450,2000,900,0,0,-1 --ray 100,100,900,0,0,-1 -o -",
         "Two rays straight down at the built-in terrain, records on stdout"}}},
      {"render",
       {{"cde render bunny.ply --up y --size 640x480 --shaded bunny.png",
         "A picture of a mesh whose y axis points up"},
        {"cde render terrain --shaded sun.png --shadows --image depth.pfm",
         "Sunlight with shadows, and the depths"}}},
      {"merge",
       {{"cde merge part1.journal part2.journal part3.journal",
         "What three runs with --shard 1/3, 2/3 and 3/3 come to"},
        {"cde merge shards/*", "Of as many as there are, in any order"}}},
      {"query",
       {{"echo '0,0,0,1, 1.5,0,0,1' | cde query sphere-sphere", "Two spheres: centre and radius"},
        {"cde query ray-triangle --algorithm watertight --bits < pairs.csv",
         "Pairs from a text by another algorithm, answers as bits"},
        {"cde query obb-obb pairs.npy -o answers.csv", "Pairs of an array, 30 numbers each"}}},
      {"run",
       {{"cde run meshes/scenes/spheres.toml --frames 0..3 -o spheres.run",
         "Four frames of a scene"},
        {"cde run meshes/scenes/mixed.toml --report page.html", "A page about the run"}}},
      {"plan",
       {{"cde plan meshes/scenes/spheres.toml", "What the card of a scene has, and why"},
        {"cde plan meshes/scenes/flight.toml --json", "The same for programs"}}},
      {"bench",
       {{"cde bench --quick", "All sections, small"},
        {"cde bench rays bus --json", "Two sections for programs"}}},
      {"reproduce",
       {{"cde reproduce -o figures.html", "The figures of the paper on this machine"},
        {"cde reproduce --quick --json", "A small run for programs"}}},
      {"inventory",
       {{"cde inventory sphere-sphere obb-obb", "Two pairs"},
        {"cde inventory --markdown > inventory.md", "All pipes as tables for a document"}}},
      {"accuracy",
       {{"cde accuracy --pair obb-obb,ray-triangle --formats fp16,fp32 --by-family",
         "Errors and wrong decisions of two pairs in two formats, family by family"},
        {"cde accuracy --cases 100000 --resume accuracy.journal --json -o accuracy.json",
         "Everything, in a run that may be stopped and started again"}}},
      {"advise",
       {{"cde advise --max-error 1e-3 --no-leaks --max-wrong 1000 --time 10ms",
         "The cheapest ray-triangle pipe that is as good and takes a million tests in 10 ms"},
        {"cde advise --pair obb-obb --max-error 1e-2 --time 10ms --target assumed:200MHz --from "
         "accuracy.json",
         "Of a sweep of one's own, at a clock that no device is asked for"}}},
      {"explain",
       {{"cde explain sphere-sphere '0 0 0 1 | 1.5 0 0 1'",
         "Every operator of the pipe beside the reference's, with its clock and line"},
        {"cde explain --from-record meshes/scenes/mixed.toml:seen:0:7",
         "How the record of a primary of a scene came about, in query seen of frame 0"}}},
      {"wave",
       {{"cde wave show waves.fst clk_i 't_o[0]:fp32' --around cyc:40 --window 5",
         "Waves of a clock and a lane as text, five cycles before and behind cycle 40"},
        {"cde wave find waves.fst 'isnan(t_o[3]:fp32)' --on 'posedge clk_i' --first",
         "The first clock edge at which lane 3 is NaN"}}},
      {"doctor",
       {{"cde doctor", "See whether everything is here that the command needs"},
        {"CDE_CLANG=clang++-16 cde doctor", "The same for another compiler of bitstreams"}}},
      {"version",
       {{"cde version", "The same as cde --version"}, {"cde version | head -n 1", "That of cde"}}},
      {"help", {{"cde help cast", "One verb"}, {"cde --help-all | less", "All of them"}}},
      {"fp",
       {{"echo '3F800000 40000000' | cde fp add", "1 + 2 in binary32"},
        {"testfloat_gen f16_mul | cde fp f16_mul | testfloat_ver f16_mul",
         "Half precision, judged by Berkeley TestFloat"}}},
  };
  static const std::vector<Example> kNone;
  const auto found = kAll.find(verb);
  return found == kAll.end() ? kNone : found->second;
}

const std::vector<HelpEntry>& exit_statuses() {
  static const std::vector<HelpEntry> kAll = {
      {"0", "all is well"},
      {"1",
       "doctor found something wrong, wave find, wave tx or advise nothing, or wave diff a "
       "difference"},
      {"2", "an option, a file or another input makes no sense, or an output cannot be written"},
      {"3", "the card's records differ from the reference"},
      {"4", "a deadline passed, or the card failed otherwise"},
      {"128 + N", "ended by signal N; what was not whole is removed"}};
  return kAll;
}

const std::vector<HelpEntry>& environment() {
  static const std::vector<HelpEntry> kAll = {
      {"CDE_CACHE", "folder where bitstreams are kept once they are built (~/.cache/cde)"},
      {"CDE_BITSTREAMS", "folder that is searched for bitstreams before all others"},
      {"CDE_SHARE",
       "folder with rtl/, verilator/ and host/include/, from which bitstreams are built"},
      {"CDE_PRICES", "table of measured prices instead of docs/prices.json"},
      {"CDE_CLANG", "compiler of bitstreams (clang++)"},
      {"CDE_MARCH", "processor that bitstreams are compiled for, as -march has it (native)"},
      {"CDE_MESH_MEMORY",
       "MB that importing a mesh may take (512 and 64 times the file, up to 2048)"},
      {"CDE_MESH_SECONDS", "seconds that importing a mesh may take (30)"},
      {"CDE_WAVES", "folder: every card that a program opens writes waves, board-N.fst"},
      {"CDE_ASSERT", "1: bitstreams with the assertions of the RTL"},
      {"NO_COLOR", "not empty: no colours, on a terminal either"}};
  return kAll;
}

std::vector<std::string> wrapped(std::string_view text, std::size_t width) {
  std::vector<std::string> lines;
  std::string line;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t stop = std::min(text.find(' ', at), text.size());
    const std::string_view word = text.substr(at, stop - at);
    at = stop + 1;
    if (word.empty()) continue;
    if (!line.empty() && line.size() + 1 + word.size() > width) {
      lines.push_back(line);
      line.clear();
    }
    if (!line.empty()) line += ' ';
    line += word;
  }
  if (!line.empty()) lines.push_back(line);
  return lines;
}

std::vector<const CLI::Option*> shown_options(const CLI::App& app, bool positional) {
  return app.get_options([positional](const CLI::Option* o) {
    return !o->get_group().empty() && o->get_positional() == positional;
  });
}

std::vector<const CLI::App*> shown_verbs(const CLI::App& app) {
  return app.get_subcommands(
      [](const CLI::App* verb) { return !verb->get_group().empty() && !verb->get_name().empty(); });
}

std::string command_name(const CLI::App& app) {
  if (app.get_parent() == nullptr) return app.get_name();
  return command_name(*app.get_parent()) + ' ' + app.get_name();
}

std::string verb_name(const CLI::App& app) {
  const std::string name = command_name(app);
  return name == "cde" ? "" : name.substr(name.find(' ') + 1);
}

std::string usage_line(const CLI::App& app) {
  std::string line = command_name(app) + (app.get_parent() == nullptr ? " VERB" : "");
  for (const CLI::Option* o : shown_options(app, true)) {
    const std::string head = option_head(*o);
    line += o->get_required() ? " " + head : " [" + head + "]";
  }
  return line + " [OPTIONS]";
}

std::string option_head(const CLI::Option& option) {
  const Takes what = takes(option);
  if (option.get_positional()) {
    std::string name = option.get_name(true);
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    return name + (option.get_expected_max() > 1 ? " ..." : "");
  }
  const std::string head = fmt::format("{}", fmt::join(names(option), ", "));
  return what.label.empty() ? head : head + " " + what.label;
}

std::string option_text(const CLI::Option& option) {
  std::string text = option.get_description();
  const std::string value = option.get_default_str();
  if (!value.empty() && takes(option).kind != Takes::Kind::kNothing)
    text += fmt::format(" [{}]", value);
  return text;
}

bool may_colour(int stream) {
  const char* no_colour = std::getenv("NO_COLOR");  // NOLINT(concurrency-mt-unsafe)
  const char* terminal = std::getenv("TERM");       // NOLINT(concurrency-mt-unsafe)
  return on_terminal(stream) && (no_colour == nullptr || *no_colour == '\0') &&
         terminal != nullptr && std::string_view(terminal) != "dumb";
}

std::string in_bold(const std::string& text, bool colour) {
  return colour ? "\033[1m" + text + "\033[0m" : text;
}

std::shared_ptr<CLI::FormatterBase> help_formatter() {
  return std::make_shared<Formatter>();
}

}  // namespace cde::cli
