// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/geometry/pair.hpp"
#include "cde/reference/pipes/convex/closest_point.hpp"
#include "cde/reference/pipes/scale.hpp"

namespace cde::reference {
namespace convex {

/// Sphere against plane: H = n.c - d. Then s = |H| - r for the surface, H - r for the half-space (a
/// parameter of the pipe). n points from the sphere to the plane. The midpoint of the witness
/// points is c + (r + s / 2) n. 8 add 7 mul, no divider.
template <typename S>
[[nodiscard]] Outcome<S> sphere_plane(const BasicSphere<S>& a, const BasicPlane<S>& b,
                                      PlaneSide mode) {
  const S height = dot<S>(b.n, a.c) - b.d;
  // The direction away from the plane, on the sphere's side. The half-space is always below.
  const S up = mode == PlaneSide::kHalfSpace ? S{1} : height;
  const S s = move_sign(up, height) - a.r;
  const Vector<S> n(-move_sign(up, b.n.x()), -move_sign(up, b.n.y()), -move_sign(up, b.n.z()));
  return outcome(s, add<S>(a.c, scale<S>(n, a.r + s * kHalf<S>)), n);
}

}  // namespace convex

/// Sphere A against plane B; see convex::sphere_plane.
template <typename S>
[[nodiscard]] Outcome<S> sphere_plane(const BasicSphere<S>& a, const BasicPlane<S>& b,
                                      PlaneSide mode = PlaneSide::kSurface) {
  return at_size_one<S>(
      a, b, [mode](const auto& x, const auto& y) { return convex::sphere_plane(x, y, mode); });
}

}  // namespace cde::reference
