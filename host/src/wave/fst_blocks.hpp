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

/// A block of an FST file: its kind, where it begins, and the bytes behind its kind.
struct FstBlock {
  int type = 0;
  std::uint64_t at = 0, length = 0;
};

/// What the blocks of an FST file say of themselves.
struct FstBlocks {
  std::string header;  ///< the first block
  std::vector<FstBlock> blocks;
  std::uint64_t whole = 0;  ///< where the last whole block ends
  bool closed = true;       ///< the writer has come to its end
  bool headless = false;    ///< the header is zeros: its writer writes it at the end
  Structure structure;
  std::vector<Blackout> blackouts;

  /// Of the header; what begins at this byte.
  [[nodiscard]] std::uint64_t word(std::size_t at) const;
  [[nodiscard]] std::uint64_t handles() const { return word(57); }
  /// Blocks of changes, as many as there are sections.
  [[nodiscard]] std::vector<FstBlock> changes() const;
  /// The first block of one of two kinds; null if there is none.
  [[nodiscard]] const FstBlock* find(int type, int other = -1, int third = -1) const;
};

/// Whether the file begins with the header of an FST.
[[nodiscard]] bool has_fst_header(const WaveBytes& file);

/// Finds the blocks. Error kFile for a file that is no FST or is cut off. Blocks of one that was
/// not closed are those that are whole.
[[nodiscard]] FstBlocks find_fst_blocks(const WaveBytes& file);

/// Reads the frame of every block: the lengths of what is in it, and how large that says to become
/// when it is decompressed. Error kFile for one that contradicts itself: Verilator's reader
/// believes all of these numbers. `widths` are bytes of each handle's value, from handle 1; the
/// file must have values of as many.
void check_fst_blocks(const WaveBytes& file, FstBlocks& found,
                      const std::vector<std::uint32_t>& widths);

/// The first time in the table of times of a block of changes.
[[nodiscard]] std::uint64_t first_fst_time(const WaveBytes& file, const FstBlock& block);

/// Bytes of each handle's value, 0 of texts, and whether it is real, as the file's own block says.
struct FstWidths {
  std::vector<std::uint32_t> bytes;
  std::vector<bool> real;
};
[[nodiscard]] FstWidths read_fst_widths(const WaveBytes& file, const FstBlocks& found);
/// A block that says the same.
[[nodiscard]] std::string fst_widths_block(const FstWidths& widths);

/// The names as they are in a block of the file, unpacked.
[[nodiscard]] std::string read_fst_names(const WaveBytes& file, const FstBlock& block);

}  // namespace cde::wave
