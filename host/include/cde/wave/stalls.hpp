// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "cde/wave/handshakes.hpp"

namespace cde::wave {

/// Consecutive cycles in which a handshake is stalled. Cycles are counted on its clock, from 0 in
/// the window.
struct Stall {
  std::size_t handshake;
  std::uint64_t first, last;  ///< cycles
  std::uint64_t time;         ///< time of the first cycle
};

/// Handshakes that are stalled in the same cycles, over all occurrences of exactly this set.
struct Chain {
  std::vector<std::size_t> members;  ///< upstream to downstream
  std::size_t origin = 0;            ///< the handshake that was stalled first
  std::uint64_t times = 0;
  std::uint64_t cycles = 0;  ///< cycles in which any of them is stalled
  std::uint64_t longest = 0;
  std::uint64_t first_time = 0;  ///< time of the first occurrence
};

/// Chains of at least two handshakes, those with the most cycles first. Stalls belong together if
/// they share a cycle and one handshake is downstream of the other. For handshakes that no traced
/// module joins with another, sharing a cycle suffices. Back-pressure runs upstream, so the origin
/// is the handshake that stalls first. If several do, it is the one farthest downstream.
[[nodiscard]] std::vector<Chain> stall_chains(const std::vector<Handshake>& handshakes,
                                              std::vector<Stall> stalls);

}  // namespace cde::wave
