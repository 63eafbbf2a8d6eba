// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

namespace cde::wave {

/// A stretch of a wave file that is read as a whole: the times that it spans.
struct Section {
  std::uint64_t begin = 0, end = 0;
};

/// From `from` to `to` the simulation wrote no changes ($dumpoff).
struct Blackout {
  std::uint64_t from = 0, to = 0;
};

/// What a wave file says of its parts.
struct Structure {
  std::uint64_t bytes = 0;
  std::vector<Section> sections;  ///< in the order of the file
  bool closed = true;             ///< the writer has come to its end
};

}  // namespace cde::wave
