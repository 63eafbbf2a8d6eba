// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/geometry/check.hpp"
#include "cde/geometry/ops.hpp"
#include "cde/reference/pipes/scale.hpp"

/// @file
/// Common parts of the ray pipes: the interval test, the hit point and the outcome.
namespace cde::reference {

/// tmin <= t <= tmax; false for a NaN. 2 cmp.
template <typename S>
[[nodiscard]] Mask<S> in_interval(const BasicRay<S>& ray, S t) {
  return ray.tmin <= t && t <= ray.tmax;
}

/// o + t d. 3 mul, 3 add.
template <typename S>
[[nodiscard]] Vector<S> point_at(const BasicRay<S>& ray, S t) {
  return add<S>(ray.o, scale<S>(ray.d, t));
}

/// Wires: T and CP of a hit, otherwise the constants of a miss. A hit must have a finite T and CP;
/// a hit too far away for the format is a miss. T of a hit is never -0.
template <typename S>
[[nodiscard]] Outcome<S> ray_outcome(const Mask<S>& meets, S t, const Vector<S>& cp) {
  Outcome<S> r;
  const S zero(0);
  const Mask<S> hit = meets && Mask<S>(finite(t) && finite<S>(cp));
  r.f = static_cast<bool>(hit);
  r.t = select(hit, no_minus_zero(t), r.t);
  for (int k = 0; k < 3; ++k) r.cp[k] = select(hit, canonical(cp[k]), zero);
  return r;
}

}  // namespace cde::reference
