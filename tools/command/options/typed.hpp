// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "options/cli_fwd.hpp"

/// The words of a command line, held against what the parser knows.
namespace cde::cli {

/// The words as CLI11 reads them in one way only: the verb, its options as --name=value, what has
/// no name behind them. A question for help is that question alone. Error kUsage about the first
/// word, in the order typed, that makes no sense: no such verb or option, a value that is missing,
/// empty or does not fit, an option given twice.
[[nodiscard]] std::vector<std::string> understood(const CLI::App& app,
                                                  const std::vector<std::string>& words);

}  // namespace cde::cli
