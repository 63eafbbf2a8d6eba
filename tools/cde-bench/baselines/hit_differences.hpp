// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "baselines/baseline.hpp"
#include "cde/query/record.hpp"

namespace cde::baseline {

/// How hits of a baseline differ from records of mode nearest, by kind. A ray counts once, under
/// the first kind that fits.
struct HitDifferences {
  std::size_t compared = 0;
  std::size_t extra_hits = 0;       ///< the record is a miss
  std::size_t missed_hits = 0;      ///< the record is a hit
  std::size_t other_t = 0;          ///< T is off by more than 1e-4 of itself
  std::size_t other_triangles = 0;  ///< another triangle at the same T within that
  std::size_t rounded_t = 0;        ///< the same triangle, T within that, not bit for bit

  /// Equal in F, in the triangle and in every bit of T.
  [[nodiscard]] std::size_t equal() const {
    return compared - extra_hits - missed_hits - other_t - other_triangles - rounded_t;
  }
  /// Differences that other rounding at edges explains only if they are rare.
  [[nodiscard]] std::size_t wrong() const { return extra_hits + missed_hits + other_t; }
  /// "all equal", or the number of each kind.
  [[nodiscard]] std::string text() const;

  HitDifferences& operator+=(const HitDifferences& other);
};

/// Compares hits with records, as many of both.
[[nodiscard]] HitDifferences compare_hits(std::span<const Record> records,
                                          std::span<const ClosestHit> hits);

/// Error kMismatch if more than 1 ray in 50 is wrong, as for the other baselines.
void require_few(const HitDifferences& differences, std::string_view name);

}  // namespace cde::baseline
