// SPDX-License-Identifier: Apache-2.0
#include "program/program.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <optional>

#include "cde/jobs/work_distributor.hpp"
#include "cde/support/error.hpp"
#include "cde/support/suggest.hpp"
#include "cde/support/version.hpp"
#include "options/help.hpp"
#include "options/typed.hpp"
#include "output/output.hpp"
#include "output/streams.hpp"
#include "program/programs.hpp"

namespace cde::cli {
namespace {

/// Prints "cde: message" on stderr. The message may contain text from files and long words.
void complain(const std::string& message) {
  std::fputs(may_colour(STDERR_FILENO) ? "\033[1;31mcde:\033[0m " : "cde: ", stderr);
  log(shortened(message) + "\n");
}

/// Prints the help of the program and of its verbs and, if this is cde, the help of the other
/// programs. A missing program is named, with status 2.
int print_all_help(const Program& program, CLI::App& app) {
  const bool is_cde = this_program() == "cde";
  std::string text;
  if (is_cde || program.name != "cde") text = app.help() + "\n";
  for (const CLI::App* verb : shown_verbs(app)) {
    if (program.name == "cde" && verb_elsewhere(verb->get_name()) != nullptr) continue;
    text += verb->help() + "\n";
  }
  OutputFile out("-");
  out.write(text);
  out.commit();
  int status = 0;
  if (is_cde)
    for (const std::string& other : other_programs())
      status = std::max(status, run_other_program(other, {"--help-all"}));
  return status;
}

}  // namespace

int run_program(const Program& program, const std::vector<std::string>& words) {
  CLI::App app{program.description, program.name};
  app.formatter(help_formatter());
  app.require_subcommand(1);
  app.set_version_flag("--version", version_text(), "Versions of cde and its tools");
  program.add_verbs(app);
  add_write_manual(app);
  app.set_help_all_flag("--help-all",
                        "Help of every verb");  // only for the program, not for its verbs
  if (words.empty()) {
    log(app.help());
    return 2;
  }
  std::vector<std::string> args = normalise_arguments(app, words);
  if (args == std::vector<std::string>{"--help-all"}) return print_all_help(program, app);
  std::reverse(args.begin(), args.end());  // CLI11 takes the words from the end
  try {
    app.parse(args);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);  // help and version, on stdout
    throw Error(ErrorCode::kUsage, e.what());
  }
  return exit_code;
}

int program_main(const Program& program, int argc, char** argv) {
  // A write beyond the limit of file size is then an error with a message.
  std::signal(SIGXFSZ, SIG_IGN);
  prepare_streams();
  remove_unfinished_on_signals();
  show_progress_on_terminal();
  std::optional<WorkDistributor> distributor;
  bool ended = false;
  const int status = exit_status_of(
      [&] {
        need_proc();
        check_environment_names();
        const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
        distributor.emplace().start(words);
        const int code = run_program(program, words);
        distributor->end();
        ended = true;
        return code;
      },
      [&](const std::string& message) {
        complain((distributor ? distributor->place() : "") + message);
      });
  if (distributor && !ended) distributor->fail(status);
  return status;
}

}  // namespace cde::cli
