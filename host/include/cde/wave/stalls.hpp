// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "cde/wave/handshakes.hpp"

namespace cde::wave {

/// Cycles one behind the other in which a handshake is stalled. Cycles are counted by its clock,
/// from 0 in the window.
struct Stall {
  std::size_t handshake;
  std::uint64_t first, last;  ///< cycles
  std::uint64_t time;         ///< of the first
};

/// Handshakes that are stalled in the same cycles, as often as that happens to just these.
struct Chain {
  std::vector<std::size_t> members;  ///< upstream to downstream
  std::size_t origin = 0;            ///< of the handshakes: the one that was stalled first
  std::uint64_t times = 0;
  std::uint64_t cycles = 0;  ///< in which any of them is stalled
  std::uint64_t longest = 0;
  std::uint64_t first_time = 0;  ///< of the first time that it happens
};

/// Chains of two and more, those first that take the most cycles. Stalls belong together if they
/// share a cycle and one handshake is behind the other; of handshakes that no traced module joins
/// with any other it is enough to share a cycle. Back-pressure runs upstream: the origin is the one
/// that is stalled first, and of several the one farthest downstream.
[[nodiscard]] std::vector<Chain> stall_chains(const std::vector<Handshake>& handshakes,
                                              std::vector<Stall> stalls);

}  // namespace cde::wave
