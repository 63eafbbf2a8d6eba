// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "options/cli_fwd.hpp"

/// Checks the words of a command line against the parser.
namespace cde::cli {

/// Returns the words in one unambiguous form for CLI11: the verb, its options as --name=value, then
/// the positional arguments. A question for help is returned alone. Error kUsage about the first
/// invalid word, in the order typed. Invalid are an unknown verb or option, a missing, empty or
/// unfit value, an option or flag given twice, and an option that another one excludes. Missing
/// arguments are reported after that.
[[nodiscard]] std::vector<std::string> normalise_arguments(const CLI::App& app,
                                                           const std::vector<std::string>& words);

/// Error kUsage: "--bits cannot be combined with --output x.npy; only CSV has them". `why` may be
/// empty.
[[noreturn]] void cannot_combine(std::string_view option, std::string_view other,
                                 std::string_view why = {});

/// Makes the first option exclude each of the others that the verb has.
void excludes(CLI::App& verb, const std::string& option, const std::vector<std::string>& others);

}  // namespace cde::cli
