// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "cde/card/pair_unit.hpp"

namespace cde::cli {

/// What FCL makes of a set of pairs, in binary64 and on one thread. A rate is in pairs a second of
/// processor time, and absent where FCL has no such query.
struct FclRates {
  std::optional<double> collide;   ///< with one contact: point, normal, depth
  std::optional<double> distance;  ///< with nearest points
  bool distance_signed = false;    ///< it gives a depth too, not only "they overlap"
  /// Pairs on which FCL gives up, or stops the program with an assertion: not part of the rate.
  std::size_t collide_stops = 0, distance_stops = 0;
  std::vector<signed char> hits;  ///< collide's answer to each pair: 1, 0, or -1 if it has none
};

/// Whether this program was built with FCL. Without it all rates are absent.
[[nodiscard]] bool has_fcl();

/// Measures for about `seconds` a query. Operand words are in slot order. Objects are made before
/// the clock starts. FCL runs in child processes, since its assertions end the process.
[[nodiscard]] FclRates measure_fcl(Pair pair, std::span<const float> a, std::span<const float> b,
                                   double seconds);

}  // namespace cde::cli
