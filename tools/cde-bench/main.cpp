// SPDX-License-Identifier: Apache-2.0
#include "verbs.hpp"

namespace {

const cde::cli::Program kProgram = {
    .name = "cde",
    .description = "cde-bench: speed of the simulated card compared with software",
    .add_verbs = [](CLI::App& app) {
      cde::cli::add_bench(app);
      cde::cli::add_reproduce(app);
      cde::cli::add_inventory(app);
    }};

}  // namespace

int main(int argc, char** argv) {
  return cde::cli::program_main(kProgram, argc, argv);
}
