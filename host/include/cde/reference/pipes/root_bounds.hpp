// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/geometry/ops.hpp"
#include "cde/reference/pipes/distance_bound.hpp"

namespace cde::reference {

/// What a card knows about the root of its BVH.
template <typename S>
struct RootBounds {
  Vector<S> lower, upper;  ///< its box
  S margin;                ///< 16 u W; W is the largest |coordinate| of the box, u is 2^-24
};

/// Computed exactly.
template <typename S>
[[nodiscard]] RootBounds<S> root_bounds(const Vector<S>& lower, const Vector<S>& upper) {
  S most(0);
  for (int k = 0; k < 3; ++k)
    most = max_num(most, max_num(magnitude(lower[k]), magnitude(upper[k])));
  return {lower, upper, most * S(0x1p-20)};
}

/// Largest distance along an axis from a point or a box to the root's box: 6 sub, 5 max.
template <typename S>
[[nodiscard]] S reach(const Hull<S>& of, const RootBounds<S>& root) {
  Vector<S> far;
  for (int k = 0; k < 3; ++k)
    far[k] = max_num(magnitude(root.lower[k] - of.high[k]), magnitude(root.upper[k] - of.low[k]));
  return max_num(max_num(far.x(), far.y()), far.z());
}

}  // namespace cde::reference
