// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>

#include "cde/support/output_file.hpp"

namespace cde {

/// A temporary folder. The destructor or OutputFile::remove_unfinished() removes it with its files.
class Scratch {
 public:
  /// `name` begins the folder's name. Error kFile if it cannot be created.
  explicit Scratch(const std::string& name);
  ~Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  [[nodiscard]] std::filesystem::path operator/(const char* name) const {
    return std::filesystem::path(folder_.name) / name;
  }

 private:
  NameInFolder folder_;
};

}  // namespace cde
