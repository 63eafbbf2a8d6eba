// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <limits>

#include "cde/geometry/check.hpp"
#include "cde/geometry/ops.hpp"

/// @file
/// The box rule of ray and triangle (BOX = 1): a hit must lie in the triangle's box.
///
/// A ray in the plane of a triangle, or nearly so, has a determinant that is only rounding error. A
/// hit that an algorithm then reports may lie anywhere in that plane. The rule keeps a hit only if
/// its point P = o + T d, as the pipe rounds it, lies in the box of the vertices. It allows a
/// margin on every axis k:
///
///     (|P_k - c_k| - h_k) < kBoxRay u |T d|_1        c, h: centre and half size of the box,
///                                                    h widened by kBoxWorld u max(|c| + h)
///
/// |.|_1 is the sum of the components' sizes; everything is rounded as written below. A NaN fails
/// the test, and so does an infinite P. If |T d|_1 overflows although T d does not, the margin is
/// 0; otherwise every point would be within it. Such a P is beyond any box.
///
/// The guarantee: an accepted P, and o + T d in exact arithmetic for the given T, lie outside the
/// triangle's box by less than
///
///     m' = kBoxRay u |T d|_1 (1 + 4 u) + (kBoxWorld + 4) u max(|c| + h)
///
/// on any axis. |T d|_1 is at most 3 (R + m') if no coordinate of the box differs by more than R
/// from the rounding of o. With kBoxRay = 2^6 in fp32, m' < 2^-16 (1 + 2^-13) (R + 2^-3 W), where W
/// is the largest |coordinate| of the triangle. A BVH whose nodes are widened by that much is
/// conservative; the bound does not depend on the other triangles.
///
/// The same unit tells whether a triangle is flat, that is, whether its normal is only rounding
/// error. Let all vertices lie on a line. The exact edges are then a w and b w, and each rounded
/// component is (1 + d1) times that with |d1| <= u. Each product of the normal is a b w_i w_j (1 +
/// d3) with |d3| <= 3 u + O(u^2), and two of them are subtracted. Therefore |N_k| <= 6 u |a b w_i
/// w_j| + O(u^2), while the sum of their sizes is at least 2 |a b w_i w_j| (1 - 3 u).
///
/// So |N_k| <= 3 u sum + O(u^2). A factor of 4 u leaves u for the roundings of the test itself in
/// every format down to 8 bits of precision. Below the normal numbers a product is off by half of
/// the least subnormal e more. The least normal number, e / 2u, is added to the sum, which makes 2
/// e of it.
///
/// A flat triangle has h = -infinity, so no point is within. A triangle 2^20 times longer than high
/// may be flat in this sense in fp32.
namespace cde::reference {

/// Margins in units of u. Checked by tests/numerics/ray_box_test.cpp.
inline constexpr int kBoxRay = 64, kBoxWorld = 8;

/// Centre and half size of a triangle's box: 4 mul, 9 add, 3 sub, 14 min/max, plus flat(). In total
/// 13 mul, 15 add, 12 sub, 3 cmp, 14 min/max per triangle.
template <typename S>
struct TriangleBounds {
  Vector<S> centre, half;
};

/// Whether the triangle's normal is only rounding error. 9 mul, 6 add, 9 sub, 3 cmp.
template <typename S>
[[nodiscard]] Mask<S> flat(const BasicTriangle<S>& triangle) {
  const Vector<S> a = sub<S>(triangle.v1, triangle.v0), b = sub<S>(triangle.v2, triangle.v0);
  const S least = std::numeric_limits<S>::min(), rounding(4 * kUnitRoundoff<S>);
  const auto component = [&](int i, int j) {
    const S p = a[i] * b[j], q = a[j] * b[i];
    return magnitude(p - q) <= ((magnitude(p) + least) + magnitude(q)) * rounding;
  };
  return component(1, 2) && component(2, 0) && component(0, 1);
}

template <typename S>
[[nodiscard]] TriangleBounds<S> triangle_bounds(const BasicTriangle<S>& triangle) {
  const S two_to_minus_1(0.5), world(kBoxWorld * kUnitRoundoff<S>);
  TriangleBounds<S> r;
  Vector<S> reach;
  for (int k = 0; k < 3; ++k) {
    const S x = triangle.v0[k], y = triangle.v1[k], z = triangle.v2[k];
    const S low = min_num(min_num(x, y), z), high = max_num(max_num(x, y), z);
    r.centre[k] = (low + high) * two_to_minus_1;
    r.half[k] = high - r.centre[k];
    reach[k] = magnitude(r.centre[k]) + r.half[k];
  }
  const S margin = max_num(max_num(reach.x(), reach.y()), reach.z()) * world;
  const Mask<S> nothing = flat(triangle);
  const S none = -std::numeric_limits<S>::infinity();
  for (int k = 0; k < 3; ++k) r.half[k] = select(nothing, none, r.half[k] + margin);
  return r;
}

/// Whether p = o + td is in the box. 1 mul, 2 add, 6 sub, 3 cmp per pair.
template <typename S>
[[nodiscard]] Mask<S> in_box(const TriangleBounds<S>& box, const Vector<S>& td,
                             const Vector<S>& p) {
  const S sum = (magnitude(td.x()) + magnitude(td.y())) + magnitude(td.z());
  const S scaled = sum * S(kBoxRay * kUnitRoundoff<S>);
  const S margin = select(Mask<S>(finite(scaled)), scaled, S(0));
  const auto within = [&](int k) { return magnitude(p[k] - box.centre[k]) - box.half[k] < margin; };
  return within(0) && within(1) && within(2);
}

}  // namespace cde::reference
