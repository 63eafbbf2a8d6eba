// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/reference/pipes/convex/candidate_axes.hpp"
#include "cde/reference/pipes/convex/frame.hpp"
#include "cde/reference/pipes/scale.hpp"

namespace cde::reference {
namespace convex {

/// A box and a triangle in the box's frame: body P is the box, body Q the triangle.
template <typename S>
struct BoxTriangle {
  Vector<S> a;                  ///< half extents
  TriangleParts<S> t;           ///< the triangle
  std::array<Vector<S>, 3> f1;  ///< its turned edges, for their signs
  Vector<S> m1;                 ///< f1[0] x f1[1], also for its signs
  S tie;                        ///< tie width of signed distances
};

template <typename S>
[[nodiscard]] BoxTriangle<S> box_triangle(const Vector<S>& half, const Vector<S>& p0,
                                          const Vector<S>& p1, const Vector<S>& p2) {
  BoxTriangle<S> pair;
  pair.a = half;
  pair.t = triangle_parts<S>(p0, p1, p2);
  for (int j = 0; j < 3; ++j) pair.f1[j] = turned<S>(pair.t.f[j]);
  pair.m1 = cross<S>(pair.f1[0], pair.f1[1]);
  pair.tie = tie_width(reach<S>(pair.t) + ((half.x() + half.y()) + half.z()));
  return pair;
}

/// Face i of the box with the nearest vertex of the triangle, on the side with the larger distance;
/// ties go to the upper side. 8 add 3 mul.
template <typename S>
[[nodiscard]] CandidateAxis<S> box_face(const BoxTriangle<S>& pair, int i) {
  const auto& p = pair.t.p;
  const S low = min_num(p[0][i], min_num(p[1][i], p[2][i]));
  const S high = max_num(p[0][i], max_num(p[1][i], p[2][i]));
  const S above = low - pair.a[i], below = -high - pair.a[i];
  const S side = side_of(low + high, pair.tie, S{1});
  // The lowest vertex along side * e_i, selected by the turned edges.
  const auto first =
      S{0} <= move_sign(side, pair.f1[0][i]) && move_sign(side, pair.f1[2][i]) <= S{0};
  const auto second = S{0} <= move_sign(side, pair.f1[1][i]);
  return face_axis<S>(i, pair.a, side, select3<S>(first, second, p[0], p[1], p[2]),
                      max_num(above, below));
}

/// The triangle's face with the nearest corner of the box, on the side with the larger distance.
template <typename S>
[[nodiscard]] CandidateAxis<S> triangle_face(const BoxTriangle<S>& pair) {
  const TriangleParts<S>& t = pair.t;
  const S on_p[3] = {dot<S>(t.m, t.p[0]), dot<S>(t.m, t.p[1]), dot<S>(t.m, t.p[2])};
  const S low = min_num(on_p[0], min_num(on_p[1], on_p[2]));
  const S high = max_num(on_p[0], max_num(on_p[1], on_p[2]));
  const S radius = box_radius<S>(t.m, pair.a);
  const S above = low - radius, below = -high - radius;
  const S side = side_of(low + high, pair.tie, orientation<S>(t.m));
  CandidateAxis<S> axis;
  axis.separation = max_num(above, below);
  axis.n = Vector<S>(move_sign(side, t.m.x()), move_sign(side, t.m.y()), move_sign(side, t.m.z()));
  const Vector<S> signs(move_sign(side, pair.m1.x()), move_sign(side, pair.m1.y()),
                        move_sign(side, pair.m1.z()));
  axis.x.p = corner<S>(signs, pair.a);
  const PointTriangle<S> closest = point_triangle<S>(
      {sub<S>(axis.x.p, t.p[0]), sub<S>(axis.x.p, t.p[1]), sub<S>(axis.x.p, t.p[2])}, t);
  axis.x.v = -closest.v;
  axis.d2 = closest.d2;
  axis.edge = Vector<S>::Zero();
  axis.inverse_ff = S{0};
  return axis;
}

/// Edge i of the box and edge j of the triangle. The normal is turned so that the triangle lies
/// behind its edge j: that is where the difference of the bodies has this facet.
template <typename S>
[[nodiscard]] CandidateAxis<S> box_edge(const BoxTriangle<S>& pair, int i, int j) {
  const int k = (i + 1) % 3, l = (i + 2) % 3;
  const TriangleParts<S>& t = pair.t;
  const EdgeNormal<S> n = edge_normal<S>(i, t.f[j]);
  // (e_i x f_j).(third vertex - edge) has the sign of component i of f_j x f_j+1, which is m's.
  const S side = pair.m1[i];
  const S on_box = magnitude(n.k) * pair.a[k] + magnitude(n.l) * pair.a[l];
  const S on_t[3] = {move_sign(side, project<S>(i, n, t.p[0])),
                     move_sign(side, project<S>(i, n, t.p[1])),
                     move_sign(side, project<S>(i, n, t.p[2]))};
  const S separation = min_num(on_t[0], min_num(on_t[1], on_t[2])) - on_box;
  Vector<S> signs;
  signs[i] = S{0};
  signs[k] = move_sign(side, -pair.f1[j][l]);
  signs[l] = move_sign(side, pair.f1[j][k]);
  return edge_axis<S>(i, pair.a, signs, t.p[j], t.f[j], S{0}, t.inverse_ff[j], n, side, separation);
}

/// All thirteen candidate axes: faces of the box, the triangle's face, edges (0,0), (0,1), ...
/// (2,2).
template <typename S>
[[nodiscard]] std::array<CandidateAxis<S>, 13> box_triangle_axes(const BoxTriangle<S>& pair) {
  std::array<CandidateAxis<S>, 13> axes;
  for (int i = 0; i < 3; ++i) {
    axes[i] = box_face<S>(pair, i);
    for (int j = 0; j < 3; ++j) axes[4 + 3 * i + j] = box_edge<S>(pair, i, j);
  }
  axes[3] = triangle_face<S>(pair);
  return axes;
}

/// The signed distance from box to triangle, in the box's frame, by the rules of convex::obb_obb.
template <typename S>
[[nodiscard]] SignedDistance<S> box_triangle_distance(const BoxTriangle<S>& pair) {
  const auto& p = pair.t.p;
  return answer<S>(
      box_triangle_axes<S>(pair), pair.a, pair.tie, [&](const Vector<S>& v) -> Difference<S> {
        const auto low = least_along<S>(p, v);
        const Vector<S> on_box = corner<S>(v, pair.a);
        return {sub<S>(select3<S>(low.first, low.second, p[0], p[1], p[2]), on_box), on_box};
      });
}

/// Triangle against oriented box, in the box's frame: 13 candidate axes. 492 add 576 mul 16 div 11
/// sqrt.
template <typename S>
[[nodiscard]] Outcome<S> triangle_obb(const BasicTriangle<S>& a, const BasicObb<S>& b) {
  const Matrix3<S>& u = b.rotation;
  const SignedDistance<S> result = box_triangle_distance<S>(
      box_triangle<S>(b.half, to_local<S>(u, sub<S>(a.v0, b.c)), to_local<S>(u, sub<S>(a.v1, b.c)),
                      to_local<S>(u, sub<S>(a.v2, b.c))));
  return outcome<S>(result.s, add<S>(b.c, to_world<S>(u, midpoint(result.x))),
                    -to_world<S>(u, result.n));
}

/// Triangle against axis-aligned box: 13 candidate axes. It subtracts the box's lower corner first
/// and then its centre, so that the centre is never rounded in world coordinates.
/// 477 add 534 mul 16 div 11 sqrt.
template <typename S>
[[nodiscard]] Outcome<S> triangle_aabb(const BasicTriangle<S>& a, const BasicAabb<S>& b) {
  const Vector<S> half = scale<S>(sub<S>(b.max, b.min), kHalf<S>);
  const SignedDistance<S> result = box_triangle_distance<S>(
      box_triangle<S>(half, sub<S>(sub<S>(a.v0, b.min), half), sub<S>(sub<S>(a.v1, b.min), half),
                      sub<S>(sub<S>(a.v2, b.min), half)));
  return outcome<S>(result.s, add<S>(b.min, add<S>(half, midpoint(result.x))), -result.n);
}

}  // namespace convex

/// Triangle A against OBB B; see convex::triangle_obb.
template <typename S>
[[nodiscard]] Outcome<S> triangle_obb(const BasicTriangle<S>& a, const BasicObb<S>& b) {
  return at_size_one<S>(a, b,
                        [](const auto& x, const auto& y) { return convex::triangle_obb(x, y); });
}

/// Triangle A against AABB B; see convex::triangle_aabb.
template <typename S>
[[nodiscard]] Outcome<S> triangle_aabb(const BasicTriangle<S>& a, const BasicAabb<S>& b) {
  return at_size_one<S>(a, b,
                        [](const auto& x, const auto& y) { return convex::triangle_aabb(x, y); });
}

}  // namespace cde::reference
