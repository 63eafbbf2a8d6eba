// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "cde/bitstream/bitstream.hpp"
#include "cde/bitstream/bus.hpp"

namespace cde {

/// Something that is made to go wrong in one frame of a scene (PlayOptions::faults).
struct ScheduledFault {
  std::uint32_t frame = 0;
  std::optional<BusFault> bus;  ///< at the start of the frame; nothing: bits of DDR are flipped,
                                ///< when the first query's secondaries lie there
  std::uint32_t count = 1;      ///< bus: as Board::inject's. DDR: words of 32 bits that get wrong
                                ///< bits, anywhere in those secondaries, the same in every run
  std::uint32_t value = 1;      ///< bus: as Board::inject's. DDR: wrong bits in a word, 1 to 32
};

/// "KIND[:COUNT[:VALUE]]@FRAME": KIND is the name of a BusFault, or "ddr" for bits of DDR; COUNT is
/// at least 1, or "all" for every transaction from then on; VALUE is only for kinds that have one.
/// Error kUsage naming what is wrong.
[[nodiscard]] ScheduledFault fault_of(std::string_view text);
/// The same text, complete.
[[nodiscard]] std::string text_of(const ScheduledFault& fault);

/// Error kUsage if a board has no such fault.
void check_fault(const ScheduledFault& fault, const BoardConfig& board);

}  // namespace cde
