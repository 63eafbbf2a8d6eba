// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/jobs/dealing.hpp"
#include "options/cli_fwd.hpp"

namespace cde::cli {

/// Adds --resume and --shard.
void add_deal_options(CLI::App& verb, DealOptions& options);

}  // namespace cde::cli
