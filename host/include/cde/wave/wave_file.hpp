// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>

/// @file
/// Reads wave files (FST) as `--trace` writes them. Error kFile for other files.
namespace cde::wave {

/// Signals of an FST file, with their scopes and handles.
[[nodiscard]] std::map<std::string, unsigned> signals(const std::filesystem::path& file);

/// All values of a signal as bits, most significant first.
[[nodiscard]] std::set<std::string> values(const std::filesystem::path& file, unsigned handle);

/// Values of a signal at each time at which it changes.
[[nodiscard]] std::map<std::uint64_t, std::string> changes(const std::filesystem::path& file,
                                                           unsigned handle);

}  // namespace cde::wave
