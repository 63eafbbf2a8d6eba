// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>

#include "cde/wave/four_state.hpp"
#include "cde/wave/trace.hpp"

namespace cde::wave {

/// An edge of a one-bit signal, as in --on: 'posedge clk', 'negedge clk', 'edge clk'.
struct Event {
  std::uint32_t handle = 0;
  std::string name;
  bool rising = false, falling = false;

  /// Error kUsage if the text is invalid.
  Event(Trace& trace, const std::string& text);
  /// Whether the edge lies between two values of the signal.
  [[nodiscard]] bool happens(char before, char now) const {
    before = four_state(before);
    now = four_state(now);
    return (rising && before == '0' && now == '1') || (falling && before == '1' && now == '0');
  }
};

}  // namespace cde::wave
