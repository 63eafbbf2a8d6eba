// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "options/cli_fwd.hpp"

/// The main function of all programs of the command.
namespace cde::cli {

/// The exit status of a verb that ran but found a difference, or found nothing. A verb sets it to 1
/// instead of throwing.
inline int exit_code = 0;

struct Program {
  std::string name;         ///< as users type it: "cde", "cde wave"
  std::string description;  ///< "cde: a collision detection engine ..."
  std::function<void(CLI::App&)> add_verbs;
};

/// Runs the words of a command line; returns the exit status.
using CommandRun = std::function<int(const std::vector<std::string>&)>;

/// Adds the verb that merges shards; `again` runs the merged command.
void add_merge(CLI::App& app, const CommandRun& again);
/// Adds the hidden verb write-manual, which the build calls.
void add_write_manual(CLI::App& app);

/// Parses and runs the words in this program.
int run_program(const Program& program, const std::vector<std::string>& words);

/// The work of main(): streams, signals, ranks, errors as messages on stderr, exit status.
int program_main(const Program& program, int argc, char** argv);

}  // namespace cde::cli
