// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>

#include "cde/support/output_file.hpp"

namespace cde {

/// A temporary folder, which only this user can open. It is used by descriptor: nothing is written
/// or removed elsewhere if another user replaces its name. The destructor or
/// OutputFile::remove_unfinished() removes it with its files.
class Scratch {
 public:
  /// `name` begins the folder's name. Error kFile if it cannot be created, or another user replaces
  /// it at once.
  explicit Scratch(const std::string& name);
  ~Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  /// A path of a file in it, for this and other processes of this user.
  [[nodiscard]] std::filesystem::path operator/(const char* name) const {
    return std::filesystem::path(inside_.name) / name;
  }

 private:
  NameInFolder named_, inside_;  ///< its name, and its descriptor with the name in /proc
};

/// A temporary file without a name in an open folder. No other user can open or replace it. The
/// system removes it when this process ends.
class NamelessFile {
 public:
  /// `shown` names the folder in messages. Error kFile if the file cannot be created.
  NamelessFile(int folder, const std::filesystem::path& shown);
  ~NamelessFile();
  NamelessFile(const NamelessFile&) = delete;
  NamelessFile& operator=(const NamelessFile&) = delete;
  /// A path for this and other processes of this user, which may open the file for writing again.
  [[nodiscard]] std::string by_name() const;

 private:
  int file_;
};

}  // namespace cde
