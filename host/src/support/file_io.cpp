// SPDX-License-Identifier: Apache-2.0
#include "support/file_io.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/magic.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <vector>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"

namespace cde::file_io {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, std::string_view what) {
  throw Error(ErrorCode::kFile, fmt::format("{}: {}", printable_name(path.string()), what));
}

[[noreturn]] void fail_errno(const std::filesystem::path& path, std::string_view what) {
  fail(path, fmt::format("{}: {}", what, std::strerror(errno)));
}

/// Whether the kernel makes the file's bytes while they are read. Reading such a file may block,
/// have no end or have effects.
bool is_of_kernel(const Descriptor& file) {
  struct statfs system {};
  if (::fstatfs(file.get(), &system) != 0) return true;
  for (const std::int64_t magic : {PROC_SUPER_MAGIC, SYSFS_MAGIC, DEBUGFS_MAGIC, TRACEFS_MAGIC,
                                   SECURITYFS_MAGIC, CGROUP_SUPER_MAGIC, CGROUP2_SUPER_MAGIC})
    if (std::int64_t{system.f_type} == magic) return true;
  return false;
}

struct stat status_of(const Descriptor& file, const std::filesystem::path& path) {
  if (file.get() < 0) fail_errno(path, "cannot be opened");
  struct stat info {};
  if (::fstat(file.get(), &info) != 0) fail_errno(path, "cannot be examined");
  if (S_ISDIR(info.st_mode)) fail(path, "is a directory");
  if (S_ISREG(info.st_mode) && is_of_kernel(file)) fail(path, "is a file of the kernel");
  return info;
}

std::string all_bytes(const Descriptor& file, const std::filesystem::path& path,
                      std::uint64_t expected, std::uint64_t most) {
  const auto refuse = [&] { fail(path, fmt::format("has more than {} bytes", most)); };
  if (expected > most) refuse();
  std::string bytes;
  bytes.reserve(expected + 1);
  std::vector<char> block(std::size_t{1} << 18);
  for (;;) {
    const ssize_t n = ::read(file.get(), block.data(), block.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail_errno(path, "cannot be read");
    if (n == 0) return bytes;
    if (bytes.size() + static_cast<std::size_t>(n) > most) refuse();
    bytes.append(block.data(), static_cast<std::size_t>(n));
  }
}

}  // namespace

std::string read(const std::filesystem::path& path, uid_t* owner, std::uint64_t most) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY));
  const struct stat info = status_of(file, path);
  if (!S_ISREG(info.st_mode) && !S_ISFIFO(info.st_mode)) fail(path, "is not a file");
  if (owner != nullptr) *owner = info.st_uid;
  const auto size = S_ISREG(info.st_mode) ? static_cast<std::uint64_t>(info.st_size) : 0;
  return all_bytes(file, path, size, most);
}

Descriptor open_regular(const std::filesystem::path& path) {
  Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
  if (!S_ISREG(status_of(file, path).st_mode)) fail(path, "is not a regular file");
  return file;
}

std::string read_regular(const std::filesystem::path& path, std::uint64_t most, uid_t* owner) {
  const Descriptor file = open_regular(path);
  const struct stat info = status_of(file, path);
  if (owner != nullptr) *owner = info.st_uid;
  return all_bytes(file, path, static_cast<std::uint64_t>(info.st_size), most);
}

std::uint64_t size_of_regular(const std::filesystem::path& path) {
  return static_cast<std::uint64_t>(status_of(open_regular(path), path).st_size);
}

}  // namespace cde::file_io
