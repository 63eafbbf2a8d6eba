// SPDX-License-Identifier: Apache-2.0
#include "cde/support/folder_lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "support/output_target.hpp"
#include "support/unfinished.hpp"

namespace cde {

FolderLock::Result FolderLock::lock(int folder, const std::string& name,
                                    const std::filesystem::path& shown) {
  constexpr int kFlags = O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
  const auto opened = [&](int more) {
    return Descriptor(::openat(folder, name.c_str(), kFlags | more, 0600));
  };
  Descriptor file = opened(O_EXCL);
  const bool made = file.get() >= 0;
  if (!made && errno == EEXIST) file = opened(0);
  if (file.get() < 0 && errno == ENOENT) return Result::kGone;
  const auto info = info_of(file.get());
  if (!info) fail_output(shown, "lock", errno);
  if (!made && (info->st_uid != ::geteuid() || !S_ISREG(info->st_mode)))
    throw Error(ErrorCode::kFile,
                fmt::format("{}: cannot lock: it is no file of a run of yours; it belongs to user "
                            "{}; move it elsewhere",
                            printable_name(shown.string()), info->st_uid));
  if (::flock(file.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) return Result::kInUse;
  struct stat named {};
  if (::fstatat(folder, name.c_str(), &named, AT_SYMLINK_NOFOLLOW) != 0 ||
      !is_same_file(named, *info))
    return Result::kGone;
  owner_ = info->st_uid;
  entry_ = {folder, name};
  file_ = file.release();
  remember_unfinished(entry_);
  return Result::kLocked;
}

void FolderLock::release() {
  if (file_ < 0) return;
  ::unlinkat(entry_.folder, entry_.name.c_str(), 0);  // first: the next process makes its own
  forget_unfinished(entry_);
  ::close(std::exchange(file_, -1));
}

}  // namespace cde
