// SPDX-License-Identifier: Apache-2.0
#include "cde/support/output_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <climits>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "cde/support/message.hpp"
#include "support/file_access.hpp"
#include "support/output_target.hpp"
#include "support/unfinished.hpp"

namespace cde {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMark = ".cde-";  // NAME.cde-PID-RANDOM
constexpr std::size_t kRandom = 6;
constexpr std::string_view kRandomDigits = "abcdefghijklmnopqrstuvwxyz0123456789";

std::atomic<bool> stdout_held = false;

/// NAME in NAME.cde-PID-RANDOM, shortened to leave room for the suffix.
std::string_view stem(std::string_view name) {
  constexpr std::size_t kMost = NAME_MAX - kMark.size() - 10 - 1 - kRandom;
  return name.substr(0, kMost);
}

struct Unfinished {
  std::string_view name;
  pid_t process = 0;
};

std::optional<Unfinished> unfinished(std::string_view file) {
  const std::size_t mark = file.rfind(kMark);
  if (mark == std::string_view::npos) return std::nullopt;
  const std::string_view rest = file.substr(mark + kMark.size());
  const std::size_t dash = rest.find('-');
  if (dash == std::string_view::npos || rest.size() - dash - 1 != kRandom) return std::nullopt;
  if (rest.find_first_not_of(kRandomDigits, dash + 1) != std::string_view::npos)
    return std::nullopt;
  pid_t process = 0;
  const auto [stop, bad] = std::from_chars(rest.data(), rest.data() + dash, process);
  if (bad != std::errc() || stop != rest.data() + dash || process <= 0) return std::nullopt;
  return Unfinished{file.substr(0, mark), process};
}

/// Whether a process has ended, including a zombie. Zombies can persist in a container whose first
/// process does not reap orphans.
bool ended(pid_t process) {
  if (::kill(process, 0) != 0) return errno == ESRCH;
  std::ifstream file(fmt::format("/proc/{}/stat", process));
  const std::string stat(std::istreambuf_iterator<char>(file), {});
  const std::size_t name = stat.rfind(')');  // PID (NAME) STATE ...
  return name != std::string::npos && stat.compare(name, 3, ") Z") == 0;
}

/// Removes an unfinished file if it is ours and unused. Its process must have ended and its lock
/// must be free; a process in another container that sees the folder may hold the lock.
void sweep(int folder, const std::string& name, pid_t process) {
  if (!ended(process)) return;
  const Descriptor file(
      ::openat(folder, name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (file.get() < 0) return;
  const auto info = info_of(file.get());
  if (info && S_ISREG(info->st_mode) && info->st_uid == ::geteuid() &&
      ::flock(file.get(), LOCK_EX | LOCK_NB) == 0)
    ::unlinkat(folder, name.c_str(), 0);
}

/// sweep_unfinished() for an open folder.
void sweep_all(int folder, std::string_view name) {
  std::error_code error;
  for (fs::directory_iterator entry(fmt::format("/proc/self/fd/{}", folder), error), end;
       !error && entry != end; entry.increment(error)) {
    const std::string file = entry->path().filename();
    const auto found = unfinished(file);
    if (found && (name.empty() || found->name == stem(name))) sweep(folder, file, found->process);
  }
}

std::string random_word() {
  static thread_local std::random_device source;
  std::uniform_int_distribution<std::size_t> digit(0, kRandomDigits.size() - 1);
  std::string word;
  for (std::size_t i = 0; i < kRandom; ++i) word += kRandomDigits[digit(source)];
  return word;
}

bool is_null(const struct stat& info) {
  return S_ISCHR(info.st_mode) && info.st_rdev == makedev(1, 3);
}

OutputTarget target_of(const FileUse& use, int standard) {
  if (use.path == "-") return {use.path, {}, standard, info_of(standard), {}};
  return follow_output(use.path);
}

/// The target of an input. Whether it can be read is left to its reader.
std::optional<OutputTarget> input_target(const FileUse& use) {
  if (use.path == "-") return target_of(use, STDIN_FILENO);
  struct stat info {};
  if (::stat(use.path.c_str(), &info) != 0) return std::nullopt;
  return OutputTarget{use.path, use.path, std::nullopt, info, {}};
}

bool same_file(const OutputTarget& a, const OutputTarget& b) {
  if (!a.info || !b.info) return !a.info && !b.info && !a.descriptor && same_name(a, b);
  if (S_ISCHR(a.info->st_mode) && S_ISCHR(b.info->st_mode))
    return a.info->st_rdev == b.info->st_rdev;
  return a.info->st_dev == b.info->st_dev && a.info->st_ino == b.info->st_ino;
}

}  // namespace

StdoutError::StdoutError(int number)
    : Error(ErrorCode::kFile, fmt::format("stdout: cannot write: {}", std::strerror(number))),
      number_(number) {}

OutputFile::OutputFile(const fs::path& path, Use use) : path_(path) {
  OutputTarget target;
  if (path == "-")
    target.descriptor = STDOUT_FILENO;
  else
    target = follow_output(path);
  target_ = target.path;
  const auto kept = target.descriptor ? std::nullopt : kept_found(path);
  found_ = kept ? kept->info : target.info;
  stdout_ = target.descriptor == STDOUT_FILENO;
  if (stdout_) {
    file_ = stdout;
  } else if (target.descriptor || (target.info && !S_ISREG(target.info->st_mode))) {
    if (target.info && !target.descriptor && (!found_ || !is_same_file(*found_, *target.info)))
      fail_replaced(path);
    if ((file_ = ::fdopen(open_output(target, O_WRONLY).release(), "w")) == nullptr) fail("write");
  } else {
    // A rename needs no permission for the file that it replaces, so check it here.
    if (target.info && ::access(target_.c_str(), W_OK) != 0) fail("write");
    folder_ = folder_of(target).release();
    make_temporary();
    return;
  }
  if (use == Use::kByName || (stdout_ && stdout_held)) make_spool();
  if (use == Use::kByName || spool_ < 0) return;
  const int fd = ::fcntl(spool_, F_DUPFD_CLOEXEC, 0);
  if (fd < 0 || (held_ = ::fdopen(fd, "w")) == nullptr) fail("create");
}

void OutputFile::make_temporary() {
  const Descriptor old(
      ::openat(folder_, target_.filename().c_str(), O_PATH | O_NOFOLLOW | O_CLOEXEC));
  if (found_ && S_ISREG(found_->st_mode)) replaced_mode_ = found_->st_mode & 0777;
  // With an ACL, the bits of the group are the most that the ACL gives.
  if (replaced_mode_ && !access_acl(old.get()).empty()) *replaced_mode_ &= ~070u;
  new_mode_ = mode_of_new_file(folder_);
  const std::string name(stem(target_.filename().native()));
  sweep_all(folder_, name);
  for (int attempts = 0; attempts < 100; ++attempts) {
    temporary_ = {folder_, fmt::format("{}{}{}-{}", name, kMark, ::getpid(), random_word())};
    remember_unfinished(temporary_);  // first, so that a signal in between still finds the file
    const char* const last = temporary_.name.c_str();
    // Users who could open the file could read it before it has its mode, or hold its lock.
    const int fd = ::openat(folder_, last, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (fd >= 0) {
      if (lock_temporary(fd) && (file_ = ::fdopen(fd, "w")) != nullptr) return;
      ::close(fd);
      ::unlinkat(folder_, last, 0);
    }
    const int number = fd >= 0 ? EEXIST : errno;
    forget_unfinished(temporary_);
    temporary_ = {};
    if (number == EEXIST) continue;
    errno = number;
    fail("create");
  }
  errno = EEXIST;
  fail("create");
}

/// A cleaner in another process finds the file locked, or has locked or removed it before. Some
/// file systems have no locks.
bool OutputFile::lock_temporary(int fd) const {
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) return false;
  const auto info = info_of(fd);
  return info && info->st_nlink != 0;
}

/// Makes a nameless file, which others open by its descriptor.
void OutputFile::make_spool() {
  std::string name = fs::temp_directory_path() / "cde-output-XXXXXX";
  spool_ = ::mkostemp(name.data(), O_CLOEXEC);
  if (spool_ < 0) fail("create");
  ::unlink(name.c_str());
}

OutputFile::~OutputFile() {
  if (file_ != nullptr && file_ != stdout) std::fclose(file_);
  if (held_ != nullptr) std::fclose(held_);
  if (spool_ >= 0) ::close(spool_);
  if (!temporary_.name.empty()) {
    ::unlinkat(folder_, temporary_.name.c_str(), 0);
    forget_unfinished(temporary_);
  }
  if (folder_ >= 0) ::close(folder_);
}

std::string OutputFile::by_name() const {
  return fmt::format("/proc/self/fd/{}", spool_ >= 0 ? spool_ : ::fileno(file_));
}

void OutputFile::set_mode(unsigned mode) {
  new_mode_ = mode;
}

void OutputFile::fail(const char* doing) const {
  if (stdout_) throw StdoutError(errno);
  fail_output(path_, doing, errno);
}

void OutputFile::write(std::string_view bytes) {
  std::FILE* const to = held_ != nullptr ? held_ : file_;
  if (std::fwrite(bytes.data(), 1, bytes.size(), to) != bytes.size()) fail("write");
}

void OutputFile::replace_start(std::string_view bytes) {
  flush();
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t wrote = ::pwrite(::fileno(file_), bytes.data() + done, bytes.size() - done,
                                   static_cast<off_t>(done));
    if (wrote < 0) fail("write");
    done += static_cast<std::size_t>(wrote);
  }
}

void OutputFile::flush() {
  if (std::fflush(file_) != 0) fail("write");
}

/// Copies the spool to a target that is not a regular file.
void OutputFile::spill() {
  std::array<char, 1 << 16> block;
  off_t at = 0;
  ssize_t got = 0;
  while ((got = ::pread(spool_, block.data(), block.size(), at)) > 0) {
    write({block.data(), static_cast<std::size_t>(got)});
    at += got;
  }
  if (got < 0) fail("write");
}

void OutputFile::commit() {
  if (held_ != nullptr && std::fclose(std::exchange(held_, nullptr)) != 0) fail("write");
  if (spool_ >= 0) spill();
  flush();
  // Some file systems report write errors only when the file is closed.
  const Descriptor written(temporary_.name.empty() ? -1
                                                   : ::fcntl(::fileno(file_), F_DUPFD_CLOEXEC, 0));
  std::FILE* const file = file_;
  file_ = nullptr;
  if (file != stdout && std::fclose(file) != 0) fail("write");
  if (!temporary_.name.empty()) move_into_place(written.get());
}

/// Gives the new file the owner, mode and ACL of the old one. Users who could not read the old file
/// cannot read the new one.
void OutputFile::set_owner_and_mode(int fd) {
  const Descriptor there(
      ::openat(folder_, target_.filename().c_str(), O_PATH | O_NOFOLLOW | O_CLOEXEC));
  const auto now = info_of(there.get()), ours = info_of(fd);
  if (!ours) fail("write");
  const bool same = now && found_ && is_same_file(*now, *found_);
  // In a held folder, such as the folder of a run, all files are this user's.
  if (now && now->st_uid != ours->st_uid && (!same || is_in_held_folder(path_)))
    fail_replaced(path_);
  if (same && S_ISREG(now->st_mode)) {
    // Only root can change a file's owner, and not on every file system.
    if (::geteuid() == 0) (void)!::fchown(fd, now->st_uid, now->st_gid);
    if (!set_access(fd, now->st_mode & 0777, access_acl(there.get()))) fail("write");
    return;
  }
  mode_t mode = replaced_mode_.value_or(new_mode_);
  if (now && S_ISREG(now->st_mode)) mode &= now->st_mode;
  if (found_ && found_->st_uid != ours->st_uid) mode &= ~022u;  // the new file's owner is another
  if (!replaced_mode_)
    (void)::fchmod(fd, mode);
  else if (!set_access(fd, mode, {}))
    fail("write");
}

/// Puts the new file in place.
void OutputFile::move_into_place(int fd) {
  const std::string target = target_.filename();
  const char* const name = temporary_.name.c_str();
  set_owner_and_mode(fd);
  struct stat ours {
  }, named{};
  if (::fstat(fd, &ours) != 0 || ::fstatat(folder_, name, &named, AT_SYMLINK_NOFOLLOW) != 0)
    fail("write");
  if (named.st_dev != ours.st_dev || named.st_ino != ours.st_ino)
    throw Error(ErrorCode::kFile,
                fmt::format("{}: cannot write: another user of its folder has replaced {}",
                            printable_name(path_.string()),
                            printable_name((path_.parent_path() / name).string())));
  if (::renameat(folder_, name, folder_, target.c_str()) != 0) fail("write");
  forget_unfinished(temporary_);
  temporary_ = {};
  if (kept_found(path_)) keep_found(path_, ours);  // the command may write it again
}

void OutputFile::buffer_stdout() {
  stdout_held = true;
}

void write_file(const fs::path& path, std::string_view bytes) {
  OutputFile file(path);
  file.write(bytes);
  file.commit();
}

void check_outputs(std::span<const FileUse> outputs, std::span<const FileUse> inputs) {
  struct Checked {
    const FileUse* use;
    OutputTarget target;
  };
  const auto shown = [](const FileUse& use, const char* standard) {
    return use.path == "-" ? standard : printable_name(use.path.string());
  };
  std::vector<Checked> read, written;
  for (const FileUse& input : inputs) {
    if (input.path.empty()) continue;
    if (auto target = input_target(input)) read.push_back({&input, std::move(*target)});
  }
  for (const FileUse& output : outputs) {
    if (output.path.empty()) continue;
    OutputTarget target = target_of(output, STDOUT_FILENO);
    const bool discards = target.info && is_null(*target.info);
    for (const Checked& other : written)
      if (!discards && same_file(target, other.target))
        throw Error(ErrorCode::kUsage, fmt::format("{} and {} both write to {}", other.use->option,
                                                   output.option, shown(output, "stdout")));
    const bool talks =
        target.info && (S_ISCHR(target.info->st_mode) || S_ISSOCK(target.info->st_mode));
    for (const Checked& other : read)
      if (!talks && same_file(target, other.target))
        throw Error(ErrorCode::kUsage,
                    fmt::format("{} would write to {}, which {} reads", output.option,
                                shown(output, "stdout"), other.use->option));
    written.push_back({&output, std::move(target)});
  }
  // Keep the folders open: another user may replace one before the file is opened.
  for (const Checked& output : written) {
    const OutputTarget& target = output.target;
    if (!target.descriptor) keep_found(output.use->path, target.info);
    if (target.descriptor || (target.info && !S_ISREG(target.info->st_mode))) continue;
    keep_folder(target.linked ? target.path.parent_path() : target.named.parent_path(),
                folder_of(target));
  }
}

std::optional<std::string> why_no_new_folder(const fs::path& path) {
  fs::path trimmed = path;
  while (trimmed.has_relative_path() && !trimmed.has_filename()) trimmed = trimmed.parent_path();
  if (!trimmed.has_relative_path())
    return path.empty() ? "it is empty" : "it is the root of the file system";
  const fs::path last = trimmed.filename();
  if (last == "." || last == "..") return fmt::format("it ends with {}", last.string());
  return std::nullopt;
}

bool is_unfinished_name(std::string_view name) {
  return unfinished(name).has_value();
}

void sweep_unfinished(const fs::path& folder, std::string_view name) {
  const Descriptor opened(::open(folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  if (opened.get() >= 0) sweep_all(opened.get(), name);
}

}  // namespace cde
