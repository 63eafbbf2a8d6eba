// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>

#include "support/descriptor.hpp"

/// Reads whole files; cde/support/output_file.hpp writes them. Private to the library.
namespace cde::file_io {

constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();

/// All bytes of a regular file or pipe that the user named. Error kFile with the name if it is
/// missing, unreadable, a directory or a device. The same error for a file of the kernel (/proc,
/// /sys), which may have no end, and for more bytes than `most`. If `owner` is given, it becomes
/// the file's user.
[[nodiscard]] std::string read(const std::filesystem::path& path, uid_t* owner = nullptr,
                               std::uint64_t most = kNoLimit);

/// Opens a regular file without waiting. Error kFile if it is anything else, as a pipe or a file of
/// the kernel, or cannot be opened. Opens every file that another file names.
[[nodiscard]] Descriptor open_regular(const std::filesystem::path& path);

/// All bytes of such a file. Error kFile if it has more bytes than `most`.
[[nodiscard]] std::string read_regular(const std::filesystem::path& path,
                                       std::uint64_t most = kNoLimit, uid_t* owner = nullptr);

/// The size of such a file in bytes.
[[nodiscard]] std::uint64_t size_of_regular(const std::filesystem::path& path);

}  // namespace cde::file_io
