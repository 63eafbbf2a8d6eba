// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "options/cli_fwd.hpp"
#include "program/program.hpp"

/// The verbs of cde-bench. Each adds itself to the parser. Its callback throws cde::Error.
namespace cde::cli {

void add_bench(CLI::App& app);
void add_reproduce(CLI::App& app);
void add_inventory(CLI::App& app);

}  // namespace cde::cli
