// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

#include "cde/scene/scene_runner.hpp"

/// How the modelled time of a frame divides into parts. All outputs use this split.
namespace cde::cli {

/// Seconds of device time at the core clock that the scene assumes.
struct TimeSplit {
  double dma = 0;      ///< transfers of primaries and secondaries
  double compute = 0;  ///< the pipe takes rows or drains
  double memory = 0;   ///< waits for DDR, write-back to SRAM
  double bus = 0;      ///< transfers of records, register accesses

  [[nodiscard]] double total() const { return dma + compute + memory + bus; }
  TimeSplit& operator+=(const TimeSplit& other);
};

inline constexpr std::array<const char*, 4> kTimeParts = {"DMA to the card", "compute",
                                                          "memory (DDR waits, SRAM write-back)",
                                                          "bus (records to the host, registers)"};
/// In the order of kTimeParts.
[[nodiscard]] std::array<double, 4> parts(const TimeSplit& split);

/// The split of one query in one frame. The sum of the parts is the "total" of run.json.
[[nodiscard]] TimeSplit time_split(const QueryFrame& frame, double clock_hz);

}  // namespace cde::cli
