// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

namespace cde::wave {

/// A block of changes of an FST file: the times that it spans.
struct Section {
  std::uint64_t begin = 0, end = 0;
};

/// What the blocks of an FST file say of themselves.
struct Structure {
  std::uint64_t bytes = 0;
  std::vector<Section> sections;  ///< in the order of the file
  bool closed = true;             ///< the writer has come to its end
};

/// Reads the frame of every block: its length, the lengths of what is in it, and how large that
/// says to become when it is decompressed. Error kFile for a file that is no FST, is cut off, or
/// contradicts itself: Verilator's reader believes all of these numbers.
[[nodiscard]] Structure check_structure(const std::filesystem::path& file);

}  // namespace cde::wave
