#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

/// Whole files in and out. Private to the library.
namespace cde::file_io {

/// All bytes of a regular file or pipe. Error kFile, naming the file: missing, unreadable, a
/// directory, a device.
[[nodiscard]] std::string read(const std::filesystem::path& path);

/// Throws Error kFile unless `path` is a regular file that can be opened; returns its size in
/// bytes.
std::size_t check_regular(const std::filesystem::path& path);

/// Writes to a new file beside `path` and renames it, so that a reader sees the old file or the new
/// one. Error kFile.
void write_atomically(const std::filesystem::path& path, std::string_view bytes);

}  // namespace cde::file_io
