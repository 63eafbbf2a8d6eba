// SPDX-License-Identifier: Apache-2.0
// Folders that this process makes, and files without a name in them. Another user may own the
// folder around them.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <utility>

#include "cde/support/message.hpp"
#include "cde/support/output_file.hpp"
#include "cde/support/scratch.hpp"
#include "support/file_access.hpp"
#include "support/output_target.hpp"
#include "support/unfinished.hpp"

namespace cde {
namespace {

namespace fs = std::filesystem;

constexpr int kFolderOnly = O_PATH | O_DIRECTORY | O_CLOEXEC;

/// The path of an open folder or file in /proc. Other processes of this user can also use it.
std::string held_name(int folder) {
  return fmt::format("/proc/{}/fd/{}", ::getpid(), folder);
}

/// A new file without a name, which only this user can open. -1, with errno, if there is none.
int new_nameless_file(int folder) {
  std::string name = held_name(folder) + "/.cde-XXXXXX";
  const int file = ::mkostemp(name.data(), O_CLOEXEC);
  if (file >= 0) ::unlink(name.c_str());
  return file;
}

/// Whether an open folder belongs to this user. A file server may give root's folders another
/// owner; then it also does so with root's files.
bool is_own_folder(int folder) {
  const auto info = info_of(folder);
  if (!info || info->st_uid == ::geteuid()) return info.has_value();
  const Descriptor file(new_nameless_file(folder));
  const auto owned = info_of(file.get());
  return owned && owned->st_uid == info->st_uid;
}

bool is_empty(int folder) {
  std::error_code error;
  return fs::is_empty(held_name(folder), error) && !error;
}

/// Opens the folder that this process has just made, and that no other user can enter. Error kFile
/// if it is another user's: the owner of the folder around it can exchange the two.
Descriptor open_made(const fs::path& path, int around, const char* name) {
  Descriptor made(::openat(around, name, kFolderOnly | O_NOFOLLOW));
  if (made.get() < 0 && errno != ENOTDIR && errno != ELOOP) fail_output(path, "create", errno);
  if (made.get() < 0 || !is_own_folder(made.get())) fail_replaced(path);
  return made;
}

}  // namespace

NamelessFile::NamelessFile(int folder, const fs::path& shown) : file_(new_nameless_file(folder)) {
  if (file_ < 0) fail_output(shown, "create", errno);
}

NamelessFile::~NamelessFile() {
  ::close(file_);
}

std::string NamelessFile::by_name() const {
  return held_name(file_);
}

Scratch::Scratch(const std::string& name)
    : named_{AT_FDCWD, fs::absolute(fs::temp_directory_path() / (name + "-XXXXXX")).string()} {
  if (::mkdtemp(named_.name.data()) == nullptr) fail_output(named_.name, "create", errno);
  Descriptor made = open_made(named_.name, AT_FDCWD, named_.name.c_str());
  if (!is_empty(made.get())) fail_replaced(named_.name);
  const std::string inside = held_name(made.get());
  inside_ = {made.release(), inside};
  remember_unfinished(named_, UnfinishedKind::kFolder);
  remember_unfinished(inside_, UnfinishedKind::kContents);
}

Scratch::~Scratch() {
  forget_unfinished(inside_, UnfinishedKind::kContents);
  forget_unfinished(named_, UnfinishedKind::kFolder);
  remove_contents(inside_.folder);
  ::rmdir(named_.name.c_str());
  ::close(inside_.folder);
}

OutputFolder::OutputFolder(const fs::path& path) : path_(path) {
  std::error_code none;
  std::vector<std::string> missing;  // the outermost is last
  fs::path there = fs::absolute(path);
  for (auto what = fs::status(there, none); !fs::exists(what); what = fs::status(there, none)) {
    if (what.type() == fs::file_type::none) fail_output(path, "create", none.value());
    if (fs::is_symlink(fs::symlink_status(there, none))) {
      there = behind_link(path, there);
      continue;
    }
    const fs::path name = there.filename();
    if (name == "..") fail_output(path, "create", ENOENT);  // ".." below a missing folder
    if (!name.empty() && name != ".") missing.push_back(name);
    there = there.parent_path();
  }
  Descriptor folder(::open(there.c_str(), kFolderOnly));
  if (folder.get() < 0) fail_output(path, "create", errno);
  created_.reserve(missing.size());  // entries stay in place, since handlers read them
  try {
    for (auto name = missing.rbegin(); name != missing.rend(); ++name)
      folder = Descriptor(make(folder.get(), *name));
  } catch (...) {
    remove_created();
    throw;
  }
  if (missing.empty()) check_folder_link(path, folder.get());
  keep_folder(path, Descriptor(::fcntl(folder.get(), F_DUPFD_CLOEXEC, 0)));
  folder_ = folder.release();
}

/// Makes a folder, or opens the one that another process has just made. Returns its descriptor.
int OutputFolder::make(int around, const std::string& name) {
  // Until its mode is set, no other user can put files into it.
  made_ = ::mkdirat(around, name.c_str(), 0700) == 0;
  if (!made_ && errno != EEXIST) fail_output(path_, "create", errno);
  if (!made_) {
    const int there = ::openat(around, name.c_str(), kFolderOnly | O_NOFOLLOW);
    if (there < 0) fail_output(path_, "create", errno);
    return there;
  }
  Descriptor inner = open_made(path_, around, name.c_str());
  made_ = is_empty(inner.get());  // else another process of this user has put files there
  if (made_) {
    created_.push_back({::fcntl(around, F_DUPFD_CLOEXEC, 0), name});
    remember_unfinished(created_.back(), UnfinishedKind::kFolder);
    set_access_of_new_folder(inner.get());
  }
  return inner.release();
}

void OutputFolder::check() const {
  struct stat ours {
  }, named{};
  if (::fstat(folder_, &ours) == 0 && ::stat(path_.c_str(), &named) == 0 &&
      ours.st_dev == named.st_dev && ours.st_ino == named.st_ino)
    return;
  throw Error(ErrorCode::kFile, fmt::format("{}: the folder was moved or replaced in the meantime",
                                            printable_name(path_.string())));
}

OutputFolder::~OutputFolder() {
  remove_created();
  if (folder_ >= 0) ::close(folder_);
}

/// Removes the created folders that are empty.
void OutputFolder::remove_created() {
  for (auto one = created_.rbegin(); one != created_.rend(); ++one)
    ::unlinkat(one->folder, one->name.c_str(), AT_REMOVEDIR);
  keep();
}

void OutputFolder::keep() {
  for (const NameInFolder& one : created_) {
    forget_unfinished(one, UnfinishedKind::kFolder);
    ::close(one.folder);
  }
  created_.clear();
}

}  // namespace cde
