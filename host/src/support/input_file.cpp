// SPDX-License-Identifier: Apache-2.0
#include "cde/support/input_file.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "support/file_io.hpp"

namespace cde {

std::string read_file(const std::string& file, uid_t* owner) {
  std::error_code ignored;
  const auto kind = std::filesystem::status(file, ignored).type();
  using enum std::filesystem::file_type;
  if (kind == directory || kind == character || kind == block || kind == socket)
    throw Error(ErrorCode::kFile, fmt::format("{}: is a {}, not a file", printable_name(file),
                                              kind == directory ? "folder" : "device"));
  return file_io::read(file, owner);
}

std::string read_named_file(const std::string& file) {
  return file_io::read_regular(file);
}

}  // namespace cde
