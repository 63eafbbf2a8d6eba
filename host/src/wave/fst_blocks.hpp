// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "cde/wave/structure.hpp"
#include "wave/wave_bytes.hpp"

namespace cde::wave {

constexpr std::uint64_t kFstHeaderBytes = 330;
constexpr double kFstByteOrder = 2.7182818284590452354;  ///< byte 25 of the header

/// A block of an FST file: its kind, its place, and the bytes after its kind.
struct FstBlock {
  int type = 0;
  std::uint64_t at = 0, length = 0;
};

/// The blocks of an FST file, and their contents' description.
struct FstBlocks {
  std::string header;  ///< the first block
  std::vector<FstBlock> blocks;
  std::uint64_t whole = 0;  ///< end of the last complete block
  bool closed = true;       ///< whether the writer finished the file
  bool headless = false;    ///< the header is zeros: its writer writes it at the end
  Structure structure;
  std::vector<Blackout> blackouts;

  /// The 64-bit word of the header at this byte.
  [[nodiscard]] std::uint64_t word(std::size_t at) const;
  [[nodiscard]] std::uint64_t handles() const { return word(57); }
  /// Blocks of changes, as many as there are sections.
  [[nodiscard]] std::vector<FstBlock> changes() const;
  /// The first block of one of these kinds; null if there is none.
  [[nodiscard]] const FstBlock* find(int type, int other = -1, int third = -1) const;
};

/// Whether the file begins with an FST header.
[[nodiscard]] bool has_fst_header(const WaveBytes& file);

/// Finds the blocks. Error kFile for a file that is not FST or is truncated. In a file that was
/// not closed, only complete blocks count.
[[nodiscard]] FstBlocks find_fst_blocks(const WaveBytes& file);

/// Checks the frame of every block: lengths, and sizes after decompression. Error kFile if a block
/// contradicts itself, because Verilator's reader trusts these numbers. `widths` holds bytes per
/// value from handle 1 on; the file must have values for as many handles.
void check_fst_blocks(const WaveBytes& file, FstBlocks& found,
                      const std::vector<std::uint32_t>& widths);

/// The first time in the table of times of a block of changes.
[[nodiscard]] std::uint64_t first_fst_time(const WaveBytes& file, const FstBlock& block);

/// Bytes of each handle's value (0 for texts) and whether it is real, from the file's own block.
struct FstWidths {
  std::vector<std::uint32_t> bytes;
  std::vector<bool> real;
};
[[nodiscard]] FstWidths read_fst_widths(const WaveBytes& file, const FstBlocks& found);
/// Makes a block with these widths.
[[nodiscard]] std::string fst_widths_block(const FstWidths& widths);

/// The names from a block of the file, unpacked.
[[nodiscard]] std::string read_fst_names(const WaveBytes& file, const FstBlock& block);

}  // namespace cde::wave
