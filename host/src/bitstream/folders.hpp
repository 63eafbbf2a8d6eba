// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// Where bitstreams and their builder are, and whether they are anybody else's. Private to the
/// library.
namespace cde::folders {

/// Why code of this file is not to run here: it belongs to somebody who is neither root nor this
/// user, or others may write it. None if it may run, or is not there. `named` is the file's name in
/// the text.
[[nodiscard]] std::optional<std::string> distrust(const std::filesystem::path& path,
                                                  const std::filesystem::path& named);

/// A folder that stays open to the end of the process. Its path may lead elsewhere later, `inside`
/// (/proc/self/fd/N) does not.
struct Opened {
  std::filesystem::path named, inside;
  std::optional<std::string> distrust;  ///< why nothing of it is to run; `inside` is empty then
};
/// Nothing if there is no such folder. A link of another user is not followed.
[[nodiscard]] std::optional<Opened> open(const std::filesystem::path& folder);

/// Holds rtl/ and verilator/: $CDE_SHARE, the installation's, or the source tree. Error kBuild if
/// there is none, kFile if a file or folder that its builder runs or compiles is somebody else's.
[[nodiscard]] std::filesystem::path share();

/// Folders that may hold ready-made bitstreams, in the order in which they are asked: that of
/// $CDE_BITSTREAMS, and that of the installation or that of the build, whichever runs.
[[nodiscard]] std::vector<std::filesystem::path> ready_made();

/// The user's cache, whether or not it is there. Error kFile if no place for it is known.
[[nodiscard]] std::filesystem::path cache();

/// Beside what is kept in a cache: comments, and a line as of sha256sum.
[[nodiscard]] std::filesystem::path checksum_file(const std::filesystem::path& file);

/// The same, made if need be, for its owner alone. Error kFile if it cannot be, or is not trusted.
[[nodiscard]] Opened make_cache();

}  // namespace cde::folders
