#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <string>

#include "cde/error.hpp"
#include "verbs.hpp"

/// Unlike fmt::print, never an exception: there may be no room for messages either.
static void say(const std::string& message) {
  std::fputs(message.c_str(), stderr);
}

int main(int argc, char** argv) {
  std::signal(SIGXFSZ,
              SIG_IGN);  // a file that may not grow is an error of the write, with a message
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
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  } catch (const cde::Error& e) {
    say(fmt::format("cde: {}\n", e.what()));
    return cde::exit_status(e);
  } catch (const std::exception& e) {
    say(fmt::format("cde: internal error: {}\n", e.what()));
    return 2;
  }
  return cde::cli::exit_code;
}
