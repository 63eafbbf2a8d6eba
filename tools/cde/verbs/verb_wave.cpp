// SPDX-License-Identifier: Apache-2.0
// cde wave: asks wave files (FST).
#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/output_file.hpp"
#include "command/values.hpp"
#include "verbs/verbs.hpp"
#include "wave/guarded.hpp"
#include "wave/request.hpp"
#include "wave/tui_terminal.hpp"

namespace cde::cli {
namespace {

struct Command {
  const char* name;
  int (*run)(const wave::Request&);
  std::vector<std::string> options;  ///< those it takes, beside --json
};

const std::vector<Command>& commands() {
  static const std::vector<Command> kAll = {
      {"info", wave::info, {"--clock"}},
      {"ls", wave::list, {"--max"}},
      {"at", wave::values_at, {"--clock", "--as", "--max"}},
      {"show",
       wave::show,
       {"--from", "--to", "--around", "--window", "--columns", "--ascii", "--clock", "--as",
        "--max"}},
      {"find",
       wave::find,
       {"--on", "--when", "--first", "--last", "--count", "--from", "--to", "--around", "--window",
        "--clock", "--max"}},
      {"diff", wave::diff, {"--align", "--as", "--ulp", "--eps", "--ignore", "--clock", "--max"}},
      {"stat", wave::statistics, {"--from", "--to", "--around", "--window", "--clock", "--max"}},
      {"export",
       wave::export_waves,
       {"--output", "--format", "--on", "--from", "--to", "--around", "--window", "--columns",
        "--clock", "--as"}},
      {"serve",
       wave::serve,
       {"--output", "--from", "--to", "--around", "--window", "--clock", "--as", "--structure",
        "--max"}},
      {"tui",
       wave::terminal_viewer,
       {"--diff", "--from", "--to", "--around", "--window", "--ascii", "--clock", "--as"}},
      {"tx",
       wave::transaction_table,
       {"--where", "--histogram", "--csv", "--from", "--to", "--around", "--window", "--columns",
        "--ascii", "--clock", "--max"}},
      {"why", wave::why, {"--depth", "--structure", "--as", "--clock", "--max"}},
  };
  return kAll;
}

const Command& command_named(const std::string& name) {
  const auto& all = commands();
  return *std::find_if(all.begin(), all.end(), [&](const Command& c) { return c.name == name; });
}

/// An option that is given and that the command would not heed is an error.
void check_options(const CLI::App& verb, const Command& command) {
  for (const CLI::Option* o : verb.get_options()) {
    if (o->get_positional() || o->count() == 0) continue;
    const std::string name = names(*o).back();
    if (name != "--json" &&
        std::find(command.options.begin(), command.options.end(), name) == command.options.end())
      throw Error(ErrorCode::kUsage,
                  fmt::format("cde wave {} does not take {}; it takes {}", command.name, name,
                              fmt::join(command.options, ", ")));
  }
}

void add_options(CLI::App& verb, wave::Request& r) {
  text_value(
      verb.add_option("--as", r.form,
                      "How values are written where no :FORM behind the signal says it: hex, "
                      "dec, signed, bin, fp32, fp16, bf16, tf32, fp64, ... or eEmM; /32 "
                      "behind it is the bits of a lane")
          ->capture_default_str(),
      "FORM", [](const std::string& text) {
        if (!wave::parse_form(text))
          throw Error(ErrorCode::kUsage,
                      fmt::format("no form {}; there are: {}, and eEmM", in_quotes(text),
                                  fmt::join(wave::form_names(), ", ")));
      });
  text_value(verb.add_option("--clock", r.clock,
                             "Signal whose rising edges are cycles (the outermost clk, clk_i, "
                             "clock, aclk or i_clk)"),
             "SIGNAL", {});
  text_value(verb.add_option("--from", r.from, "First time: 120ns, cyc:7, start, end-3cyc, ..."),
             "TIME", {});
  text_value(verb.add_option("--to", r.to, "Last time"), "TIME", {});
  text_value(verb.add_option("--around", r.around, "Middle of a window, e.g. fail"), "TIME", {});
  whole_number_in(verb.add_option("--window", r.window,
                                  "Cycles of the clock before and behind --around; without a clock "
                                  "units of the file; 10 if it is not given"),
                  1, 1000000000, "");
  whole_number_in(verb.add_option("--columns", r.columns, "Width of the picture (the terminal's)"),
                  40, 10000, "");
  verb.add_flag("--ascii", r.ascii, "Draw with ASCII alone");
  text_value(
      verb.add_option("--on", r.on,
                      "find: look only at these edges, 'posedge SIGNAL', negedge or edge, and "
                      "at the values just before them, as a flip-flop sees them"),
      "EDGE", {});
  text_value(verb.add_option("--when", r.when, "find: only where this is true as well"),
             "EXPRESSION", {});
  verb.add_flag("--first", r.first, "find: the first place alone");
  verb.add_flag("--last", r.last, "find: the last place alone");
  verb.add_flag("--count", r.count, "find: how many places there are");
  one_of(verb.add_option("--align", r.align,
                         "diff: compare what is at the same times, before the same rising edges of "
                         "the clocks, or change by change of each signal, whenever it comes")
             ->capture_default_str(),
         {"time", "cycle", "event"});
  whole_number_in(verb.add_option("--ulp", r.ulp,
                                  "diff: numbers of the format --as that are so many words apart "
                                  "are the same"),
                  0, 1000000000000, "");
  number_in(verb.add_option("--eps", r.eps, "diff: so are those that differ by so much"), 0, 1e300,
            "");
  text_value(verb.add_option("--ignore", r.ignore,
                             "diff: leave out signals of this pattern; may be given several times"),
             "GLOB", {});
  file_value(verb.add_option("-o,--output", r.output,
                             "serve: the page, an HTML file; export: the file to write; its name "
                             "ends in .vcd, .csv, .json (WaveDrom), .svg, .fst or .gtkw (GTKWave), "
                             "or --format says what it is (stdout)"),
             "FILE");
  one_of(verb.add_option("--format", r.format, "export: what is written, whatever its name"),
         {"vcd", "csv", "wavedrom", "svg", "fst", "gtkw"});
  text_value(verb.add_option("--where", r.where,
                             "tx: those alone for which this is true, e.g. 'words > 4 && outcome "
                             "!= done' or master=card"),
             "CONDITION", {});
  text_value(verb.add_option("--histogram", r.histogram,
                             "tx: how often a field has which value, e.g. latency"),
             "FIELD", {});
  verb.add_flag("--csv", r.csv, "tx: CSV on stdout");
  whole_number_in(verb.add_option("--depth", r.depth, "why: registers that are looked through")
                      ->capture_default_str(),
                  0, 1000, "");
  file_value(
      verb.add_option("--structure", r.structure,
                      "why, serve: the design of the waves, as `verilator -O0 --xml-only` or "
                      "--json-only writes it (FILE.tree.json, with its .tree.meta.json beside it); "
                      "waves of a card name theirs"),
      "FILE");
  whole_number_in(verb.add_option("--max", r.max,
                                  "Most lines, 0 for all; serve: most megabytes of the page (32)")
                      ->capture_default_str(),
                  0, 1000000000, "");
  file_value(
      verb.add_option("--diff", r.other, "tui: a second file beside; what differs is marked"),
      "FILE");
  verb.add_flag("--json", r.json, "JSON on stdout");
}

/// Of an output whose writer has crashed.
void remove_remains(const std::filesystem::path& output) {
  if (!output.has_filename() || output == "-") return;
  const auto folder = output.has_parent_path() ? output.parent_path() : ".";
  sweep_unfinished(folder, output.filename().native());
}

}  // namespace

void add_wave(CLI::App& app) {
  auto r = std::make_shared<wave::Request>();
  CLI::App* verb = app.add_subcommand(
      "wave",
      "Ask a wave file (FST). info FILE: what it is; ls FILE [GLOB]: its "
      "signals; at FILE TIME SIGNAL "
      "...: values at a time; show FILE SIGNAL ...: waves drawn as text; find "
      "FILE EXPRESSION: where "
      "it is true; diff A B: where signals of two files part first; stat FILE [SIGNAL "
      "...]: how busy signals, handshakes and pipes are; export FILE [SIGNAL "
      "...] --output FILE: other kinds of files; tx FILE [KIND ...]: "
      "transactions of a card; why FILE SIGNAL@TIME: what made a signal have its value; serve FILE "
      "[SIGNAL ...] --output PAGE.html: a page to look at them; tui FILE [SIGNAL ...]: a viewer on "
      "the terminal");
  std::vector<std::string> words;
  for (const Command& c : commands()) words.emplace_back(c.name);
  named(verb->add_option("command", r->command, "What is asked")->required(), words, "COMMAND",
        "command of cde wave");
  file_value(
      verb->add_option("file", r->file, "Wave file, FST, of --trace or any other")->required(),
      "FILE");
  verb->add_option(
      "words", r->words,
      "What the command takes: a pattern, a time, an expression, the other file; signals as "
      "NAME, NAME[3], NAME[7:4], NAME:fp32, or NAME[3]:fp32, which is lane 3");
  add_options(*verb, *r);
  verb->callback([r, verb] {
    const Command& command = command_named(r->command);
    check_options(*verb, command);
    if (r->command == "serve" && verb->get_option("--max")->count() == 0) r->max = 32;
    try {
      // A viewer that crashes leaves the terminal to the process that waits for it.
      const wave::tui::Terminal terminal;
      std::function<void()> crashed;
      if (r->command == "tui") crashed = [&] { terminal.restore(); };
      const int status = wave::guarded(
          r->file, [&] { exit_code = command.run(*r); }, crashed);
      if (status >= 0) exit_code = status;
    } catch (const Error&) {
      remove_remains(r->output);
      throw;
    }
  });
}

}  // namespace cde::cli
