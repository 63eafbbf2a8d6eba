// SPDX-License-Identifier: Apache-2.0
#include "model/folders.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/magic.h>
#include <pwd.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/vfs.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <list>
#include <map>
#include <mutex>
#include <set>
#include <utility>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/shell_word.hpp"
#include "support/descriptor.hpp"
#include "support/file_access.hpp"

/// The installation folder, in programs that found cde by CMake (cdeConfig.cmake); else null.
extern "C" __attribute__((weak)) const char* cde_installed_share();

namespace cde::folders {
namespace {

namespace fs = std::filesystem;

std::optional<fs::path> from_environment(const char* name) {
  const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe)
  if (value == nullptr || *value == '\0') return std::nullopt;
  return fs::path(value);
}

/// The XDG base directory specification ignores paths that are not absolute. cde treats $HOME
/// alike.
std::optional<fs::path> absolute_from_environment(const char* name) {
  const auto path = from_environment(name);
  return path && path->is_absolute() ? path : std::nullopt;
}

bool has_builder(const fs::path& share) {
  std::error_code none;
  return fs::exists(share / "verilator/model_builder", none);
}

bool same(const fs::path& a, const fs::path& b) {
  std::error_code none;
  return fs::equivalent(a, b, none);
}

/// An installation keeps the compiler versions beside its builder; a source tree does not.
bool is_installation(const fs::path& share) {
  std::error_code none;
  return !same(share, CDE_SOURCE_FOLDER) && fs::exists(share / "verilator/toolchain", none);
}

/// Programs of the build tree ignore installations above or beside them.
std::vector<fs::path> share_places() {
  if (cde_installed_share != nullptr)
    return {cde_installed_share(), CDE_SOURCE_FOLDER, CDE_INSTALLED_SHARE};
  std::error_code none;
  const fs::path program = fs::read_symlink("/proc/self/exe", none);
  const fs::path build = fs::weakly_canonical(CDE_BINARY_FOLDER, none);
  if (!program.lexically_relative(build).empty() &&
      *program.lexically_relative(build).begin() != "..")
    return {CDE_SOURCE_FOLDER};
  return {(program.parent_path() / CDE_BINDIR_TO_SHARE).lexically_normal(), CDE_SOURCE_FOLDER,
          CDE_INSTALLED_SHARE};
}

fs::path find_share() {
  if (auto path = from_environment("CDE_SHARE")) return fs::absolute(*path);
  std::string asked;
  for (const fs::path& place : share_places()) {
    if (has_builder(place)) return place;
    asked += fmt::format("{}{}", asked.empty() ? "" : ", ", printable_name(place.string()));
  }
  throw Error(ErrorCode::kBuild,
              fmt::format("no verilator/model_builder in {}; set CDE_SHARE to the "
                          "folder that holds verilator/ and rtl/",
                          asked));
}

std::string owner(const struct stat& status) {
  return fmt::format("belongs to user {}; expected root or user {}, who runs this", status.st_uid,
                     ::geteuid());
}

bool ours(const struct stat& status) {
  return status.st_uid == 0 || status.st_uid == ::geteuid();
}

/// The source tree's owner at configuration time is trusted, as is its group: the user ran the
/// tree's scripts then. Anyone who made a tree of that name since is not trusted.
std::optional<std::string> distrust_source(const struct stat& status, const fs::path& path) {
  if (!ours(status) && status.st_uid != CDE_SOURCE_OWNER) return owner(status);
  if (!S_ISLNK(status.st_mode) && (status.st_mode & S_IWOTH) != 0)
    return fmt::format("can be written by all users (chmod o-w {})", printable_name(path.string()));
  return std::nullopt;
}

std::optional<std::string> distrust_status(const struct stat& status, const fs::path& path) {
  if (!ours(status)) return owner(status);
  if (!S_ISLNK(status.st_mode) && (status.st_mode & (S_IWGRP | S_IWOTH)) != 0)
    return fmt::format("can be written by others than its owner (chmod go-w {})",
                       printable_name(path.string()));
  return std::nullopt;
}

/// Why code of a file with this status must not run.
using Rule = std::optional<std::string> (*)(const struct stat&, const fs::path&);

[[noreturn]] void refuse_share(const fs::path& part, const std::string& why) {
  throw Error(ErrorCode::kFile, fmt::format("the builder of simulation models is refused: {} {}",
                                            printable_name(part.string()), why));
}

/// Refuses a path if another user can change what it leads to. Checks all folders from / on, the
/// links on the way, and the target. In a sticky folder such as /tmp, other users can add names but
/// replace none.
void require_path(const fs::path& path, Rule rule) {
  constexpr int kMostLinks = 40;
  std::list<fs::path> names(path.begin(), path.end());  // names to follow
  fs::path at;
  for (int links = 0;;) {
    names.remove_if([](const fs::path& name) { return name.empty() || name == "."; });
    if (names.empty()) return;
    const fs::path name = names.front();
    names.pop_front();
    if (name == "..") {
      at = at.parent_path();
      continue;
    }
    const fs::path part = at / name;
    struct stat status {};
    if (::lstat(part.c_str(), &status) != 0) {
      if (::lstat(at.c_str(), &status) == 0 && rule(status, at))
        refuse_share(part, "does not exist, and other users can create it");
      return;
    }
    const bool last = names.empty();
    if (!last && S_ISDIR(status.st_mode) && (status.st_mode & S_ISVTX) != 0)
      status.st_mode &= ~static_cast<mode_t>(S_IWGRP | S_IWOTH);
    if (const auto why = rule(status, part)) refuse_share(part, *why);
    if (!S_ISLNK(status.st_mode)) {
      at = part;
      continue;
    }
    std::error_code error;
    const fs::path to = fs::read_symlink(part, error);
    if (error || ++links > kMostLinks) refuse_share(part, "is a link that leads nowhere");
    names.insert(names.begin(), to.begin(), to.end());
  }
}

/// Checks all files that the builder runs, reads or compiles, and their folders, also behind links.
void check_share(const fs::path& share) {
  const Rule rule = same(share, CDE_SOURCE_FOLDER) ? distrust_source : distrust_status;
  for (const fs::path& part : {share, share / "host"}) require_path(part, rule);
  std::vector<fs::path> folders = {share / "verilator", share / "rtl", share / "host/include"};
  for (const fs::path& folder : folders) require_path(folder, rule);
  std::set<fs::path> seen;  // links may lead back
  while (!folders.empty()) {
    const fs::path folder = folders.back();
    folders.pop_back();
    std::error_code error;
    const fs::path real = fs::canonical(folder, error);
    if (error || !seen.insert(real).second) continue;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
      std::error_code none;
      require_path(entry->path(), rule);
      if (entry->is_directory(none)) folders.push_back(entry->path());
    }
  }
}

/// The user's home folder in the system's user database, if there is one.
std::optional<fs::path> home_of_user() {
  std::array<char, 4096> text{};
  passwd entry{};
  passwd* found = nullptr;
  if (::getpwuid_r(::geteuid(), &entry, text.data(), text.size(), &found) != 0 ||
      found == nullptr || found->pw_dir == nullptr)
    return std::nullopt;
  const fs::path home = found->pw_dir;
  std::error_code none;
  return home.is_absolute() && fs::is_directory(home, none) ? std::optional(home) : std::nullopt;
}

fs::path last_resort() {
  return fs::path("/tmp") / fmt::format("cde-{}", ::geteuid());
}

/// The default cache of simulation models, for a user who has such a place.
std::optional<fs::path> own_cache() {
  if (auto xdg = absolute_from_environment("XDG_CACHE_HOME")) return *xdg / "cde";
  if (auto home = absolute_from_environment("HOME")) return *home / ".cache/cde";
  if (auto home = home_of_user()) return *home / ".cache/cde";
  return std::nullopt;
}

/// Whether the folder can be written or created. Nothing can be in /proc and /sys, although
/// access() tells root otherwise.
bool can_be_written(fs::path folder) {
  std::error_code none;
  while (!fs::exists(folder, none) && folder.has_relative_path()) folder = folder.parent_path();
  struct statfs system {};
  if (::statfs(folder.c_str(), &system) != 0 || system.f_type == PROC_SUPER_MAGIC ||
      system.f_type == SYSFS_MAGIC)
    return false;
  return fs::is_directory(folder, none) && ::access(folder.c_str(), W_OK | X_OK) == 0;
}

[[noreturn]] void refuse(const fs::path& folder, const std::string& why) {
  throw Error(ErrorCode::kFile,
              fmt::format("cache of simulation models {}: {} (set CDE_CACHE to use another folder)",
                          printable_name(folder.string()), why));
}

constexpr const char* kAccessAcl = "system.posix_acl_access";
constexpr const char* kDefaultAcl = "system.posix_acl_default";

/// Creates a folder and its parents; false if it exists.
bool make_private(const fs::path& folder) {
  if (folder.has_parent_path() && folder.parent_path() != folder) {
    std::error_code none;
    if (!fs::exists(folder.parent_path(), none)) (void)make_private(folder.parent_path());
  }
  if (::mkdir(folder.c_str(), 0700) == 0) return true;
  if (errno != EEXIST) refuse(folder, fmt::format("cannot be created: {}", std::strerror(errno)));
  return false;
}

/// Removes the ACLs that a new folder inherits from its parent. With a default ACL the system would
/// ignore the umask for all files in the folder.
void drop_acls(const fs::path& folder) {
  const Descriptor made(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  struct stat status {};
  if (made.get() < 0 || ::fstat(made.get(), &status) != 0 || status.st_uid != ::geteuid()) return;
  for (const char* acl : {kAccessAcl, kDefaultAcl}) (void)::fremovexattr(made.get(), acl);
  (void)::fchmod(made.get(), 0700);
}

/// Whether other users may write the files that are created in the folder, because of its default
/// ACL.
bool default_acl_shares(const fs::path& folder) {
  const ssize_t size = ::getxattr(folder.c_str(), kDefaultAcl, nullptr, 0);
  if (size <= 0) return false;
  std::string acl(static_cast<std::size_t>(size), '\0');
  if (::getxattr(folder.c_str(), kDefaultAcl, acl.data(), acl.size()) != size) return true;
  return (mode_by_acl(acl) & (S_IWGRP | S_IWOTH)) != 0;
}

}  // namespace

std::optional<std::string> distrust(const fs::path& path, const fs::path& named) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return std::nullopt;
  return distrust_status(status, named);
}

std::optional<Opened> open(const fs::path& named) {
  // The system would follow a link whose name ends with "/" or "/." before this check.
  fs::path folder = named;
  while (folder.has_relative_path() && (!folder.has_filename() || folder.filename() == "."))
    folder = folder.parent_path();
  struct stat status {};
  if (::lstat(folder.c_str(), &status) != 0) return std::nullopt;
  const bool link = S_ISLNK(status.st_mode);
  if (link && (!ours(status) || folder == last_resort()))
    return Opened{folder, {}, fmt::format("is a link owned by user {}", status.st_uid)};
  const int fd = ::open(folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC | (link ? 0 : O_NOFOLLOW));
  if (fd < 0 || ::fstat(fd, &status) != 0) {
    const int number = errno;
    if (fd >= 0) ::close(fd);
    if (number == ENOENT) return std::nullopt;
    if (number == ENOTDIR) return Opened{folder, {}, "is not a folder"};
    return Opened{folder, {}, fmt::format("cannot be opened: {}", std::strerror(number))};
  }
  // Each folder is opened once and never closed: the loader identifies a library by its name, so a
  // descriptor's number must not be reused.
  static std::mutex mutex;
  static std::map<std::pair<dev_t, ino_t>, int> opened;
  const std::scoped_lock lock(mutex);
  const auto [known, first] = opened.try_emplace({status.st_dev, status.st_ino}, fd);
  if (!first) ::close(fd);
  Opened found{folder, fmt::format("/proc/self/fd/{}", known->second),
               distrust_status(status, folder)};
  if (found.distrust) found.inside.clear();
  return found;
}

fs::path share() {
  const fs::path share = find_share();
  check_share(share);
  return fs::weakly_canonical(share);  // the builder's shell would take LINK/.. for its own folder
}

std::vector<fs::path> ready_made() {
  std::vector<fs::path> folders;
  if (auto path = from_environment("CDE_MODELS")) folders.push_back(fs::absolute(*path));
  const fs::path share = find_share();
  if (is_installation(share)) {
    folders.push_back((share / CDE_SHARE_TO_MODELS).lexically_normal());
  } else if (same(share, CDE_SOURCE_FOLDER)) {
    folders.emplace_back(CDE_MODEL_FOLDER);
  }
  return folders;
}

fs::path checksum_file(const fs::path& file) {
  return fs::path(file) += ".sha256";
}

fs::path cache() {
  if (auto path = from_environment("CDE_CACHE")) return fs::absolute(*path);
  const auto own = own_cache();
  return own && can_be_written(*own) ? *own : last_resort();
}

Opened make_cache() {
  fs::path folder = cache();
  static std::once_flag once;
  if (const auto own = own_cache(); own && folder == last_resort() && folder != *own)
    std::call_once(once, [&] {
      log(
          fmt::format("cde: cache of simulation models {} cannot be written; using {} instead (set "
                      "CDE_CACHE to use another folder)\n",
                      printable_name(own->string()), printable_name(folder.string())));
    });
  if (make_private(folder)) drop_acls(folder);
  auto made = open(folder);
  if (!made) refuse(folder, "has disappeared");
  if (made->distrust) refuse(folder, *made->distrust);
  if (default_acl_shares(made->inside))
    refuse(folder, fmt::format("its default ACL lets other users write new files; remove the ACL "
                               "with: setfacl -k {}",
                               shell_word(folder.string())));
  return std::move(*made);
}

Opened make_model_cache() {
  Opened made = make_cache();
  struct statvfs system {};
  if (::statvfs(made.inside.c_str(), &system) == 0 && (system.f_flag & ST_NOEXEC) != 0)
    throw Error(ErrorCode::kFile,
                fmt::format("cache of simulation models {}: mounted noexec; set CDE_CACHE to a "
                            "folder that may hold programs",
                            printable_name(made.named.string())));
  return made;
}

}  // namespace cde::folders
