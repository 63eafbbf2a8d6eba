#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <string>

#include "output.hpp"
#include "streams.hpp"
#include "verbs.hpp"

static void complain(const std::string& message) {
  cde::say(fmt::format("cde: {}\n", message));
}

/// What the words ask for; the exit status.
static int run(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  return cde::cli::exit_code;
}

int main(int argc, char** argv) {
  std::signal(SIGXFSZ,
              SIG_IGN);  // a file that may not grow is an error of the write, with a message
  cde::cli::prepare_streams();
  cde::cli::remove_unfinished_on_signals();
  CLI::App app{"cde: a collision detection engine in SystemVerilog on a simulated PCI card"};
  app.require_subcommand(1);
  app.set_help_all_flag("--help-all", "Help of every verb");
  cde::cli::add_cast(app);
  cde::cli::add_query(app);
  cde::cli::add_run(app);
  cde::cli::add_plan(app);
  cde::cli::add_bench(app);
  cde::cli::add_reproduce(app);
  cde::cli::add_inventory(app);
  cde::cli::add_doctor(app);
  cde::cli::add_fp(app);
  return cde::cli::exit_status_of([&] { return run(app, argc, argv); }, complain);
}
