// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/geometry/pair.hpp"
#include "cde/reference/pipes/convex/closest_point.hpp"
#include "cde/reference/pipes/scale.hpp"

namespace cde::reference {

namespace convex {

/// Wire: x with y's sign; +0 if y is a zero. 1 comparison.
template <typename S>
[[nodiscard]] S signed_or_zero(S y, S x) {
  return select(y == S{0}, S{0}, move_sign(y, x));
}

/// Oriented box against plane: H = n.c - d, R = sum of e_i |n.u_i|. s = |H| - R for the surface, H
/// - R for the half-space (a parameter of the pipe). The box's support point uses sign(0) = 0,
/// which gives the centroid of the touching edge or face. 24 add 28 mul, no divider.
template <typename S>
[[nodiscard]] Outcome<S> obb_plane(const BasicObb<S>& a, const BasicPlane<S>& b, PlaneSide mode) {
  const S height = dot<S>(b.n, a.c) - b.d;
  // The direction away from the plane, on the box's side. The half-space is always below.
  const S up = mode == PlaneSide::kHalfSpace ? S{1} : height;
  Vector<S> h, local;
  for (int i = 0; i < 3; ++i) {
    const Vector<S> axis = a.rotation.col(i);
    const S cosine = dot<S>(b.n, axis);
    h[i] = a.half[i] * magnitude(cosine);
    local[i] = signed_or_zero<S>(cosine, -move_sign(up, a.half[i]));
  }
  const S radius = (h.x() + h.y()) + h.z();
  const S s = move_sign(up, height) - radius;
  const Vector<S> n(-move_sign(up, b.n.x()), -move_sign(up, b.n.y()), -move_sign(up, b.n.z()));
  Vector<S> offset;
  for (int r = 0; r < 3; ++r)
    offset[r] = dot<S>(Vector<S>(a.rotation(r, 0), a.rotation(r, 1), a.rotation(r, 2)), local);
  const Vector<S> cp = add<S>(a.c, add<S>(offset, scale<S>(n, s * kHalf<S>)));
  return outcome(s, cp, n);
}

}  // namespace convex

/// OBB A against plane B; see convex::obb_plane.
template <typename S>
[[nodiscard]] Outcome<S> obb_plane(const BasicObb<S>& a, const BasicPlane<S>& b,
                                   PlaneSide mode = PlaneSide::kSurface) {
  return at_size_one<S>(
      a, b, [mode](const auto& x, const auto& y) { return convex::obb_plane(x, y, mode); });
}

}  // namespace cde::reference
