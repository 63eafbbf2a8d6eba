// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sys/stat.h>
#include <sys/types.h>

#include <filesystem>
#include <optional>

#include "support/descriptor.hpp"

/// Where the name of an output leads, and its opening in folders in which another user may rename
/// what lies there. Private to the library.
namespace cde {

/// Error kFile: "PATH: cannot DOING: REASON", of a number as in errno.
[[noreturn]] void fail_output(const std::filesystem::path& path, const char* doing, int number);

std::optional<struct stat> info_of(int descriptor);

struct OutputTarget {
  /// As it was named; absolute, and no link on the way. In a folder that this process holds open
  /// both are /proc/self/fd/FOLDER/NAME.
  std::filesystem::path named, path;
  std::optional<int> descriptor;    ///< of this process, as /dev/stdout and /dev/fd/N are
  std::optional<struct stat> info;  ///< nothing if there is no such file yet
  std::optional<uid_t> stranger;    ///< another user, whose link led here
};

/// Follows the links of the last part by hand: those in /proc/self/fd are no paths, and a link to
/// what is not there yet says where it is to be. Error kFile if the target is a folder, or if a
/// link of another user leads to what that user does not own; in a held folder also if it is a
/// link.
[[nodiscard]] OutputTarget follow_output(const std::filesystem::path& named);

/// Error kFile if a folder was opened through a link of another user, who does not own it, or if
/// its name leads elsewhere by now.
void check_folder_link(const std::filesystem::path& named, int folder);

/// The folder of a target, opened part by part: a part that has become a link since is an error.
/// The owner of a link on the way must still own the target.
[[nodiscard]] Descriptor folder_of(const OutputTarget& target);

/// Opens what is there, or makes it if `flags` say so. Error kFile if it has become a link, or
/// another file than the one that was looked at.
[[nodiscard]] Descriptor open_output(const OutputTarget& target, int flags);

}  // namespace cde
