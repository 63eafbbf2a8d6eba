// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>

/// Reads whole files; cde/support/output_file.hpp writes them. Private to the library.
namespace cde::file_io {

/// All bytes of a regular file or pipe. Error kFile with the name if it is missing, unreadable, a
/// directory or a device.
[[nodiscard]] std::string read(const std::filesystem::path& path);

/// The size in bytes of a regular file. Error kFile if it is not regular or cannot be opened.
std::size_t check_regular(const std::filesystem::path& path);

}  // namespace cde::file_io
