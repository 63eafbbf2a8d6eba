// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sys/types.h>

#include <filesystem>
#include <string>

#include "cde/support/output_file.hpp"

namespace cde {

/// A file in a folder, locked while a process uses the folder. Only its user can open the file, so
/// no other user can hold the lock. The file is removed with the lock. A killed process leaves it,
/// and the next one takes it.
class FolderLock {
 public:
  enum class Result {
    kLocked,
    kInUse,  ///< another process holds the lock
    kGone,   ///< the folder or the file was removed meanwhile: open the folder again
  };
  FolderLock() = default;
  ~FolderLock() { release(); }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  /// Locks the file `name` of an open folder, which must stay open until release(). `shown` is the
  /// file's path for messages. Error kFile if it cannot be opened, or belongs to another user. Some
  /// file systems have no locks; there the folder counts as locked.
  [[nodiscard]] Result lock(int folder, const std::string& name,
                            const std::filesystem::path& shown);
  void release();
  /// The user to whom the files of this process belong in the folder.
  [[nodiscard]] uid_t owner() const { return owner_; }

 private:
  NameInFolder entry_;
  int file_ = -1;
  uid_t owner_ = 0;
};

}  // namespace cde
