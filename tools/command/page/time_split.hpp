// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

#include "cde/scene/player.hpp"

/// Where the modelled time of a frame goes. Everything that shows such a split takes it from here.
namespace cde::cli {

/// Seconds of device time at the core clock that the scene assumes.
struct TimeSplit {
  double dma = 0;      ///< secondaries and primaries on their way to the card
  double compute = 0;  ///< the pipe is fed or drains
  double memory = 0;   ///< the pipe waits for DDR, and kept records go to SRAM
  double bus = 0;      ///< records on their way to the host, register accesses

  [[nodiscard]] double total() const { return dma + compute + memory + bus; }
  TimeSplit& operator+=(const TimeSplit& other);
};

inline constexpr std::array<const char*, 4> kTimeParts = {"DMA to the card", "compute",
                                                          "memory (DDR waits, SRAM write-back)",
                                                          "bus (records to the host, registers)"};
/// In the order of kTimeParts.
[[nodiscard]] std::array<double, 4> parts(const TimeSplit& split);

/// Of one query in one frame; the sum is the "total" of run.json.
[[nodiscard]] TimeSplit time_split(const QueryFrame& frame, double clock_hz);

}  // namespace cde::cli
