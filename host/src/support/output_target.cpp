// SPDX-License-Identifier: Apache-2.0
#include "support/output_target.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <climits>
#include <cstring>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"

namespace cde {

namespace fs = std::filesystem;

namespace {

/// The folder of this process's descriptors, without links.
fs::path own_descriptors() {
  return fs::path("/proc") / std::to_string(::getpid()) / "fd";
}

/// The descriptor that a name in that folder means.
std::optional<int> descriptor_of(const fs::path& name) {
  const std::string& digits = name.native();
  int number = 0;
  const auto [stop, bad] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (bad != std::errc() || stop != digits.data() + digits.size()) return std::nullopt;
  return number;
}

/// The folder's descriptor in /proc/self/fd/FOLDER/NAME or /proc/PID/fd/FOLDER/NAME, if this
/// process holds it open.
std::optional<int> held_folder(const fs::path& path) {
  const fs::path folder = path.parent_path();
  const fs::path all = folder.parent_path();
  if (all != "/proc/self/fd" && all != own_descriptors()) return std::nullopt;
  return descriptor_of(folder.filename());
}

std::mutex kept_mutex;
std::map<fs::path, FoundOutput>& kept_outputs() {
  static std::map<fs::path, FoundOutput> kept;
  return kept;
}
std::map<fs::path, Descriptor>& kept_folders() {
  static std::map<fs::path, Descriptor> kept;
  return kept;
}

/// The absolute name of a folder; empty if it contains "..", which a link may lead anywhere.
fs::path key_of(const fs::path& folder) {
  std::error_code error;
  const fs::path whole = fs::absolute(folder.empty() ? fs::path(".") : folder, error);
  for (const fs::path& part : whole)
    if (error || part == "..") return {};
  const fs::path key = whole.lexically_normal();
  return key.has_filename() ? key : key.parent_path();
}

/// The descriptor of a folder that keep_folder() was given, unless that folder was removed.
std::optional<int> kept_folder(const fs::path& folder) {
  const std::lock_guard lock(kept_mutex);
  const auto found = kept_folders().find(key_of(folder));
  if (found == kept_folders().end()) return std::nullopt;
  const auto info = info_of(found->second.get());
  if (!info || info->st_nlink == 0) return std::nullopt;
  return found->second.get();
}

/// The path to show: a name in a held folder is shown with that folder's name.
std::string shown(const fs::path& path) {
  std::error_code error;
  if (!held_folder(path)) return printable_name(path.string());
  const fs::path folder = fs::read_symlink(path.parent_path(), error);
  return printable_name((error ? path : folder / path.filename()).string());
}

}  // namespace

void keep_folder(const fs::path& folder, Descriptor opened) {
  const fs::path key = key_of(folder);
  if (key.empty() || opened.get() < 0) return;
  const std::lock_guard lock(kept_mutex);
  const auto found = kept_folders().find(key);
  if (found != kept_folders().end()) {  // resolved targets name the descriptor
    const auto kept = info_of(found->second.get()), now = info_of(opened.get());
    if (kept && now && kept->st_dev == now->st_dev && kept->st_ino == now->st_ino) return;
  }
  kept_folders().insert_or_assign(key, std::move(opened));
}

void keep_found(const fs::path& named, const std::optional<struct stat>& info) {
  std::error_code error;
  const std::lock_guard lock(kept_mutex);
  kept_outputs().insert_or_assign(fs::absolute(named, error), FoundOutput{info});
}

std::optional<FoundOutput> kept_found(const fs::path& named) {
  std::error_code error;
  const std::lock_guard lock(kept_mutex);
  const auto found = kept_outputs().find(fs::absolute(named, error));
  return found == kept_outputs().end() ? std::nullopt : std::optional(found->second);
}

bool is_same_file(const struct stat& a, const struct stat& b) {
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino && a.st_uid == b.st_uid &&
         (a.st_mode & S_IFMT) == (b.st_mode & S_IFMT);
}

bool is_in_held_folder(const fs::path& path) {
  return held_folder(path).has_value();
}

void fail_replaced(const fs::path& named) {
  throw Error(
      ErrorCode::kFile,
      fmt::format("{}: cannot write: another user of its folder has replaced it", shown(named)));
}

bool same_name(const OutputTarget& a, const OutputTarget& b) {
  std::error_code error;
  return a.path.filename() == b.path.filename() &&
         fs::equivalent(a.path.parent_path(), b.path.parent_path(), error);
}

void fail_output(const fs::path& path, const char* doing, int number) {
  throw Error(ErrorCode::kFile,
              fmt::format("{}: cannot {}: {}", shown(path), doing, std::strerror(number)));
}

std::optional<struct stat> info_of(int descriptor) {
  struct stat info {};
  if (::fstat(descriptor, &info) != 0) return std::nullopt;
  return info;
}

namespace {

[[noreturn]] void fail_stranger(const OutputTarget& target, uid_t stranger, std::string_view what) {
  throw Error(
      ErrorCode::kFile,
      fmt::format("{}: cannot write: it is a link owned by user {} to {}, {}", shown(target.named),
                  stranger, printable_name(target.path.string()), what));
}

/// Another user's link may lead only to that user's own files. Otherwise its owner would choose
/// which file of this user or of a third user is replaced.
void check_link(const OutputTarget& target, const struct stat& owned) {
  for (const uid_t stranger : target.strangers)
    if (owned.st_uid != stranger)
      fail_stranger(target, stranger, fmt::format("which user {} owns", owned.st_uid));
}

/// Adds the owner of a link that was followed, if that is another user.
void add_stranger(OutputTarget& target, const struct stat& link) {
  if (link.st_uid != 0 && link.st_uid != ::geteuid()) target.strangers.push_back(link.st_uid);
}

/// What a path names, without following it. `to` is the text of a link. Both come from one open
/// descriptor, so the owner of the folder cannot exchange the entry in between.
struct Entry {
  struct stat info {};
  fs::path to;
};

/// Returns null, with errno, if nothing is at the path or it cannot be read.
std::optional<Entry> entry_at(const fs::path& path) {
  const Descriptor opened(::open(path.c_str(), O_PATH | O_NOFOLLOW | O_CLOEXEC));
  Entry entry;
  if (opened.get() < 0 || ::fstat(opened.get(), &entry.info) != 0) return std::nullopt;
  if (!S_ISLNK(entry.info.st_mode)) return entry;
  std::array<char, PATH_MAX> text{};
  const ssize_t length = ::readlinkat(opened.get(), "", text.data(), text.size());
  if (length < 0) return std::nullopt;
  entry.to = std::string(text.data(), static_cast<std::size_t>(length));
  return entry;
}

/// For a link to `to`, whose folder cannot be entered for this reason.
[[noreturn]] void fail_link(const fs::path& named, const fs::path& to, int number) {
  throw Error(
      ErrorCode::kFile,
      fmt::format("{}: cannot create: it is a link to {}, whose folder {}", shown(named),
                  printable_name(to.string()), number == ENOTDIR ? "is a file" : "does not exist"));
}

}  // namespace

void check_folder_link(const fs::path& named, int folder) {
  constexpr int kMostLinks = 40;
  OutputTarget target{named, named, std::nullopt, info_of(folder), {}};
  struct stat found {};
  for (int links = 0;; ++links) {
    fs::path& at = target.path;
    while (at.has_parent_path() && at != at.root_path() &&
           (!at.has_filename() || at.filename() == "."))
      at = at.parent_path();
    const auto entry = entry_at(at);
    if (!entry) fail_output(named, "write", errno);
    found = entry->info;
    if (!S_ISLNK(found.st_mode)) break;
    if (links == kMostLinks) fail_output(named, "write", ELOOP);
    add_stranger(target, found);
    at = at.parent_path() / entry->to;
  }
  if (!target.info || found.st_dev != target.info->st_dev || found.st_ino != target.info->st_ino)
    fail_replaced(named);
  check_link(target, *target.info);
}

fs::path behind_link(const fs::path& named, const fs::path& link) {
  const auto entry = entry_at(link);
  if (!entry || !S_ISLNK(entry->info.st_mode)) fail_output(named, "create", entry ? EINVAL : errno);
  struct stat info = entry->info;
  const fs::path& to = entry->to;
  if (info.st_uid != 0 && info.st_uid != ::geteuid())
    throw Error(ErrorCode::kFile,
                fmt::format("{}: cannot create: it is a link owned by user {} to {}, which does "
                            "not exist",
                            shown(named), info.st_uid, printable_name(to.string())));
  fs::path target = link.parent_path() / to;
  while (target.has_relative_path() && (!target.has_filename() || target.filename() == "."))
    target = target.parent_path();
  if (::stat(target.parent_path().c_str(), &info) != 0) fail_link(named, to, errno);
  if (!S_ISDIR(info.st_mode)) fail_link(named, to, ENOTDIR);
  return target;
}

namespace {

/// The target for a name in a folder that this process holds open. The folder's name may lead
/// elsewhere by now, so the code does not use it.
OutputTarget held_target(const fs::path& named, int folder) {
  OutputTarget target{named, named, std::nullopt, std::nullopt, {}};
  struct stat info {};
  if (::fstatat(folder, named.filename().c_str(), &info, AT_SYMLINK_NOFOLLOW) != 0) {
    if (errno != ENOENT) fail_output(named, "write", errno);
    return target;
  }
  if (S_ISLNK(info.st_mode) || S_ISDIR(info.st_mode))
    fail_output(named, "write", S_ISDIR(info.st_mode) ? EISDIR : ELOOP);
  if (!S_ISREG(info.st_mode) && info.st_uid != ::geteuid()) fail_replaced(named);
  target.info = info;
  return target;
}

/// Completes a target in own_descriptors(), whose folder was named `parent`. Another user's link
/// must not choose a descriptor, which may be any file of this user. A link to the folder itself
/// may be another user's, so only the folder's own names are accepted.
OutputTarget descriptor_target(OutputTarget target, const fs::path& parent) {
  if (!target.strangers.empty())
    fail_stranger(target, target.strangers.front(), "a descriptor of this process");
  const fs::path name = target.path.filename(), key = key_of(parent);
  if (key != "/dev/fd" && key != "/proc/self/fd" && key != own_descriptors())
    throw Error(ErrorCode::kFile,
                fmt::format("{}: cannot write: its folder is a link to /proc/self/fd; name the "
                            "descriptor as /dev/fd/{}",
                            shown(target.named), printable_name(name.string())));
  target.descriptor = descriptor_of(name);
  if (!target.descriptor) fail_output(target.named, "write", ENOENT);
  target.info = info_of(*target.descriptor);
  if (!target.info) fail_output(target.named, "write", EBADF);
  return target;
}

}  // namespace

OutputTarget follow_output(const fs::path& named) {
  if (const auto folder = held_folder(named)) return held_target(named, *folder);
  constexpr int kMostLinks = 40;
  OutputTarget target{named, named, std::nullopt, std::nullopt, {}};
  fs::path& path = target.path;
  fs::path link;  // what the last followed link says
  const auto fail = [&](const char* doing, int number) {
    if (!link.empty() && (number == ENOENT || number == ENOTDIR)) fail_link(named, link, number);
    fail_output(named, doing, number);
  };
  const auto found = [&](std::optional<struct stat> info) {
    target.info = info;
    target.linked = !link.empty();
    if (struct stat folder{}; info)
      check_link(target, *info);
    else if (::stat(path.parent_path().c_str(), &folder) == 0)
      check_link(target, folder);
    return target;
  };
  for (int links = 0; links < kMostLinks; ++links) {
    if (!path.has_filename()) fail_output(named, "write", path.empty() ? ENOENT : EISDIR);
    std::error_code error;
    const fs::path parent = path.has_parent_path() ? path.parent_path() : fs::path(".");
    const auto kept = kept_folder(parent);
    const fs::path folder =
        kept ? fs::path("/proc/self/fd") / std::to_string(*kept) : fs::canonical(parent, error);
    if (error) fail("create", error.value());
    const std::string name = path.filename();
    path = folder / name;
    if (folder == own_descriptors()) return descriptor_target(std::move(target), parent);
    const auto entry = entry_at(path);
    if (!entry) {
      if (errno == ENOENT) return found(std::nullopt);
      fail("write", errno);
    }
    if (!S_ISLNK(entry->info.st_mode)) {
      if (S_ISDIR(entry->info.st_mode)) fail_output(named, "write", EISDIR);
      return found(entry->info);
    }
    add_stranger(target, entry->info);
    link = entry->to;
    path = folder / link;  // an absolute link replaces the folder
  }
  fail_output(named, "write", ELOOP);
}

Descriptor folder_of(const OutputTarget& target) {
  if (const auto held = held_folder(target.path)) {
    Descriptor again(::fcntl(*held, F_DUPFD_CLOEXEC, 0));
    if (again.get() < 0) fail_output(target.named, "create", errno);
    return again;
  }
  constexpr int kFolder = O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC;
  int at = ::open("/", kFolder);
  for (const fs::path& part : target.path.parent_path().relative_path()) {
    const int next = at < 0 ? -1 : ::openat(at, part.c_str(), kFolder);
    const int number = errno;
    if (at >= 0) ::close(at);
    errno = number;
    at = next;
  }
  if (at < 0) fail_output(target.named, "create", errno);
  if (!target.strangers.empty()) {
    struct stat owned {};
    const bool there =
        ::fstatat(at, target.path.filename().c_str(), &owned, AT_SYMLINK_NOFOLLOW) == 0;
    if (!there && ::fstat(at, &owned) != 0) fail_output(target.named, "create", errno);
    check_link(target, owned);
  }
  return Descriptor(at);
}

namespace {

/// Opens the file that `there` leads to as a path only.
Descriptor open_again(const OutputTarget& target, const Descriptor& there, int flags) {
  const struct stat& info = *target.info;
  // A FIFO of another user could let this process wait for ever.
  const bool foreign = S_ISFIFO(info.st_mode) && info.st_uid != 0 && info.st_uid != ::geteuid();
  const std::string name = fmt::format("/proc/self/fd/{}", there.get());
  Descriptor file(
      ::open(name.c_str(), (flags & ~O_CREAT) | O_NOCTTY | O_CLOEXEC | (foreign ? O_NONBLOCK : 0)));
  if (file.get() < 0 && errno == ENXIO && foreign)
    throw Error(ErrorCode::kFile,
                fmt::format("{}: cannot write: it is a FIFO of user {} that no process reads",
                            shown(target.named), info.st_uid));
  if (file.get() < 0) fail_output(target.named, "write", errno);
  if (foreign) (void)::fcntl(file.get(), F_SETFL, ::fcntl(file.get(), F_GETFL) & ~O_NONBLOCK);
  return file;
}

}  // namespace

Descriptor open_output(const OutputTarget& target, int flags, mode_t mode) {
  if (target.descriptor) {
    Descriptor again(::fcntl(*target.descriptor, F_DUPFD_CLOEXEC, 0));
    if (again.get() < 0) fail_output(target.named, "write", errno);
    return again;
  }
  const Descriptor folder = folder_of(target);
  const std::string name = target.path.filename();
  if (target.info) {
    const Descriptor there(::openat(folder.get(), name.c_str(), O_PATH | O_NOFOLLOW | O_CLOEXEC));
    const auto info = info_of(there.get());
    if (!info) fail_output(target.named, "write", errno);
    if (!is_same_file(*info, *target.info)) fail_replaced(target.named);
    return open_again(target, there, flags);
  }
  Descriptor file(
      ::openat(folder.get(), name.c_str(), flags | O_NOFOLLOW | O_NOCTTY | O_CLOEXEC, mode));
  if (file.get() < 0) fail_output(target.named, "write", errno);
  return file;
}

}  // namespace cde
