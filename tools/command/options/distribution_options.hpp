// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/jobs/work_distributor.hpp"
#include "options/cli_fwd.hpp"

namespace cde::cli {

/// Adds --resume and --shard.
void add_distribution_options(CLI::App& verb, DistributionOptions& options);

}  // namespace cde::cli
