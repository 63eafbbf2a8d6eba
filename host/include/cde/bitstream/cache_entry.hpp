// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Texts that are costly to make and lie in the cache beside the bitstreams (bitstream.hpp), under
/// the same rules: they are their user's or root's, nobody else can write them, and a checksum is
/// beside them.
namespace cde {

/// Identifies what a text was made from: SHA-256 of the parts, as 24 hexadecimal digits.
[[nodiscard]] std::string cache_key(const std::vector<std::string>& parts);

/// The text kept as `name`; none if there is none, or one that is damaged or somebody else's, which
/// is said on stderr.
[[nodiscard]] std::optional<std::string> read_cache_entry(const std::string& name);

/// Keeps it. A cache that cannot be written is no error: the next one makes the text again.
void write_cache_entry(const std::string& name, std::string_view text);

}  // namespace cde
