// SPDX-License-Identifier: Apache-2.0
// cde: the verbs of rays, pairs and scenes. It starts the programs of the other verbs.
#include <string>
#include <vector>

#include "output/streams.hpp"
#include "program/program.hpp"
#include "program/programs.hpp"
#include "verbs/verbs.hpp"

namespace {

const cde::cli::Program kProgram = {
    .name = "cde",
    .description = "cde: a collision detection engine in SystemVerilog on a simulated PCI card",
    .add_verbs = [](CLI::App& app) {
      cde::cli::add_cast(app);
      cde::cli::add_render(app);
      cde::cli::add_query(app);
      cde::cli::add_run(app);
      cde::cli::add_plan(app);
      cde::cli::add_fp(app);
      cde::cli::add_merge(app, [](const std::vector<std::string>& words) {
        return cde::cli::run_program(kProgram, words);
      });
      cde::cli::add_doctor(app);
      cde::cli::add_other_verbs(app);
      cde::cli::add_version(app);
      cde::cli::add_help(app);  // lists the verbs that are added before it
    }};

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1)
    if (const cde::cli::VerbEntry* entry = cde::cli::verb_elsewhere(argv[1]))
      return cde::cli::other_program(*entry, {argv + 1, argv + argc});
  return cde::cli::program_main(kProgram, argc, argv);
}
