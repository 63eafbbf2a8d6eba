// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sys/types.h>

#include <string>

namespace cde {

/// All bytes of a regular file or a pipe that the user named. Error kFile, naming the file: it is
/// missing, unreadable, a folder, a device or a file of the kernel (which may have no end). If
/// `owner` is given, it becomes the file's user.
[[nodiscard]] std::string read_file(const std::string& file, uid_t* owner = nullptr);

/// All bytes of a regular file that another file names. Error kFile also for pipes.
[[nodiscard]] std::string read_named_file(const std::string& file);

}  // namespace cde
