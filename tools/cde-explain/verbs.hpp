// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "options/cli_fwd.hpp"
#include "program/program.hpp"

/// The verbs of cde-explain. Each adds itself to the parser. Its callback throws cde::Error.
namespace cde::cli {

void add_explain(CLI::App& app);
void add_pack(CLI::App& app);

}  // namespace cde::cli
