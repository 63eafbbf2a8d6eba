// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "command/cli_fwd.hpp"

/// Each verb of the `cde` command lives in verbs/verb_NAME.cpp and registers itself here. A verb's
/// callback throws cde::Error; main turns it into a message on stderr and an exit status. Data goes
/// to stdout, everything else to stderr.
namespace cde::cli {

/// Set by a verb that ran but found a difference or nothing (exit 1) instead of throwing.
inline int exit_code = 0;

/// Runs the words of a command; its exit status.
using CommandRun = std::function<int(const std::vector<std::string>&)>;

void add_accuracy(CLI::App& app);
void add_advise(CLI::App& app);
void add_bench(CLI::App& app);
void add_cast(CLI::App& app);
void add_doctor(CLI::App& app);
void add_explain(CLI::App& app);
void add_fp(CLI::App& app);
void add_help(CLI::App& app);
void add_inventory(CLI::App& app);
void add_merge(CLI::App& app, const CommandRun& again);
void add_plan(CLI::App& app);
void add_query(CLI::App& app);
void add_reproduce(CLI::App& app);
void add_run(CLI::App& app);
void add_wave(CLI::App& app);

}  // namespace cde::cli
