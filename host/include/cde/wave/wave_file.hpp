// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>

/// Reads wave files (FST), as `--trace` writes them. Error kFile for what is none.
namespace cde::wave {

/// Signals of an FST file, with their scopes, and the handle of each.
[[nodiscard]] std::map<std::string, unsigned> signals(const std::filesystem::path& file);

/// All values that a signal takes, as bits, the most significant first.
[[nodiscard]] std::set<std::string> values(const std::filesystem::path& file, unsigned handle);

/// The value that a signal takes at each time at which it changes.
[[nodiscard]] std::map<std::uint64_t, std::string> changes(const std::filesystem::path& file,
                                                           unsigned handle);

}  // namespace cde::wave
