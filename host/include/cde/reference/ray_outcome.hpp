#pragma once
#include "cde/reference/check.hpp"
#include "cde/reference/ops.hpp"
#include "cde/reference/scale.hpp"

/// What the ray pipes have in common: the interval test, the hit point and the outcome.
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

/// Wires: T and CP of a hit, the constants of a miss otherwise.
template <typename S>
[[nodiscard]] Outcome<S> ray_outcome(const Mask<S>& hit, S t, const Vector<S>& cp) {
  Outcome<S> r;
  const S zero(0);
  r.f = static_cast<bool>(hit);
  r.t = select(hit, t, r.t);
  for (int k = 0; k < 3; ++k) r.cp[k] = select(hit, canonical(cp[k]), zero);
  return r;
}

}  // namespace cde::reference
