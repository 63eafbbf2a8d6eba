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
/// `from` describes their source in messages. A handle beyond `most` is an error. A truncated last
/// entry is an error, unless `cut` is set: then it is left out.
struct FstNames {
  const WaveBytes& file;
  std::string from;
  std::uint32_t most = 0;
  bool cut = false;

  void read(std::string_view text, const SourceVisit& visit) const;
  /// Widths of all handles that have names.
  [[nodiscard]] FstWidths widths(std::string_view text) const;
};

}  // namespace cde::wave
