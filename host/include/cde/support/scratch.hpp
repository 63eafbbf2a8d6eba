// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <stdlib.h>  // mkdtemp

#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>

#include "cde/support/error.hpp"

namespace cde {

/// A temporary folder that the destructor removes with its files.
class Scratch {
 public:
  /// `name` begins the folder's name. Error kFile if it cannot be created.
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
