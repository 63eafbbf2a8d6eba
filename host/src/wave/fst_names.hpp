// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "cde/wave/wave_source.hpp"
#include "wave/fst_blocks.hpp"

namespace cde::wave {

/// Reads the names of an FST file, of any length. Error kFile with the byte within the names.
/// `from` says in messages where they are; handles beyond `most` are an error. A last entry that
/// is cut off is one, too, but where `cut` says that it was cut: then it is left out.
struct FstNames {
  const WaveBytes& file;
  std::string from;
  std::uint32_t most = 0;
  bool cut = false;

  void read(std::string_view text, const SourceVisit& visit) const;
  /// Widths of all handles that names are given.
  [[nodiscard]] FstWidths widths(std::string_view text) const;
};

}  // namespace cde::wave
