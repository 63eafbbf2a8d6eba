// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "options/cli_fwd.hpp"
#include "program/program.hpp"

/// The verbs of cde-bench. Each adds itself to the parser. Its callback throws cde::Error.
namespace cde::cli {

void add_bench(CLI::App& app);
void add_reproduce(CLI::App& app);
void add_inventory(CLI::App& app);

/// --opencl-device of bench and reproduce.
CLI::Option* opencl_device_option(CLI::App& verb, std::string& words);

}  // namespace cde::cli
