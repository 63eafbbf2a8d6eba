// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/reference/pipes/convex/closest_point.hpp"
#include "cde/reference/pipes/scale.hpp"

namespace cde::reference {
namespace convex {

/// Sphere against sphere: s = |cB - cA| - (rA + rB). Concentric spheres have n = (0, 0, 1), as have
/// centres so close that the square of their distance is subnormal. The midpoint of the witness
/// points is cA + (rA + s / 2) n, relative to A's centre.
/// 11 add 10 mul 1 div 1 sqrt.
template <typename S>
[[nodiscard]] Outcome<S> sphere_sphere(const BasicSphere<S>& a, const BasicSphere<S>& b) {
  const Vector<S> w = sub<S>(b.c, a.c);
  const S dd = dot<S>(w, w);
  const auto apart = usable(dd);
  const S d = square_root(dd);
  const Vector<S> n = select<S>(apart, unit<S>(w, d), Vector<S>(S{0}, S{0}, S{1}));
  const S s = d - (a.r + b.r);
  const Vector<S> cp = add<S>(a.c, scale<S>(n, a.r + s * kHalf<S>));
  return outcome(s, cp, n);
}

}  // namespace convex

/// Sphere A against sphere B; see convex::sphere_sphere.
template <typename S>
[[nodiscard]] Outcome<S> sphere_sphere(const BasicSphere<S>& a, const BasicSphere<S>& b) {
  return at_size_one<S>(a, b,
                        [](const auto& x, const auto& y) { return convex::sphere_sphere(x, y); });
}

}  // namespace cde::reference
