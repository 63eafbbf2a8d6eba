// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>

namespace cde::testing {

/// Copies the sources of simulation models to `share` and overwrites existing files. Only the owner
/// can write the copy, whatever the modes of the source are (an unpacked archive, or a umask of
/// 002). The driver refuses a builder that others can write.
inline void copy_rtl(const std::filesystem::path& source, const std::filesystem::path& share) {
  namespace fs = std::filesystem;
  fs::create_directories(share / "host/include/cde");
  for (const char* part : {"rtl", "verilator", "host/include/cde/abi", "host/include/cde/contract"})
    fs::copy(source / part, share / part,
             fs::copy_options::recursive | fs::copy_options::overwrite_existing);
  const auto close = [](const fs::path& part) {
    fs::permissions(part, fs::perms::group_write | fs::perms::others_write,
                    fs::perm_options::remove);
  };
  close(share);
  for (const auto& entry : fs::recursive_directory_iterator(share)) close(entry.path());
}

}  // namespace cde::testing
