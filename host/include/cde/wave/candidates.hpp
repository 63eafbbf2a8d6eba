// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "cde/wave/trace.hpp"

namespace cde::wave {

/// A pair of one primary as it leaves a card's pipe, and the decision of the update engine.
struct Tested {
  std::uint64_t pass = 0;   ///< number of the pass, from 0 in the file
  std::uint64_t cycle = 0;  ///< engine cycle, counted from the pass's go
  std::uint64_t time = 0;   ///< time of that edge, in units of the file
  std::uint64_t index = 0;  ///< of the secondary
  bool f = false, bad = false;
  bool candidate = false;  ///< the update engine may keep it
  bool kept = false;       ///< the update engine keeps it
  std::uint64_t t = 0;     ///< word that is compared; for solids the signed distance
  std::uint64_t held = 0;  ///< T-buffer word of the primary before this pair
};

using TakeTested = std::function<void(const Tested&)>;

/// Reports the pairs of a primary, given by its slot in the packet, in the order in which they
/// reach the update engine. Passes with a record per pair (modes all and hits) have none. Error
/// kUsage, naming signals, if the waves lack the signals needed.
void each_tested(Trace& trace, std::uint64_t primary, const TakeTested& take);

/// Scopes that waves need for this, as in TraceOptions::scopes.
[[nodiscard]] std::vector<std::string> tested_scopes();

}  // namespace cde::wave
