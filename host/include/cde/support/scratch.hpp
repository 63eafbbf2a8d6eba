// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <stdlib.h>  // mkdtemp

#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>

#include "cde/support/error.hpp"

namespace cde {

/// A folder of its own for files that nobody keeps; it is removed at the end.
class Scratch {
 public:
  /// `name` begins its name. Error kFile.
  explicit Scratch(const std::string& name)
      : path_((std::filesystem::temp_directory_path() / (name + "-XXXXXX")).string()) {
    if (::mkdtemp(path_.data()) == nullptr)
      throw Error(ErrorCode::kFile,
                  path_ + ": cannot create: " + std::generic_category().message(errno));
  }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  [[nodiscard]] std::filesystem::path operator/(const char* name) const {
    return std::filesystem::path(path_) / name;
  }

 private:
  std::string path_;
};

}  // namespace cde
