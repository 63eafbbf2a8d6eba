// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "cde/support/error.hpp"
#include "command/help.hpp"
#include "command/typed.hpp"
#include "output/output.hpp"
#include "output/streams.hpp"
#include "output/version.hpp"
#include "ranks/dealing.hpp"
#include "verbs/verbs.hpp"

/// "cde: message" on stderr; the message may have text of files.
static void complain(const std::string& message) {
  const bool colour = cde::cli::may_colour(STDERR_FILENO);
  std::fputs(colour ? "\033[1;31mcde:\033[0m " : "cde: ", stderr);
  cde::say(message + "\n");
}

static int run(const std::vector<std::string>& words);

static void add_verbs(CLI::App& app) {
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
  cde::cli::add_accuracy(app);
  cde::cli::add_advise(app);
  cde::cli::add_merge(app, run);
  cde::cli::add_explain(app);
  cde::cli::add_wave(app);
  cde::cli::add_doctor(app);
  cde::cli::add_fp(app);
  cde::cli::add_help(app);                                    // knows those before it
  app.set_help_all_flag("--help-all", "Help of every verb");  // not one of the verbs
}

/// What the words ask for; the exit status.
static int run(const std::vector<std::string>& words) {
  CLI::App app{"cde: a collision detection engine in SystemVerilog on a simulated PCI card", "cde"};
  add_verbs(app);
  if (words.empty()) {
    cde::say(app.help());
    return 2;
  }
  std::vector<std::string> args = cde::cli::understood(app, words);
  std::reverse(args.begin(), args.end());  // CLI11 takes them from the back
  try {
    app.parse(args);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);  // help and version, on stdout
    throw cde::Error(cde::ErrorCode::kUsage, e.what());
  }
  return cde::cli::exit_code;
}

int main(int argc, char** argv) {
  std::signal(SIGXFSZ,
              SIG_IGN);  // a file that may not grow is an error of the write, with a message
  cde::cli::prepare_streams();
  cde::cli::remove_unfinished_on_signals();
  std::optional<cde::cli::Dealing> dealing;
  bool ended = false;
  const int status = cde::cli::exit_status_of(
      [&] {
        const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
        dealing.emplace().start(words);
        const int code = run(words);
        dealing->end();
        ended = true;
        return code;
      },
      [&](const std::string& message) { complain((dealing ? dealing->place() : "") + message); });
  if (dealing && !ended) dealing->fail(status);
  return status;
}
