// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "options/cli_fwd.hpp"

/// The words of a command line, held against what the parser knows.
namespace cde::cli {

/// The words as CLI11 reads them in one way only: the verb, its options as --name=value, what has
/// no name behind them. A question for help is that question alone. Error kUsage about the first
/// word, in the order typed, that is invalid: no such verb or option, a value that is missing,
/// empty or does not fit, an option or flag given twice, or one that another option excludes. What
/// is missing is said after that.
[[nodiscard]] std::vector<std::string> understood(const CLI::App& app,
                                                  const std::vector<std::string>& words);

/// Error kUsage: "--bits cannot be combined with --output x.npy; CSV alone has them". `why` may be
/// empty.
[[noreturn]] void cannot_combine(std::string_view option, std::string_view other,
                                 std::string_view why = {});

/// The first option excludes those of the others that the verb has.
void excludes(CLI::App& verb, const std::string& option, const std::vector<std::string>& others);

}  // namespace cde::cli
