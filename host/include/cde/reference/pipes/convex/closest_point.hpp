// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <limits>

#include "cde/geometry/ops.hpp"

/// @file
/// Closest-point parts of the convex pairs: point and segment, point and triangle, a triangle's
/// normal, and the step that polishes a normal. Segments are a midpoint and a half vector with
/// parameter -1 .. 1, so that both ends are treated alike.
///
/// A length is usable as a divisor if its square is a normal number. Below that a square root or
/// quotient loses its relative accuracy, and results that depend on it are selected away.
namespace cde::reference::convex {

template <typename S>
inline const S kHalf = static_cast<S>(0.5);

/// Whether a squared length can be a divisor. One comparison.
template <typename S>
[[nodiscard]] Mask<S> usable(S squared) {
  return std::numeric_limits<S>::min() <= squared;
}

/// 1 / x where the mask is set, else 0. A step with the factor 0 stays at its start.
template <typename S>
[[nodiscard]] S reciprocal_or_zero(Mask<S> mask, S x) {
  return select(mask, S{1} / x, S{0});
}

/// The unit vector along x; arbitrary if |x|² is not usable. 3 mul 1 div.
template <typename S>
[[nodiscard]] Vector<S> unit(const Vector<S>& x, S length) {
  return scale<S>(x, S{1} / length);
}

/// One of three vectors, by two masks. No operator.
template <typename S>
[[nodiscard]] Vector<S> select3(Mask<S> first, Mask<S> second, const Vector<S>& a,
                                const Vector<S>& b, const Vector<S>& c) {
  return select<S>(first, a, select<S>(second, b, c));
}

/// The smallest of three values, and whether it is the first or second; ties go to the lowest
/// index.
template <typename S>
struct Least3 {
  Mask<S> first, second;
  S value;
};

/// 3 comparisons.
template <typename S>
[[nodiscard]] Least3<S> least3(S a, S b, S c) {
  const auto first = a <= b && a <= c;
  const auto second = b <= c;
  return {first, second, select(first, a, select(second, b, c))};
}

/// A prepared triangle: values shared by its 3 edges, its face and its support.
template <typename S>
struct TriangleParts {
  std::array<Vector<S>, 3> p;   ///< vertices, relative to a centre
  std::array<Vector<S>, 3> f;   ///< edges p[j+1] - p[j]
  std::array<S, 3> inverse_ff;  ///< 1 / f.f, or 0 for an edge without length
  Vector<S> m;  ///< unit normal, oriented as f0 x f1; without area any unit vector perpendicular to
                ///< the longest edge
  Mask<S> flat;                ///< m is the normal of a face, that is, the triangle has area
  Mask<S> longest0, longest1;  ///< longest edge: 0, else 1, else 2
};

/// Computes the unit normal from the longest edge e and the next edge g: i x (g - (g.e) i),
/// normalised, with i = e / e.e. For a needle, e x g is perpendicular to the edges only within u /
/// sin(angle). Without the part of g along e it is within u, whatever the angle. With i instead of
/// e the product has the length height over longest edge, so flatness does not depend on the
/// triangle's size. A triangle without area uses the coordinate axis nearest to perpendicular
/// instead of g.
/// 12 add 24 mul 1 div 1 sqrt, 5 cmp, 2 min/max.
template <typename S>
void triangle_normal(TriangleParts<S>& t, const std::array<S, 3>& ff) {
  const S largest = max_num(ff[0], max_num(ff[1], ff[2]));
  t.longest0 = largest <= ff[0];
  t.longest1 = largest <= ff[1];
  const Vector<S> e = select3<S>(t.longest0, t.longest1, t.f[0], t.f[1], t.f[2]);
  const Vector<S> g = select3<S>(t.longest0, t.longest1, t.f[1], t.f[2], t.f[0]);
  const S inverse_ee =
      select(t.longest0, t.inverse_ff[0], select(t.longest1, t.inverse_ff[1], t.inverse_ff[2]));
  const Vector<S> i = scale<S>(e, inverse_ee);
  const Vector<S> m_face = cross<S>(i, sub<S>(g, scale<S>(i, dot<S>(g, e))));
  const S mm_face = dot<S>(m_face, m_face);
  t.flat = usable(mm_face);

  const auto axis = least3(magnitude(e.x()), magnitude(e.y()), magnitude(e.z()));
  const S zero{0};
  const Vector<S> m_line =
      select3<S>(axis.first, axis.second, Vector<S>(zero, i.z(), -i.y()),
                 Vector<S>(-i.z(), zero, i.x()), Vector<S>(i.y(), -i.x(), zero));
  const S mm_line = dot<S>(m_line, m_line);
  const auto line = usable(mm_line);
  const Vector<S> m =
      select<S>(t.flat, m_face, select<S>(line, m_line, Vector<S>(zero, zero, S{1})));
  const S mm = select(t.flat, mm_face, select(line, mm_line, S{1}));
  t.m = unit<S>(m, square_root(mm));
}

/// From the three vertices.
template <typename S>
[[nodiscard]] TriangleParts<S> triangle_parts(const Vector<S>& p0, const Vector<S>& p1,
                                              const Vector<S>& p2) {
  TriangleParts<S> t;
  t.p = {p0, p1, p2};
  std::array<S, 3> ff;
  for (int j = 0; j < 3; ++j) {
    t.f[j] = sub<S>(t.p[(j + 1) % 3], t.p[j]);
    ff[j] = dot<S>(t.f[j], t.f[j]);
    t.inverse_ff[j] = reciprocal_or_zero<S>(usable(ff[j]), ff[j]);
  }
  triangle_normal(t, ff);
  return t;
}

/// |x| + |y| + |z|. 2 add.
template <typename S>
[[nodiscard]] S norm1(const Vector<S>& x) {
  return (magnitude(x.x()) + magnitude(x.y())) + magnitude(x.z());
}

/// Reach of a triangle from its reference point: the largest |p|_1. 6 add, 2 min/max.
template <typename S>
[[nodiscard]] S reach(const TriangleParts<S>& t) {
  return max_num(norm1<S>(t.p[0]), max_num(norm1<S>(t.p[1]), norm1<S>(t.p[2])));
}

/// Tie width of signed distances: 4 u S, where S is the size of the scene.
template <typename S>
[[nodiscard]] S tie_width(S size) {
  return static_cast<S>(4 * kUnitRoundoff<S>) * size;
}

/// The least n.p of three points, and its point. 6 add 9 mul.
template <typename S>
[[nodiscard]] Least3<S> least_along(const std::array<Vector<S>, 3>& p, const Vector<S>& n) {
  return least3(dot<S>(p[0], n), dot<S>(p[1], n), dot<S>(p[2], n));
}

/// The vector from the closest point of a triangle to a point.
template <typename S>
struct PointTriangle {
  Vector<S> v;  ///< point - closest point
  S d2;         ///< |v|²
  S h;          ///< m.(point - p0): signed distance from the triangle's plane
};

/// v made perpendicular to the edge f on which it ends: v - (v.f / f.f) f, with 0 for 1 / f.f if it
/// ends on no edge. A v = w - t f has lost the common part of w and t f, and with it the right
/// angle: v.f is u |w| |f|. Repeated from v itself it is u |v| |f|. 5 add 7 mul.
template <typename S>
[[nodiscard]] Vector<S> perpendicular(const Vector<S>& v, const Vector<S>& f, S inverse_ff) {
  return sub<S>(v, scale<S>(f, dot<S>(v, f) * inverse_ff));
}

/// The three segments, and the face if the point lies above its inside. Regions are selected at the
/// end; ties go to the lowest edge. For a needle the signs that mean "inside" are noise if the
/// point is in line with it. The point must therefore also lie between the ends of the longest
/// edge. `w` is the point relative to each vertex, point - p[j]. No divider.
template <typename S>
[[nodiscard]] PointTriangle<S> point_triangle(const std::array<Vector<S>, 3>& w,
                                              const TriangleParts<S>& t) {
  std::array<Vector<S>, 3> r;
  std::array<S, 3> side, rr, inverse;
  std::array<Mask<S>, 3> between{};
  for (int j = 0; j < 3; ++j) {
    const S along = dot<S>(w[j], t.f[j]) * t.inverse_ff[j];
    const S on_edge = clamp(along, S{0}, S{1});
    between[j] = along == on_edge;
    inverse[j] = select(between[j], t.inverse_ff[j], S{0});
    r[j] = sub<S>(w[j], scale<S>(t.f[j], on_edge));
    rr[j] = dot<S>(r[j], r[j]);
    side[j] = dot<S>(cross<S>(t.f[j], w[j]), t.m);
  }
  const auto inside = t.flat && S{0} < side[0] && S{0} < side[1] && S{0} < side[2] &&
                      ((t.longest0 && between[0]) || (!t.longest0 && t.longest1 && between[1]) ||
                       (!t.longest0 && !t.longest1 && between[2]));
  const auto edge = least3(rr[0], rr[1], rr[2]);
  const Vector<S> v =
      perpendicular<S>(select3<S>(edge.first, edge.second, r[0], r[1], r[2]),
                       select3<S>(edge.first, edge.second, t.f[0], t.f[1], t.f[2]),
                       select(edge.first, inverse[0], select(edge.second, inverse[1], inverse[2])));
  const S h = dot<S>(w[0], t.m);
  return {select<S>(inside, scale<S>(t.m, h), v), select(inside, h * h, edge.value), h};
}

/// A point of the difference B - A, and its point of A.
template <typename S>
struct Difference {
  Vector<S> v;  ///< point of B - point of A
  Vector<S> p;  ///< point of A
};

/// |near.v| times the amount by which the signed distance along near.v is less than |near.v|. `far`
/// is the point of B - A least in that direction, so that distance is near.v.far.v / |near.v|. The
/// slack of the nearest point is 0. 5 add 3 mul.
template <typename S>
[[nodiscard]] S slack(const Difference<S>& near, const Difference<S>& far) {
  return -dot<S>(near.v, sub<S>(far.v, near.v));
}

/// Result of a polishing step, and the slack before it.
template <typename S>
struct Polished {
  Difference<S> x;
  S slack_before;
};

/// One polishing step. `near` is about the point of B - A nearest the origin and `far` the point
/// least in its direction. If the signed distance along near.v is less than |near.v| by more than
/// `tie`, the result is the point nearest the origin on the segment between them.
///
/// Reason: a distance d is correct to u S whichever of two neighbouring features it was measured
/// to. But the direction of v may then be wrong by sqrt(u S / d), and an edge of the other feature
/// is not perpendicular to it. The step moves along that edge.
/// 16 add 13 mul 1 div.
template <typename S>
[[nodiscard]] Polished<S> polish(const Difference<S>& near, const Difference<S>& far, S tie) {
  const Vector<S> e = sub<S>(far.v, near.v);
  const S along = -dot<S>(near.v, e);
  const S size =
      max_num(magnitude(near.v.x()), max_num(magnitude(near.v.y()), magnitude(near.v.z())));
  const auto moves = tie * size < along;
  const S step = select(moves, min_num(along / dot<S>(e, e), S{1}), S{0});
  return {
      {add<S>(near.v, scale<S>(e, step)), add<S>(near.p, scale<S>(sub<S>(far.p, near.p), step))},
      along};
}

/// The signed distance of a pair, in a frame common to both.
template <typename S>
struct SignedDistance {
  S s;              ///< distance, or minus the depth
  Vector<S> n;      ///< unit normal, A to B
  Difference<S> x;  ///< witness points: x.p of A and x.p + x.v of B; x.v = s n except for rounding
};

/// Length and direction of a vector.
template <typename S>
struct Direction {
  Vector<S> n;
  S d, inverse;  ///< the length, and 1 / d
};

/// Distance of two bodies, derived from a point of their difference.
template <typename S>
struct PointDistance {
  S along;  ///< signed distance along the point's direction
  S s;      ///< resulting signed distance
};

/// Selects one of two results of a pair: the result of its candidate axes (SAT), or `x`, the
/// polished nearest point of B - A, whose direction is the normal. The second is used if the bodies
/// are apart, and its `point_distance` is not less than the first by more than `tie`. So if the
/// distance is too small to give x.v a direction, the candidate axes decide. 3 add 6 mul 1 div 1
/// sqrt and point_distance.
template <typename S, typename Distance>
[[nodiscard]] SignedDistance<S> decide(const SignedDistance<S>& axes, const Difference<S>& x,
                                       Mask<S> apart, S tie, const Distance& point_distance) {
  const S dd = dot<S>(x.v, x.v);
  const S d = square_root(dd);
  const S inverse = S{1} / d;
  const Direction<S> direction{scale<S>(x.v, inverse), d, inverse};
  const PointDistance<S> known = point_distance(direction);
  const auto point = apart && usable(dd) && axes.s - tie <= known.along;
  return {select(point, known.s, axes.s),
          select<S>(point, direction.n, axes.n),
          {select<S>(point, x.v, axes.x.v), select<S>(point, x.p, axes.x.p)}};
}

/// (pA + pB) / 2 = p + v / 2. 3 add 3 mul.
template <typename S>
[[nodiscard]] Vector<S> midpoint(const Difference<S>& x) {
  return add<S>(x.p, scale<S>(x.v, kHalf<S>));
}

/// F, T, CP and n of a signed distance. 1 comparison.
template <typename S>
[[nodiscard]] Outcome<S> outcome(S s, const Vector<S>& cp, const Vector<S>& n) {
  return {static_cast<bool>(s <= S{0}), false, magnitude(s), cp, n};
}

}  // namespace cde::reference::convex
