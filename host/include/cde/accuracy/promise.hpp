// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>

#include "cde/accuracy/tally.hpp"

namespace cde::accuracy {

/// What docs/pairs*.md promise of a pipe, beside which a sweep stands.
struct Promise {
  std::string text;
  std::optional<double> t;  ///< most that T may be off, in u S; none: not promised in these units
  bool hits = false;        ///< F = 1 is right beyond 16 u S
  bool misses = false;      ///< F = 0 likewise
};
/// Constants are those beside the references (kRaySphereBand, ...).
[[nodiscard]] Promise promise_of(const AccuracyPipe& pipe);

/// "yes", "3 wrong", "T by 16.2 u S", of what was found; "-" of what a sweep does not see.
[[nodiscard]] std::string kept(const Promise& promise, const Tally& found);

}  // namespace cde::accuracy
