// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

namespace cde::wave {

/// A stretch of a wave file that is read at once: its range of times.
struct Section {
  std::uint64_t begin = 0, end = 0;
};

/// A range of times for which the simulation wrote no changes ($dumpoff).
struct Blackout {
  std::uint64_t from = 0, to = 0;
};

/// Parts of a wave file.
struct Structure {
  std::uint64_t bytes = 0;
  std::vector<Section> sections;  ///< in the order of the file
  bool closed = true;             ///< the writer closed the file
};

}  // namespace cde::wave
