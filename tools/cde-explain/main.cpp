// SPDX-License-Identifier: Apache-2.0
#include "verbs.hpp"

namespace {

const cde::cli::Program kProgram = {
    .name = "cde",
    .description = "cde-explain: finds where a wrong answer of the card begins",
    .add_verbs = [](CLI::App& app) {
      cde::cli::add_explain(app);
      cde::cli::add_pack(app);
    }};

}  // namespace

int main(int argc, char** argv) {
  return cde::cli::program_main(kProgram, argc, argv);
}
