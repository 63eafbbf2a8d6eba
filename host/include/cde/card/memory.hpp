// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace cde {

/// Timing of the card's DDR. Records are the same.
enum class Memory : std::uint32_t {
  kIdeal,   ///< one beat per cycle, each OpenOptions::ddr_latency cycles after its request
  kCycle,   ///< two modules of DDR-400: banks, rows, refresh (docs/background/architecture.md)
  kNarrow,  ///< 16 bits per cycle of the core, each OpenOptions::ddr_latency cycles after its
            ///< request
};

/// "ideal", "DDR-400" or "16 bits".
[[nodiscard]] const char* name_of(Memory memory);

/// Address space that a card's models reserve for DDR and SRAM. Unwritten parts take no memory.
inline constexpr std::uint64_t kModelBytes = 55'555'555ull * 36 + 524'288ull * 28;

/// Counted by Memory::kCycle since the card was opened. The other memories count nothing.
struct MemoryCounters {
  std::uint64_t bursts = 0;      ///< bursts of 72 bytes read
  std::uint64_t row_misses = 0;  ///< bursts that had to open their row
  std::uint64_t refreshes = 0;   ///< refreshes that a read had to wait for
};

}  // namespace cde
