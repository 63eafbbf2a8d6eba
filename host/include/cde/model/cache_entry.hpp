// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// @file
/// Expensive texts, cached beside the simulation models (model.hpp) under the same rules. They
/// belong to the user or to root, no other user may write them, and each has a checksum file.
namespace cde {

/// Key of what a text was made from: SHA-256 of the parts, as 24 hexadecimal digits.
[[nodiscard]] std::string cache_key(const std::vector<std::string>& parts);

/// The text cached as `name`. Nothing if it is missing, damaged or another user's; the last two are
/// reported on stderr.
[[nodiscard]] std::optional<std::string> read_cache_entry(const std::string& name);

/// Stores the text. An unwritable cache is not an error: the next process makes the text again.
void write_cache_entry(const std::string& name, std::string_view text);

}  // namespace cde
