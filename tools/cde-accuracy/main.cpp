// SPDX-License-Identifier: Apache-2.0
#include "verbs.hpp"

namespace {

const cde::cli::Program kProgram = {
    .name = "cde",
    .description = "cde-accuracy: accuracy of the pipes and its cost",
    .add_verbs = [](CLI::App& app) {
      cde::cli::add_accuracy(app);
      cde::cli::add_advise(app);
      cde::cli::add_merge(app, [](const std::vector<std::string>& words) {
        return cde::cli::run_program(kProgram, words);
      });
    }};

}  // namespace

int main(int argc, char** argv) {
  return cde::cli::program_main(kProgram, argc, argv);
}
