// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace cde {

/// All bytes of a regular file or a pipe. Error kFile, naming the file: it is missing, unreadable,
/// a folder, or a device (which may have no end).
[[nodiscard]] std::string read_file(const std::string& file);

}  // namespace cde
