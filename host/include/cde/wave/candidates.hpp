// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "cde/wave/trace.hpp"

namespace cde::wave {

/// A pair of one primary as it leaves the pipe of a card, and what the update engine does with it.
struct Tested {
  std::uint64_t pass = 0;   ///< from 0 in the file
  std::uint64_t clock = 0;  ///< of the engine, counted from the pass's go
  std::uint64_t time = 0;   ///< of that edge, in units of the file
  std::uint64_t index = 0;  ///< of the secondary
  bool f = false, bad = false;
  bool candidate = false;  ///< the update engine may keep it
  bool kept = false;       ///< and does
  std::uint64_t t = 0;     ///< word as it is compared: of solids the signed gap
  std::uint64_t held = 0;  ///< what the T buffer has for the primary before
};

using TakeTested = std::function<void(const Tested&)>;

/// Pairs of a primary, by its place in the packet, in the order in which they arrive at the update
/// engine; of passes whose records are of pairs (modes all and hits) none. Error kUsage, naming
/// signals, if the waves lack what this is read from.
void each_tested(Trace& trace, std::uint64_t primary, const TakeTested& take);

/// What waves need to have for it, as TraceOptions::scopes.
[[nodiscard]] std::vector<std::string> tested_scopes();

}  // namespace cde::wave
