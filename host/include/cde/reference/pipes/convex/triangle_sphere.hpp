// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/reference/pipes/convex/candidate_axes.hpp"
#include "cde/reference/pipes/convex/closest_point.hpp"
#include "cde/reference/pipes/scale.hpp"

namespace cde::reference {
namespace convex {

/// Triangle against sphere, relative to the sphere's centre: the closest point over all seven
/// regions, polished. A triangle without area reduces to its segments or points. The triangle is
/// flat and two-sided: the depth is r - distance. If the centre lies in the triangle's plane, n is
/// the plane's normal. 146 add 171 mul 7 div 2 sqrt.
template <typename S>
[[nodiscard]] Outcome<S> triangle_sphere(const BasicTriangle<S>& a, const BasicSphere<S>& b) {
  // Vectors from the triangle to the centre, so that v = centre - point.
  const TriangleParts<S> t =
      triangle_parts<S>(sub<S>(b.c, a.v0), sub<S>(b.c, a.v1), sub<S>(b.c, a.v2));
  const PointTriangle<S> closest =
      point_triangle<S>({Vector<S>(-t.p[0]), Vector<S>(-t.p[1]), Vector<S>(-t.p[2])}, t);
  const Vector<S> start = -closest.v;

  const S tie = tie_width(reach<S>(t) + b.r);
  const auto support = [&](const Vector<S>& v) -> Difference<S> {
    const auto low = least_along<S>(t.p, v);
    const Vector<S> far = select3<S>(low.first, low.second, t.p[0], t.p[1], t.p[2]);
    return {far, -far};
  };
  const Difference<S> once = polish<S>({start, -start}, support(start), tie).x;
  const Difference<S> x = polish<S>(once, support(once.v), tie).x;

  // The plane's own normal, towards the centre; h is measured from the plane to the origin.
  const Vector<S> n(-move_sign(closest.h, t.m.x()), -move_sign(closest.h, t.m.y()),
                    -move_sign(closest.h, t.m.z()));
  const S plane_distance = magnitude(closest.h);
  const Vector<S> to_plane = scale<S>(n, plane_distance);
  const SignedDistance<S> centre =
      decide<S>({plane_distance, n, {to_plane, -to_plane}}, x, Mask<S>(true), tie,
                [&](const Direction<S>& direction) {
                  return PointDistance<S>{least_along<S>(t.p, direction.n).value, direction.d};
                });
  const S s = centre.s - b.r;
  // CP = pA + (s / 2) n, relative to the sphere's centre.
  const Vector<S> cp = add<S>(b.c, add<S>(centre.x.p, scale<S>(centre.n, s * kHalf<S>)));
  return outcome<S>(s, cp, centre.n);
}

}  // namespace convex

/// Triangle A against sphere B; see convex::triangle_sphere.
template <typename S>
[[nodiscard]] Outcome<S> triangle_sphere(const BasicTriangle<S>& a, const BasicSphere<S>& b) {
  return at_size_one<S>(a, b,
                        [](const auto& x, const auto& y) { return convex::triangle_sphere(x, y); });
}

}  // namespace cde::reference
