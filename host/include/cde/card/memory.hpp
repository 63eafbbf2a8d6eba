// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace cde {

/// When the card's DDR answers. Records are the same.
enum class Memory : std::uint32_t {
  kIdeal,  ///< a beat a clock, each OpenOptions::ddr_latency clocks after its request
  kCycle,  ///< as two modules of DDR-400 do: banks, rows, refresh (docs/background/architecture.md)
};

/// Address space that the models of a card reserve for its DDR and SRAM. What is not written takes
/// no memory.
inline constexpr std::uint64_t kModelBytes = 55'555'555ull * 36 + 524'288ull * 28;

/// What Memory::kCycle did since the card was opened; Memory::kIdeal counts nothing.
struct MemoryCounters {
  std::uint64_t bursts = 0;      ///< of 72 bytes, read
  std::uint64_t row_misses = 0;  ///< bursts that had to open their row
  std::uint64_t refreshes = 0;   ///< that a read had to wait for
};

}  // namespace cde
