// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/reference/pipes/convex/candidate_axes.hpp"
#include "cde/reference/pipes/scale.hpp"

namespace cde::reference {
namespace convex {

/// Two triangles relative to the first vertex of A, which is therefore 0. Body P is A, body Q is B.
/// They reach up to 2 S from there, so a tie is at most 4 u S.
template <typename S>
struct TrianglePair {
  TriangleParts<S> a, b;
  std::array<S, 3> inverse_e;      ///< 1 / length of A's edges, or 0
  std::array<Vector<S>, 3> along;  ///< A's edges with unit length, or 0
  S tie;                           ///< tie width of signed distances: 2 u times the reach of both
};

template <typename S>
[[nodiscard]] TrianglePair<S> triangle_pair(const BasicTriangle<S>& a, const BasicTriangle<S>& b) {
  const Vector<S> zero = Vector<S>::Zero();
  TrianglePair<S> pair;
  pair.a = triangle_parts<S>(zero, sub<S>(a.v1, a.v0), sub<S>(a.v2, a.v0));
  pair.b = triangle_parts<S>(sub<S>(b.v0, a.v0), sub<S>(b.v1, a.v0), sub<S>(b.v2, a.v0));
  for (int i = 0; i < 3; ++i) {
    pair.inverse_e[i] = square_root(pair.a.inverse_ff[i]);
    pair.along[i] = scale<S>(pair.a.f[i], pair.inverse_e[i]);
  }
  const S reach_a = max_num(norm1<S>(pair.a.p[1]), norm1<S>(pair.a.p[2]));
  pair.tie = static_cast<S>(2 * kUnitRoundoff<S>) * max_num(reach_a, reach<S>(pair.b));
  return pair;
}

/// Projections of a triangle on a normal, with their minimum and maximum.
template <typename S>
struct Span {
  std::array<S, 3> at;
  S low, high;
};

template <typename S>
[[nodiscard]] Span<S> span(const std::array<S, 3>& at) {
  return {at, min_num(at[0], min_num(at[1], at[2])), max_num(at[0], max_num(at[1], at[2]))};
}

/// 6 add 9 mul, 4 min/max.
template <typename S>
[[nodiscard]] Span<S> span_of(const std::array<Vector<S>, 3>& p, const Vector<S>& n) {
  return span<S>({dot<S>(p[0], n), dot<S>(p[1], n), dot<S>(p[2], n)});
}

/// Span of A, whose first vertex is 0. 4 add 6 mul, 4 min/max.
template <typename S>
[[nodiscard]] Span<S> span_of_a(const TrianglePair<S>& pair, const Vector<S>& n) {
  return span<S>({S{0}, dot<S>(pair.a.p[1], n), dot<S>(pair.a.p[2], n)});
}

/// Distances from P to Q on n and on -n, and the sign of the larger one; ties go to n. 5 add, 1
/// cmp.
template <typename S>
struct Separations {
  S above, below, side;

  Separations(const Span<S>& p, const Span<S>& q, S tie)
      : above(q.low - p.high),
        below(p.low - q.high),
        side(side_of((q.low + q.high) - (p.low + p.high), tie, S{1})) {}
  [[nodiscard]] S larger() const { return max_num(above, below); }
};

template <typename S>
[[nodiscard]] Vector<S> flipped(S side, const Vector<S>& n) {
  return {move_sign(side, n.x()), move_sign(side, n.y()), move_sign(side, n.z())};
}

/// The face of triangle t with the nearest vertex of the other triangle r; v points from t to r.
template <typename S>
struct FaceAndVertex {
  S separation;
  Vector<S> n;  ///< from t to r
  Vector<S> vertex, v;
  S d2;
};

template <typename S>
[[nodiscard]] FaceAndVertex<S> face_and_vertex(const TriangleParts<S>& t, const Span<S>& on_t,
                                               const TriangleParts<S>& r, const Span<S>& on_r,
                                               S tie) {
  FaceAndVertex<S> face;
  const Separations<S> separations(on_t, on_r, tie);
  const S side = separations.side;
  face.separation = separations.larger();
  face.n = flipped<S>(side, t.m);
  const auto lowest =
      least3(move_sign(side, on_r.at[0]), move_sign(side, on_r.at[1]), move_sign(side, on_r.at[2]));
  face.vertex = select3<S>(lowest.first, lowest.second, r.p[0], r.p[1], r.p[2]);
  const PointTriangle<S> closest = point_triangle<S>(
      {sub<S>(face.vertex, t.p[0]), sub<S>(face.vertex, t.p[1]), sub<S>(face.vertex, t.p[2])}, t);
  face.v = closest.v;
  face.d2 = closest.d2;
  return face;
}

template <typename S>
[[nodiscard]] CandidateAxis<S> face_of_first(const TrianglePair<S>& pair) {
  const auto face = face_and_vertex<S>(pair.a, span_of_a<S>(pair, pair.a.m), pair.b,
                                       span_of<S>(pair.b.p, pair.a.m), pair.tie);
  return {face.separation,   face.n, {face.v, sub<S>(face.vertex, face.v)}, face.d2,
          Vector<S>::Zero(), S{0}};
}

template <typename S>
[[nodiscard]] CandidateAxis<S> face_of_second(const TrianglePair<S>& pair) {
  const auto face = face_and_vertex<S>(pair.b, span_of<S>(pair.b.p, pair.b.m), pair.a,
                                       span_of_a<S>(pair, pair.b.m), pair.tie);
  return {face.separation, -face.n, {-face.v, face.vertex}, face.d2, Vector<S>::Zero(), S{0}};
}

/// Edge i of A, from p along e, and edge j of B, from q along f.
///
/// The normal is e x f without f's part along e. As in triangle_normal it is perpendicular to both
/// edges to within u, whatever their angle. It uses e with unit length, since an edge may be as
/// short as the format allows. The third vertices select the facet's side: A must be behind its
/// edge and B in front of its own. If both lie in one plane, the side with the larger distance is
/// selected. If the sides differ, the two edges make no facet of the difference. The distance is
/// then still a lower bound, and v a vector between the bodies.
///
/// The nearest points are found as in segment_segment: t across e, then s, then t again. If neither
/// is at an end, v is along the normal, within rounding. Otherwise it ends on an edge, to which it
/// is made perpendicular later. 53 add 64 mul 1 div 1 sqrt, 7 cmp, 14 min/max.
template <typename S>
[[nodiscard]] CandidateAxis<S> edge_pair(const TrianglePair<S>& pair, int i, int j) {
  const Vector<S>&e = pair.a.f[i], &unit_e = pair.along[i], &f = pair.b.f[j];
  const Vector<S>&p = pair.a.p[i], &q = pair.b.p[j];
  const S inverse_e = pair.inverse_e[i], inverse_ff = pair.b.inverse_ff[j];
  // ---- The normal and its separation ----
  const S ef = dot<S>(unit_e, f);
  const Vector<S> m = cross<S>(unit_e, sub<S>(f, scale<S>(unit_e, ef)));
  const S mm = dot<S>(m, m);
  const auto valid = usable(mm);
  const S inverse = reciprocal_or_zero<S>(valid, square_root(mm));
  const Vector<S> n = scale<S>(m, inverse);
  const Span<S> on_a = span_of_a<S>(pair, n), on_b = span_of<S>(pair.b.p, n);
  const Separations<S> separations(on_a, on_b, pair.tie);
  const int k = (i + 2) % 3, l = (j + 2) % 3;
  const S apart = (on_b.at[l] - on_b.at[j]) - (on_a.at[k] - on_a.at[i]);
  const S side = select(magnitude(apart) <= pair.tie, separations.side, apart);

  // ---- The nearest points ----
  const Vector<S> w = i == 0 ? q : sub<S>(q, p);
  const S t1_free = -(dot<S>(w, cross<S>(n, unit_e)) * inverse);
  const S t1 = clamp(t1_free, S{0}, S{1});
  const S s_free = (dot<S>(w, unit_e) + t1 * ef) * inverse_e;
  const S s = clamp(s_free, S{0}, S{1});
  const Vector<S> along = scale<S>(e, s);
  const Vector<S> r = sub<S>(w, along);
  const S t_free = -(dot<S>(r, f) * inverse_ff);
  const S t = clamp(t_free, S{0}, S{1});
  const Vector<S> v_ends = add<S>(r, scale<S>(f, t));
  const auto s_inside = s == s_free && S{0} < inverse_e;
  const auto inside = valid && s_inside && t1 == t1_free;
  const S h = on_b.at[j] - on_a.at[i];

  CandidateAxis<S> axis;
  axis.separation = select(valid, select(is_negative(side), separations.below, separations.above),
                           -std::numeric_limits<S>::infinity());
  axis.n = flipped<S>(side, n);
  axis.x.p = i == 0 ? along : add<S>(p, along);
  axis.x.v = select<S>(inside, scale<S>(n, h), v_ends);
  axis.d2 = dot<S>(axis.x.v, axis.x.v);
  axis.edge = select<S>(s_inside, e, f);
  axis.inverse_ff = select(
      inside, S{0}, select(s_inside, pair.a.inverse_ff[i], select(t == t_free, inverse_ff, S{0})));
  return axis;
}

/// All eleven candidate axes: face of A, face of B, edges (0,0), (0,1), ... (2,2).
template <typename S>
[[nodiscard]] std::array<CandidateAxis<S>, 11> triangle_axes(const TrianglePair<S>& pair) {
  std::array<CandidateAxis<S>, 11> axes;
  axes[0] = face_of_first<S>(pair);
  axes[1] = face_of_second<S>(pair);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) axes[2 + 3 * i + j] = edge_pair<S>(pair, i, j);
  return axes;
}

/// The vertex of B minus the vertex of A that is farthest against v.
template <typename S>
[[nodiscard]] Difference<S> triangle_support(const TrianglePair<S>& pair, const Vector<S>& v) {
  const auto& p = pair.a.p;
  const auto& q = pair.b.p;
  const auto low = least_along<S>(q, v);
  const auto high = least3(S{0}, -dot<S>(p[1], v), -dot<S>(p[2], v));
  const Vector<S> on_a = select3<S>(high.first, high.second, p[0], p[1], p[2]);
  return {sub<S>(select3<S>(low.first, low.second, q[0], q[1], q[2]), on_a), on_a};
}

/// Triangle against triangle, both flat and two-sided, relative to the first vertex of A. The
/// difference of coplanar triangles is flat, and no axis tells whether the origin is in it or
/// beside it. A positive distance along the nearest vector therefore suffices as proof that they
/// are apart.
/// 824 add 983 mul 20 div 15 sqrt.
template <typename S>
[[nodiscard]] Outcome<S> triangle_triangle(const BasicTriangle<S>& a, const BasicTriangle<S>& b) {
  const TrianglePair<S> pair = triangle_pair(a, b);
  const Choice<S> axes = choose<S>(triangle_axes<S>(pair), pair.tie, S{2} * pair.tie);
  const Nearest<S> nearest = polish_twice<S>(
      axes.start, pair.tie, [&](const Vector<S>& v) { return triangle_support<S>(pair, v); });
  const Vector<S>& v = nearest.x.v;
  const S dd = dot<S>(v, v);
  const S d = square_root(dd);
  const S inverse = S{1} / d;
  const S distance_along = d - nearest.slack * inverse;
  const S least = max_num(axes.s - pair.tie, pair.tie);
  const auto point = usable(dd) && least <= distance_along;
  const S s = select(point, (d + max_num(axes.s, distance_along)) * kHalf<S>, axes.s);
  const Vector<S> n = select<S>(point, scale<S>(v, inverse), axes.witness.n);
  const Difference<S> x{select<S>(point, v, axes.witness.x.v),
                        select<S>(point, nearest.x.p, axes.witness.x.p)};
  return outcome<S>(s, add<S>(a.v0, midpoint(x)), n);
}

}  // namespace convex

/// Triangle A against triangle B; see convex::triangle_triangle.
template <typename S>
[[nodiscard]] Outcome<S> triangle_triangle(const BasicTriangle<S>& a, const BasicTriangle<S>& b) {
  return at_size_one<S>(
      a, b, [](const auto& x, const auto& y) { return convex::triangle_triangle(x, y); });
}

}  // namespace cde::reference
