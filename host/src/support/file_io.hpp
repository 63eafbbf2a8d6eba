// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>

/// Whole files in; cde/support/output_file.hpp has the way out. Private to the library.
namespace cde::file_io {

/// All bytes of a regular file or pipe. Error kFile, naming the file: missing, unreadable, a
/// directory, a device.
[[nodiscard]] std::string read(const std::filesystem::path& path);

/// Throws Error kFile unless `path` is a regular file that can be opened; returns its size in
/// bytes.
std::size_t check_regular(const std::filesystem::path& path);

}  // namespace cde::file_io
