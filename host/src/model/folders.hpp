// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// Finds simulation models and their builder, and checks that other users cannot change them.
/// Private to the library.
namespace cde::folders {

/// Why code of this file must not run: its owner is neither root nor this user, or others may write
/// it. Nothing if it may run or does not exist. `named` is the file's name for the text.
[[nodiscard]] std::optional<std::string> distrust(const std::filesystem::path& path,
                                                  const std::filesystem::path& named);

/// A folder that stays open until the process ends. Its path may later lead elsewhere; `inside`
/// (/proc/self/fd/N) does not.
struct Opened {
  std::filesystem::path named, inside;
  std::optional<std::string> distrust;  ///< why its content must not run; `inside` is then empty
};
/// Opens a folder; nothing if it does not exist. Does not follow another user's link.
[[nodiscard]] std::optional<Opened> open(const std::filesystem::path& folder);

/// The folder with rtl/ and verilator/: $CDE_SHARE, the installation's, or the source tree. Error
/// kBuild if there is none. Error kFile if another user can change a file that the builder runs or
/// compiles, or a folder or link above it.
[[nodiscard]] std::filesystem::path share();

/// Folders with ready-made simulation models, in search order: $CDE_MODELS, then the folder of
/// the running installation or build.
[[nodiscard]] std::vector<std::filesystem::path> ready_made();

/// The user's cache, which may not exist. Error kFile if no place for it is known.
[[nodiscard]] std::filesystem::path cache();

/// The checksum file beside a cached file: comments, and a line in the format of sha256sum.
[[nodiscard]] std::filesystem::path checksum_file(const std::filesystem::path& file);

/// The cache, created for its owner alone if necessary, without an ACL. Error kFile if it cannot be
/// created, is not trusted, or has a default ACL that lets other users write new files.
[[nodiscard]] Opened make_cache();

/// The same for simulation models. Error kFile also if the system would not load a library from it.
[[nodiscard]] Opened make_model_cache();

}  // namespace cde::folders
