// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "cde/geometry/length_range.hpp"
#include "cde/geometry/ops.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/geometry/primitives.hpp"

/// The input contract, `bad(primitive)`: a primitive that breaks it is flagged, and its pairs
/// answer bad_outcome(). The check stands beside the pipe, not in it. Tests of one word (finite,
/// NaN, in range) look at its bits and are wires in hardware; the operator counts are of the rest.
namespace cde::reference {

/// How far |a|^2 of a unit vector, and every entry of R^T R - 1 of a rotation, may be off: 2^-20,
/// which lets pass whatever was normalised in fp32, or 16 u in formats too coarse for that.
template <typename S>
inline constexpr double kUnitTolerance = std::max(0x1p-20, 16 * kUnitRoundoff<S>);

/// Exponent bits of a format.
template <typename S>
inline constexpr int kExponentBits =
    std::bit_width(static_cast<unsigned>(std::numeric_limits<S>::max_exponent));

/// The lengths that the contract allows.
template <typename S>
inline constexpr LengthRange kLengths = LengthRange::of(kExponentBits<S>,
                                                        std::numeric_limits<S>::digits - 1);

/// 2^e as a double, -1022 <= e <= 1023.
[[nodiscard]] constexpr double power_of_two(int e) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(e + 1023) << 52);
}

template <typename S>
[[nodiscard]] bool finite(S x) {
  using std::isfinite;
  return isfinite(x);
}
template <typename S>
[[nodiscard]] bool finite(const Vector<S>& v) {
  return finite(v.x()) && finite(v.y()) && finite(v.z());
}

/// A coordinate: |x| <= 2^high.
template <typename S>
[[nodiscard]] bool is_coordinate(S x) {
  return static_cast<bool>(magnitude(x) <= S(power_of_two(kLengths<S>.high)));
}
template <typename S>
[[nodiscard]] bool is_coordinate(const Vector<S>& v) {
  return is_coordinate(v.x()) && is_coordinate(v.y()) && is_coordinate(v.z());
}

/// A size: 2^low <= x <= 2^high.
template <typename S>
[[nodiscard]] bool is_size(S x) {
  return static_cast<bool>(S(power_of_two(kLengths<S>.low)) <= x) && is_coordinate(x);
}
template <typename S>
[[nodiscard]] bool is_size(const Vector<S>& v) {
  return is_size(v.x()) && is_size(v.y()) && is_size(v.z());
}

/// |a.b - expected| <= kUnitTolerance, false for NaN. 3 mul, 3 add, 1 cmp.
template <typename S>
[[nodiscard]] bool dot_is(const Vector<S>& a, const Vector<S>& b, int expected) {
  return static_cast<bool>(magnitude(dot<S>(a, b) - S(expected)) <= S(kUnitTolerance<S>));
}

/// No operators.
template <typename S>
[[nodiscard]] bool bad(const BasicRay<S>& ray) {
  const bool moves = is_size(magnitude(ray.d.x())) || is_size(magnitude(ray.d.y())) ||
                     is_size(magnitude(ray.d.z()));
  using std::isnan;
  return !is_coordinate<S>(ray.o) || !is_coordinate<S>(ray.d) || !moves || isnan(ray.tmin) ||
         isnan(ray.tmax);
}

/// No operators.
template <typename S>
[[nodiscard]] bool bad(const BasicTriangle<S>& triangle) {
  return !is_coordinate<S>(triangle.v0) || !is_coordinate<S>(triangle.v1) ||
         !is_coordinate<S>(triangle.v2);
}

/// No operators.
template <typename S>
[[nodiscard]] bool bad(const BasicSphere<S>& sphere) {
  return !is_coordinate<S>(sphere.c) || !is_size(sphere.r);
}

/// 3 cmp.
template <typename S>
[[nodiscard]] bool bad(const BasicAabb<S>& box) {
  const bool ordered = static_cast<bool>(box.min.x() < box.max.x()) &&
                       static_cast<bool>(box.min.y() < box.max.y()) &&
                       static_cast<bool>(box.min.z() < box.max.z());
  return !is_coordinate<S>(box.min) || !is_coordinate<S>(box.max) || !ordered;
}

/// 3 mul, 3 add, 1 cmp.
template <typename S>
[[nodiscard]] bool bad(const BasicPlane<S>& plane) {
  return !finite<S>(plane.n) || !is_coordinate(plane.d) || !dot_is<S>(plane.n, plane.n, 1);
}

/// 3 mul, 3 add, 1 cmp.
template <typename S>
[[nodiscard]] bool bad(const BasicCylinder<S>& cylinder) {
  return !is_coordinate<S>(cylinder.c) || !finite<S>(cylinder.axis) ||
         !is_size(cylinder.half_height) || !is_size(cylinder.radius) ||
         !dot_is<S>(cylinder.axis, cylinder.axis, 1);
}

/// 18 mul, 18 add, 6 cmp: the upper triangle of R^T R.
template <typename S>
[[nodiscard]] bool bad(const BasicObb<S>& box) {
  if (!is_coordinate<S>(box.c) || !is_size<S>(box.half)) return true;
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j)
      if (!dot_is<S>(box.rotation.col(i), box.rotation.col(j), i == j)) return true;
  }
  return false;  // an entry that is not finite makes its column's product infinite or NaN
}

}  // namespace cde::reference
