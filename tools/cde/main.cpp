#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <string>
#include <vector>

#include "help.hpp"
#include "output.hpp"
#include "streams.hpp"
#include "suggest.hpp"
#include "verbs.hpp"
#include "version.hpp"

/// "cde: message" on stderr; the message may have text of files.
static void complain(const std::string& message) {
  const bool colour = cde::cli::may_colour(STDERR_FILENO);
  std::fputs(colour ? "\033[1;31mcde:\033[0m " : "cde: ", stderr);
  cde::say(message + "\n");
}

/// What the parser did not understand; 2, or 0 if it was a question.
static int explain(const CLI::App& app, const CLI::ParseError& e,
                   const std::vector<std::string>& words) {
  if (e.get_exit_code() == 0) return app.exit(e);  // help and version, on stdout
  if (app.get_subcommands().empty()) {
    if (const auto verb = cde::cli::unknown_verb(app, words)) {
      complain(*verb);
      return 2;
    }
    if (words.empty()) {
      cde::say(app.help());
      return 2;
    }
  }
  const auto rest = cde::cli::left_over(app);
  complain(rest ? *rest : e.what());
  return 2;
}

/// What the words ask for; the exit status.
static int run(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return explain(app, e, {argv + std::min(argc, 1), argv + argc});
  }
  return cde::cli::exit_code;
}

int main(int argc, char** argv) {
  std::signal(SIGXFSZ,
              SIG_IGN);  // a file that may not grow is an error of the write, with a message
  cde::cli::prepare_streams();
  cde::cli::remove_unfinished_on_signals();
  CLI::App app{"cde: a collision detection engine in SystemVerilog on a simulated PCI card", "cde"};
  app.formatter(cde::cli::help_formatter());
  app.require_subcommand(1);
  app.set_version_flag("--version", cde::cli::version_text(), "Versions of cde and its tools");
  cde::cli::add_cast(app);
  cde::cli::add_query(app);
  cde::cli::add_run(app);
  cde::cli::add_plan(app);
  cde::cli::add_bench(app);
  cde::cli::add_reproduce(app);
  cde::cli::add_inventory(app);
  cde::cli::add_doctor(app);
  cde::cli::add_fp(app);
  cde::cli::add_help(app);                                    // knows those before it
  app.set_help_all_flag("--help-all", "Help of every verb");  // not one of the verbs
  return cde::cli::exit_status_of([&] { return run(app, argc, argv); }, complain);
}
