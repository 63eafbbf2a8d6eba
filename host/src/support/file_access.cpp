// SPDX-License-Identifier: Apache-2.0
#include "support/file_access.hpp"

#include <endian.h>
#include <fmt/format.h>
#include <linux/posix_acl.h>
#include <linux/posix_acl_xattr.h>
#include <sys/stat.h>
#include <sys/xattr.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>

namespace cde {
namespace {

constexpr const char* kAclOfFile = "system.posix_acl_access";
constexpr const char* kAclOfNewFiles = "system.posix_acl_default";

std::string acl_of(int file, const char* kind) {
  std::string acl(XATTR_SIZE_MAX, '\0');
  // fgetxattr() refuses a descriptor that is open as a path only.
  const ssize_t size =
      ::getxattr(fmt::format("/proc/self/fd/{}", file).c_str(), kind, acl.data(), acl.size());
  acl.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  return acl;
}

/// The system call umask() would also change it, for all threads.
mode_t umask_now() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("Umask:"))
      return static_cast<mode_t>(std::strtoul(line.c_str() + 6, nullptr, 8)) & 0777;
  return 077;
}

}  // namespace

mode_t mode_by_acl(const std::string& acl) {
  mode_t owner = 0, group = 0, other = 0;
  bool masked = false;
  posix_acl_xattr_entry entry{};
  for (std::size_t at = sizeof(posix_acl_xattr_header); at + sizeof entry <= acl.size();
       at += sizeof entry) {
    std::memcpy(&entry, acl.data() + at, sizeof entry);
    const mode_t tag = le16toh(entry.e_tag), bits = le16toh(entry.e_perm);
    if (tag == ACL_USER_OBJ) owner = bits;
    if (tag == ACL_OTHER) other = bits;
    if (tag == ACL_MASK || (tag == ACL_GROUP_OBJ && !masked)) group = bits;
    masked = masked || tag == ACL_MASK;
  }
  return owner << 6 | group << 3 | other;
}

mode_t mode_of_new_file(int folder) {
  const std::string acl = acl_of(folder, kAclOfNewFiles);
  return 0666 & (acl.empty() ? ~umask_now() : mode_by_acl(acl));
}

void set_access_of_new_folder(int folder) {
  const std::string name = fmt::format("/proc/self/fd/{}", folder);
  struct stat info {};
  for (const char* kind : {kAclOfNewFiles, kAclOfFile}) (void)::removexattr(name.c_str(), kind);
  if (::fstat(folder, &info) == 0)
    (void)::chmod(name.c_str(), (info.st_mode & S_ISGID) | (0777 & ~umask_now()));
}

std::string access_acl(int file) {
  return acl_of(file, kAclOfFile);
}

bool set_access(int file, mode_t mode, const std::string& acl) {
  if (acl.empty()) {
    if (::fremovexattr(file, kAclOfFile) != 0 && errno != ENODATA && errno != ENOTSUP) return false;
  } else if (::fsetxattr(file, kAclOfFile, acl.data(), acl.size(), 0) != 0) {
    return false;
  }
  (void)::fchmod(file, mode);
  return true;
}

}  // namespace cde
