// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/card/pipe_options.hpp"
#include "options/cli_fwd.hpp"

namespace cde::cli {

/// Adds PAIR and the options that name its pipe; --lanes only if `lanes` is true.
void add_pair_options(CLI::App& verb, PairOptions& options, bool lanes = true);

/// Error kUsage if an option was given that does not apply to the pair.
void check_pair_options(const CLI::App& verb, const PairOptions& options);

}  // namespace cde::cli
