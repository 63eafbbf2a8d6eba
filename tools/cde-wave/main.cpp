// SPDX-License-Identifier: Apache-2.0
// cde-wave: answers questions about wave files (FST, VCD). Each command is a verb with its own
// options.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/output_file.hpp"
#include "cde/wave/guarded.hpp"
#include "commands/commands.hpp"
#include "options/help.hpp"
#include "options/typed.hpp"
#include "options/values.hpp"
#include "program/program.hpp"
#include "tui/tui_terminal.hpp"

namespace cde::cli {
namespace {

struct Command {
  const char *name, *text, *words;
  int (*run)(const wave::Request&);
  std::vector<std::string> options;  ///< in addition to --json
};

const std::vector<Command>& commands() {
  static const std::vector<Command> kAll = {
      {"info",
       "Print facts about the file: time unit, scopes, clock, comments",
       "",
       wave::info,
       {"--clock"}},
      {"ls",
       "List signals that match a pattern",
       "GLOB: a pattern of names",
       wave::list,
       {"--max"}},
      {"at",
       "Print values at a time",
       "TIME SIGNAL ...",
       wave::values_at,
       {"--clock", "--as", "--max"}},
      {"show",
       "Draw waves as text",
       "SIGNAL ...",
       wave::show,
       {"--from", "--to", "--around", "--window", "--columns", "--ascii", "--clock", "--as",
        "--max"}},
      {"find",
       "Find where an expression is true",
       "EXPRESSION",
       wave::find,
       {"--on", "--when", "--first", "--last", "--count", "--from", "--to", "--around", "--window",
        "--clock", "--max"}},
      {"diff",
       "Find where signals of two files differ first",
       "The second FILE, then SIGNAL ...",
       wave::diff,
       {"--align", "--as", "--ulp", "--eps", "--ignore", "--clock", "--max"}},
      {"stat",
       "Measure how busy signals, handshakes and pipes are",
       "SIGNAL ...",
       wave::statistics,
       {"--from", "--to", "--around", "--window", "--clock", "--max"}},
      {"export",
       "Write waves in other file formats",
       "SIGNAL ...",
       wave::export_waves,
       {"--output", "--format", "--on", "--from", "--to", "--around", "--window", "--columns",
        "--clock", "--as"}},
      {"serve",
       "Write an HTML page that shows the waves",
       "SIGNAL ...",
       wave::serve,
       {"--output", "--from", "--to", "--around", "--window", "--clock", "--as", "--structure",
        "--max"}},
      {"tui",
       "View the waves on the terminal",
       "SIGNAL ...",
       wave::terminal_viewer,
       {"--diff", "--from", "--to", "--around", "--window", "--ascii", "--clock", "--as"}},
      {"tx",
       "List transactions of a card",
       "KIND ...",
       wave::transaction_table,
       {"--where", "--histogram", "--csv", "--from", "--to", "--around", "--window", "--columns",
        "--ascii", "--clock", "--max"}},
      {"why",
       "Find why a signal has its value",
       "SIGNAL@TIME",
       wave::why,
       {"--depth", "--structure", "--as", "--clock", "--max"}},
  };
  return kAll;
}

/// The heading of an option in the help.
const char* heading_of(const std::string& option) {
  static const std::map<std::string, const char*> kHeadings = {
      {"--clock", "Times"},       {"--from", "Times"},         {"--to", "Times"},
      {"--around", "Times"},      {"--window", "Times"},       {"--on", "Which places"},
      {"--when", "Which places"}, {"--where", "Which places"}, {"--first", "Which places"},
      {"--last", "Which places"}, {"--count", "Which places"}, {"--align", "Comparison"},
      {"--ulp", "Comparison"},    {"--eps", "Comparison"},     {"--ignore", "Comparison"},
      {"--diff", "Comparison"},   {"--structure", "Design"},   {"--depth", "Design"}};
  const auto found = kHeadings.find(option);
  return found == kHeadings.end() ? "Output" : found->second;
}

using Adder = std::function<void(CLI::App&, wave::Request&)>;

/// Functions that add each option. Several commands share an option.
const std::map<std::string, Adder>& adders() {
  static const std::map<std::string, Adder> kAll = {
      {"--as",
       [](CLI::App& verb, wave::Request& r) {
         text_value(
             verb.add_option(
                     "--as", r.form,
                     "Form of values of signals without :FORM: hex, dec, signed, bin, fp32, fp16, "
                     "bf16, tf32, fp64, ... or eEmM; /32 after it sets the bits per lane")
                 ->capture_default_str(),
             "FORM", [](const std::string& text) {
               if (!wave::parse_form(text))
                 throw Error(ErrorCode::kUsage,
                             fmt::format("no form {}; there are: {}, and eEmM", in_quotes(text),
                                         fmt::join(wave::form_names(), ", ")));
             });
       }},
      {"--clock",
       [](CLI::App& verb, wave::Request& r) {
         text_value(verb.add_option("--clock", r.clock, "Signal whose rising edges count cycles")
                        ->default_str("the outermost clk, clk_i, clock, aclk or i_clk"),
                    "SIGNAL", {});
       }},
      {"--from",
       [](CLI::App& verb, wave::Request& r) {
         text_value(
             verb.add_option("--from", r.from, "First time: 120ns, cyc:7, start, end-3cyc, ..."),
             "TIME", {});
       }},
      {"--to",
       [](CLI::App& verb, wave::Request& r) {
         text_value(verb.add_option("--to", r.to, "Last time"), "TIME", {});
       }},
      {"--around",
       [](CLI::App& verb, wave::Request& r) {
         text_value(verb.add_option("--around", r.around, "Middle of a window, e.g. fail"), "TIME",
                    {});
       }},
      {"--window",
       [](CLI::App& verb, wave::Request& r) {
         whole_number_in(
             verb.add_option(
                     "--window", r.window,
                     "Cycles before and after --around; without a clock, time units of the file")
                 ->default_str("10"),
             1, 1000000000, "");
       }},
      {"--columns",
       [](CLI::App& verb, wave::Request& r) {
         whole_number_in(verb.add_option("--columns", r.columns, "Width in characters")
                             ->default_str("the terminal's"),
                         40, 10000, "");
       }},
      {"--ascii",
       [](CLI::App& verb, wave::Request& r) {
         verb.add_flag("--ascii", r.ascii, "Draw with ASCII only");
       }},
      {"--on",
       [](CLI::App& verb, wave::Request& r) {
         text_value(
             verb.add_option("--on", r.on,
                             "Evaluate only at these edges ('posedge SIGNAL', negedge or edge), "
                             "with the values just before them, as a flip-flop samples them"),
             "EDGE", {});
       }},
      {"--when",
       [](CLI::App& verb, wave::Request& r) {
         text_value(verb.add_option("--when", r.when, "Only where this expression is also true"),
                    "EXPRESSION", {});
       }},
      {"--first",
       [](CLI::App& verb, wave::Request& r) {
         verb.add_flag("--first", r.first, "Print only the first place");
       }},
      {"--last",
       [](CLI::App& verb, wave::Request& r) {
         verb.add_flag("--last", r.last, "Print only the last place");
       }},
      {"--count",
       [](CLI::App& verb, wave::Request& r) {
         verb.add_flag("--count", r.count, "Print only the number of places");
       }},
      {"--align",
       [](CLI::App& verb, wave::Request& r) {
         one_of(verb.add_option("--align", r.align,
                                "Compare values at the same times, before the same rising edges of "
                                "the clocks, or change by change of each signal at any time")
                    ->capture_default_str(),
                {"time", "cycle", "event"});
       }},
      {"--ulp",
       [](CLI::App& verb, wave::Request& r) {
         whole_number_in(verb.add_option("--ulp", r.ulp,
                                         "Numbers in the format of --as are equal if at most this "
                                         "many representable numbers apart"),
                         0, 1000000000000, "");
       }},
      {"--eps",
       [](CLI::App& verb, wave::Request& r) {
         number_in(
             verb.add_option("--eps", r.eps, "Numbers are equal if they differ by at most this"), 0,
             1e300, "");
       }},
      {"--ignore",
       [](CLI::App& verb, wave::Request& r) {
         text_value(verb.add_option("--ignore", r.ignore,
                                    "Ignore signals that match this pattern; repeatable"),
                    "GLOB", {});
       }},
      {"--output",
       [](CLI::App& verb, wave::Request& r) {
         file_value(verb.add_option("-o,--output", r.output,
                                    "The file to write. serve: an HTML page. export: a name that "
                                    "ends in .vcd, .csv, .json (WaveDrom), .svg, .fst or .gtkw "
                                    "(GTKWave), or any name with --format")
                        ->default_str("stdout"),
                    "FILE");
       }},
      {"--format",
       [](CLI::App& verb, wave::Request& r) {
         one_of(verb.add_option("--format", r.format, "Format of the file, for any name"),
                {"vcd", "csv", "wavedrom", "svg", "fst", "gtkw"});
       }},
      {"--where",
       [](CLI::App& verb, wave::Request& r) {
         text_value(verb.add_option("--where", r.where,
                                    "Only transactions for which this is true, e.g. 'words > 4 && "
                                    "outcome != done' or master=card"),
                    "CONDITION", {});
       }},
      {"--histogram",
       [](CLI::App& verb, wave::Request& r) {
         text_value(verb.add_option("--histogram", r.histogram,
                                    "Count the values of a field, e.g. latency"),
                    "FIELD", {});
       }},
      {"--csv",
       [](CLI::App& verb, wave::Request& r) { verb.add_flag("--csv", r.csv, "CSV on stdout"); }},
      {"--depth",
       [](CLI::App& verb, wave::Request& r) {
         whole_number_in(verb.add_option("--depth", r.depth, "Registers to look through")
                             ->capture_default_str(),
                         0, 1000, "");
       }},
      {"--structure",
       [](CLI::App& verb, wave::Request& r) {
         file_value(
             verb.add_option("--structure", r.structure,
                             "The design of the waves, as `verilator -O0 --xml-only` or "
                             "--json-only writes it (FILE.tree.json, with its .tree.meta.json "
                             "beside it). Waves of a card name their design"),
             "FILE");
       }},
      {"--max",
       [](CLI::App& verb, wave::Request& r) {
         whole_number_in(
             verb.add_option("--max", r.max, "Most lines, or most megabytes of a page; 0: no limit")
                 ->capture_default_str(),
             0, 1000000000, "");
       }},
      {"--diff",
       [](CLI::App& verb, wave::Request& r) {
         file_value(verb.add_option("--diff", r.other,
                                    "A second file to show beside it; differences are marked"),
                    "FILE");
       }},
      {"--json",
       [](CLI::App& verb, wave::Request& r) { verb.add_flag("--json", r.json, "JSON on stdout"); }},
  };
  return kAll;
}

/// Adds exclusions between options. Options that a command does not have are skipped.
void add_exclusions(CLI::App& verb, const Command& command) {
  const auto pair = [&](const char* option, const std::vector<std::string>& others) {
    if (verb.get_option_no_throw(option) != nullptr) excludes(verb, option, others);
  };
  const auto needs = [&](const char* option, const char* other) {
    CLI::Option *first = verb.get_option_no_throw(option),
                *second = verb.get_option_no_throw(other);
    if (first != nullptr && second != nullptr) first->needs(second);
  };
  pair("--around", {"--from", "--to"});
  needs("--window", "--around");
  pair("--first", {"--last", "--count"});
  pair("--last", {"--count"});
  if (command.run == wave::find) pair("--max", {"--first", "--last", "--count"});
  pair("--csv", {"--json", "--histogram"});
  pair("--ascii", {"--json"});
  needs("--ascii", "--histogram");
  needs("--columns", "--histogram");
  if (command.run != wave::export_waves) pair("--columns", {"--json"});
}

/// Removes unfinished files that a crashed writer left beside an output.
void remove_remains(const std::filesystem::path& output) {
  if (!output.has_filename() || output == "-") return;
  const auto folder = output.has_parent_path() ? output.parent_path() : ".";
  sweep_unfinished(folder, output.filename().native());
}

void run(const Command& command, const wave::Request& r) {
  try {
    // If the viewer crashes, the waiting process restores the terminal.
    const wave::tui::Terminal terminal;
    std::function<void()> crashed;
    if (r.command == "tui") crashed = [&] { terminal.restore(); };
    const int status = wave::guarded(
        r.file, [&] { exit_code = command.run(r); }, crashed);
    if (status >= 0) exit_code = status;
  } catch (const Error&) {
    remove_remains(r.output);
    throw;
  }
}

void add_command(CLI::App& app, const Command& command) {
  auto r = std::make_shared<wave::Request>();
  r->command = command.name;
  if (r->command == "serve") r->max = 32;
  CLI::App* verb = app.add_subcommand(command.name, command.text);
  file_value(
      verb->add_option("file", r->file,
                       "Wave file, FST or VCD, from --trace or any other program; - is stdin")
          ->required(),
      "FILE");
  if (*command.words != '\0')
    verb->add_option("words", r->words,
                     fmt::format("{}; a signal is NAME, NAME[3], NAME[7:4], NAME:fp32, or "
                                 "NAME[3]:fp32, which is lane 3",
                                 command.words));
  std::vector<std::string> options = command.options;
  if (command.run != wave::terminal_viewer) options.emplace_back("--json");
  for (const std::string& option : options) {
    begin_group(*verb, heading_of(option));
    adders().at(option)(*verb, *r);
  }
  add_exclusions(*verb, command);
  verb->callback([r, &command] { run(command, *r); });
}

const Program kProgram = {
    .name = "cde wave",
    .description = "cde wave: answer questions about a wave file (FST, VCD) of a simulation",
    .add_verbs = [](CLI::App& app) {
      for (const Command& command : commands()) add_command(app, command);
    }};

}  // namespace
}  // namespace cde::cli

int main(int argc, char** argv) {
  return cde::cli::program_main(cde::cli::kProgram, argc, argv);
}
