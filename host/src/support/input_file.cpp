// SPDX-License-Identifier: Apache-2.0
#include "cde/support/input_file.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"

namespace cde {

std::string read_file(const std::string& file) {
  std::error_code ignored;
  const auto kind = std::filesystem::status(file, ignored).type();
  using enum std::filesystem::file_type;
  if (kind == directory || kind == character || kind == block || kind == socket)
    throw Error(ErrorCode::kFile, fmt::format("{}: is a {}, not a file", printable_name(file),
                                              kind == directory ? "folder" : "device"));
  std::ifstream in(file, std::ios::binary);
  if (!in) throw Error(ErrorCode::kFile, fmt::format("{}: cannot be read", printable_name(file)));
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace cde
