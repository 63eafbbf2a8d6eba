// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "options/cli_fwd.hpp"
#include "program/program.hpp"

/// The verbs of the program cde, in verbs/verb_NAME.cpp. Each adds itself to the parser. Its
/// callback throws cde::Error. Results go to stdout, everything else to stderr.
namespace cde::cli {

void add_cast(CLI::App& app);
void add_doctor(CLI::App& app);
void add_fp(CLI::App& app);
void add_help(CLI::App& app);
void add_plan(CLI::App& app);
void add_query(CLI::App& app);
void add_render(CLI::App& app);
void add_run(CLI::App& app);
void add_version(CLI::App& app);

}  // namespace cde::cli
