// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "cde/card/pair_unit.hpp"

namespace cde::cli {

/// FCL's answers to a set of pairs, and its rates, in binary64 on one thread. A rate is in pairs
/// per second of processor time. It is absent if FCL has no such query.
struct FclRates {
  std::optional<double> collide;   ///< collide() with one contact: point, normal, depth.
  std::optional<double> distance;  ///< distance() with nearest points.
  bool distance_signed = false;    ///< whether distance() also returns a depth.
  /// Pairs on which FCL gives up, or stops the program with an assertion. They do not count in the
  /// rate.
  std::size_t collide_stops = 0, distance_stops = 0;
  std::vector<signed char>
      hits;  ///< collide()'s answer to each pair: 1, 0, or -1 without an answer.
};

/// Whether this program was built with FCL. Without it all rates are absent.
[[nodiscard]] bool has_fcl();

/// Measures each query for about `seconds`. Operand words are in slot order. Objects are made
/// before the measurement. FCL runs in child processes, because its assertions end the process.
[[nodiscard]] FclRates measure_fcl(Pair pair, std::span<const float> a, std::span<const float> b,
                                   double seconds);

}  // namespace cde::cli
