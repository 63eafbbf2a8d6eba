// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sys/types.h>

#include <string>

/// Who may read and write a file: its mode and access control list (ACL). Private to the library.
namespace cde {

/// The permissions that a default ACL gives to a new file: owner, group or mask, and other.
/// `acl` is the value of the extended attribute.
[[nodiscard]] mode_t mode_by_acl(const std::string& acl);

/// The mode of a new file of mode 0666: without the bits of the umask, or with the bits of the
/// folder's default ACL. The folder may be open as a path only.
[[nodiscard]] mode_t mode_of_new_file(int folder);

/// Gives a new folder, perhaps open as a path only, the mode that the umask allows. The folder
/// loses the ACLs that it inherited.
void set_access_of_new_folder(int folder);

/// The access ACL of a file that is open, perhaps as a path only. Empty if its mode says all.
[[nodiscard]] std::string access_acl(int file);

/// Gives an open file this mode and this access ACL. Without an ACL the file loses the one that it
/// inherited from its folder. False, with errno, if an inherited ACL stays.
[[nodiscard]] bool set_access(int file, mode_t mode, const std::string& acl);

}  // namespace cde
