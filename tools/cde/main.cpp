#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "cde/error.hpp"
#include "verbs.hpp"

int main(int argc, char** argv) {
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
    fmt::print(stderr, "cde: {}\n", e.what());
    return cde::exit_status(e.code());
  } catch (const std::exception& e) {
    fmt::print(stderr, "cde: internal error: {}\n", e.what());
    return 2;
  }
  return cde::cli::exit_code;
}
