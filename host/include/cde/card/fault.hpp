// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "cde/model/bus.hpp"
#include "cde/model/model.hpp"

namespace cde {

/// A fault to inject in one frame of a scene (RunnerOptions::faults).
struct ScheduledFault {
  std::uint32_t frame = 0;
  std::optional<BusFault> bus;  ///< injected at the start of the frame. Nothing: bits of DDR are
                                ///< flipped once the first query's secondaries are in DDR
  std::uint32_t count = 1;  ///< bus: as for Board::inject. DDR: number of 32-bit words with flipped
                            ///< bits, anywhere in those secondaries, the same in every run
  std::uint32_t value = 1;  ///< bus: as for Board::inject. DDR: flipped bits per word, 1 to 32
};

/// Parses "KIND[:COUNT[:VALUE]]@FRAME". KIND is the name of a BusFault, or "ddr" for bits of DDR.
/// COUNT is at least 1, or "all" for every transaction from then on. VALUE is only for kinds that
/// have one. Error kUsage, naming the problem.
[[nodiscard]] ScheduledFault fault_of(std::string_view text);
/// The same text, with all fields.
[[nodiscard]] std::string text_of(const ScheduledFault& fault);

/// Error kUsage if the board does not support the fault.
void check_fault(const ScheduledFault& fault, const BoardConfig& board);

}  // namespace cde
