#pragma once
#include <algorithm>
#include <cmath>

#include "cde/primitives.hpp"
#include "cde/reference/ops.hpp"

/// The input contract, `bad(primitive)`: a primitive that breaks it is flagged, and its pairs
/// answer bad_outcome(). The check stands beside the pipe, not in it. Tests of one word (finite,
/// NaN, > 0) look at its bits and are wires in hardware; the operator counts are of the rest.
namespace cde::reference {

/// How far |a|^2 of a unit vector, and every entry of R^T R - 1 of a rotation, may be off: 2^-20,
/// which lets pass whatever was normalised in fp32, or 16 u in formats too coarse for that.
template <typename S>
inline constexpr double kUnitTolerance = std::max(0x1p-20, 16 * kUnitRoundoff<S>);

template <typename S>
[[nodiscard]] bool finite(S x) {
  using std::isfinite;
  return isfinite(x);
}
template <typename S>
[[nodiscard]] bool finite(const Vector<S>& v) {
  return finite(v.x()) && finite(v.y()) && finite(v.z());
}

template <typename S>
[[nodiscard]] bool positive(S x) {
  return static_cast<bool>(S(0) < x);
}
template <typename S>
[[nodiscard]] bool positive(const Vector<S>& v) {
  return positive(v.x()) && positive(v.y()) && positive(v.z());
}

/// |a.b - expected| <= kUnitTolerance, false for NaN. 3 mul, 3 add, 1 cmp.
template <typename S>
[[nodiscard]] bool dot_is(const Vector<S>& a, const Vector<S>& b, int expected) {
  return static_cast<bool>(magnitude(dot<S>(a, b) - S(expected)) <= S(kUnitTolerance<S>));
}

/// No operators.
template <typename S>
[[nodiscard]] bool bad(const BasicRay<S>& ray) {
  const bool moves = positive(magnitude(ray.d.x())) || positive(magnitude(ray.d.y())) ||
                     positive(magnitude(ray.d.z()));
  using std::isnan;
  return !finite<S>(ray.o) || !finite<S>(ray.d) || !moves || isnan(ray.tmin) || isnan(ray.tmax);
}

/// No operators.
template <typename S>
[[nodiscard]] bool bad(const BasicTriangle<S>& triangle) {
  return !finite<S>(triangle.v0) || !finite<S>(triangle.v1) || !finite<S>(triangle.v2);
}

/// No operators.
template <typename S>
[[nodiscard]] bool bad(const BasicSphere<S>& sphere) {
  return !finite<S>(sphere.c) || !finite(sphere.r) || !positive(sphere.r);
}

/// 3 cmp.
template <typename S>
[[nodiscard]] bool bad(const BasicAabb<S>& box) {
  const bool ordered = static_cast<bool>(box.min.x() < box.max.x()) &&
                       static_cast<bool>(box.min.y() < box.max.y()) &&
                       static_cast<bool>(box.min.z() < box.max.z());
  return !finite<S>(box.min) || !finite<S>(box.max) || !ordered;
}

/// 3 mul, 3 add, 1 cmp.
template <typename S>
[[nodiscard]] bool bad(const BasicPlane<S>& plane) {
  return !finite<S>(plane.n) || !finite(plane.d) || !dot_is<S>(plane.n, plane.n, 1);
}

/// 3 mul, 3 add, 1 cmp.
template <typename S>
[[nodiscard]] bool bad(const BasicCylinder<S>& cylinder) {
  return !finite<S>(cylinder.c) || !finite<S>(cylinder.axis) || !finite(cylinder.half_height) ||
         !finite(cylinder.radius) || !positive(cylinder.half_height) ||
         !positive(cylinder.radius) || !dot_is<S>(cylinder.axis, cylinder.axis, 1);
}

/// 18 mul, 18 add, 6 cmp: the upper triangle of R^T R.
template <typename S>
[[nodiscard]] bool bad(const BasicObb<S>& box) {
  if (!finite<S>(box.c) || !finite<S>(box.half) || !positive<S>(box.half)) return true;
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j)
      if (!dot_is<S>(box.rotation.col(i), box.rotation.col(j), i == j)) return true;
  }
  return false;  // an entry that is not finite makes its column's product infinite or NaN
}

}  // namespace cde::reference
