// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>

#include "cde/accuracy/tally.hpp"

namespace cde::accuracy {

/// Accuracy that docs/reference/pairs*.md promise for a pipe, to compare with measurements.
struct Promise {
  std::string text;
  std::optional<double> t;  ///< largest error of T, in u S; none: not promised in these units
  bool hits = false;        ///< F = 1 is correct beyond 16 u S
  bool misses = false;      ///< F = 0 is correct beyond 16 u S
};
/// The constants are those beside the references (kRaySphereBand, ...).
[[nodiscard]] Promise promise_of(const AccuracyPipe& pipe);

/// Outcome of a measurement: "yes", "3 wrong", "T by 16.2 u S"; "-" if measurements cannot tell.
[[nodiscard]] std::string promise_outcome(const Promise& promise, const Tally& found);

}  // namespace cde::accuracy
