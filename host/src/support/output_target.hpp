// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sys/stat.h>
#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <vector>

#include "support/descriptor.hpp"

/// Resolves an output's name, and opens it safely in folders where another user may rename files.
/// Private to the library.
namespace cde {

/// Error kFile "PATH: cannot DOING: REASON" for an errno value.
[[noreturn]] void fail_output(const std::filesystem::path& path, const char* doing, int number);

std::optional<struct stat> info_of(int descriptor);

struct OutputTarget {
  /// The path as named, and the absolute path without links. In a folder that this process holds
  /// open both are /proc/self/fd/FOLDER/NAME.
  std::filesystem::path named, path;
  std::optional<int>
      descriptor;  ///< a descriptor of this process, as for /dev/stdout and /dev/fd/N
  std::optional<struct stat> info;  ///< nothing if the file does not exist yet
  std::vector<uid_t> strangers;     ///< other users whose links were followed
  bool linked = false;              ///< the last component was a link
};

/// Follows links in the last component by hand. Links in /proc/self/fd are not paths, and a link to
/// a missing file names where to create it. Error kFile if the target is a folder, or if another
/// user's link leads to a descriptor or to a file that this user does not own. Error kFile for any
/// link in a held folder, for another user's FIFO or device there, and for a descriptor below
/// another name of /proc/self/fd.
[[nodiscard]] OutputTarget follow_output(const std::filesystem::path& named);

/// Checks a folder that was opened by name. Error kFile if another user's link led to a folder that
/// this user does not own, or if the name leads elsewhere by now.
void check_folder_link(const std::filesystem::path& named, int folder);

/// Where a link to a missing folder leads, one link further. Error kFile if the link is another
/// user's, or if the target's own folder does not exist. `named` is the name for the text.
[[nodiscard]] std::filesystem::path behind_link(const std::filesystem::path& named,
                                                const std::filesystem::path& link);

/// Keeps a folder open under its absolute name. From then on, follow_output() finds outputs in that
/// folder through the descriptor, even if the folder is renamed or replaced. A later folder of the
/// same name takes its place.
void keep_folder(const std::filesystem::path& folder, Descriptor opened);

/// What was at an output's name at the start of the command.
struct FoundOutput {
  std::optional<struct stat> info;  ///< nothing if the name was free
};

/// Remembers what is at an output's name. A later file of the same name takes its place.
void keep_found(const std::filesystem::path& named, const std::optional<struct stat>& info);

/// What keep_found() was given for the name.
[[nodiscard]] std::optional<FoundOutput> kept_found(const std::filesystem::path& named);

/// Whether two files are one: the same inode, of the same type and user. A removed file's number
/// may be given to a file of another user.
[[nodiscard]] bool is_same_file(const struct stat& a, const struct stat& b);

/// Error kFile "PATH: cannot write: another user of its folder has replaced it".
[[noreturn]] void fail_replaced(const std::filesystem::path& named);

/// Whether the path is a name in a folder that this process holds open, as /proc/self/fd/N/NAME.
[[nodiscard]] bool is_in_held_folder(const std::filesystem::path& path);

/// Whether two targets are the same name in the same folder.
[[nodiscard]] bool same_name(const OutputTarget& a, const OutputTarget& b);

/// Opens the target's folder component by component. A component that has become a link is an
/// error. The owners of all followed links must still own the target.
[[nodiscard]] Descriptor folder_of(const OutputTarget& target);

/// Opens the existing file, or creates it with this mode if `flags` say so. Error kFile if it has
/// become a link or another file since it was resolved. Waits for the reader of a FIFO. Error kFile
/// if the FIFO belongs to another user and has no reader.
[[nodiscard]] Descriptor open_output(const OutputTarget& target, int flags, mode_t mode = 0666);

}  // namespace cde
