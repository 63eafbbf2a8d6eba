// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

#include "cde/reference/pipes/convex/closest_point.hpp"

/// @file
/// Candidate axes (SAT) of the box pairs. Body P is a box, in its own frame: centre 0, half extents
/// a, axes e_i. Body Q is another box or a triangle. The difference Q - P is a convex polytope.
/// Each of its facets belongs to a face of one body and a vertex of the other, or to an edge of
/// each. Their normals are the candidate axes.
///
/// For one axis a unit computes two results. The first is the distance of the two projections on
/// it, a lower bound of the signed distance for any axis. The bodies are apart if and only if it
/// is positive for some axis. The second is the point of the axis' facet nearest the origin: a
/// point of P, and the vector to a point of Q.
///
/// Normals point from P to Q. Index i is an axis; k = i+1 and l = i+2 are the next two, modulo 3.
namespace cde::reference::convex {

/// Support features come from slightly turned shapes, x' = x + turn x x, by 16 u. If a face or edge
/// of one body is parallel to one of the other, every axis then selects the same side, as if the
/// bodies were in general position. The geometry itself is not turned. Otherwise aligned boxes
/// would get facets with a hole at the closest point.
template <typename S>
[[nodiscard]] Vector<S> turn() {
  const double angle = 16 * kUnitRoundoff<S>;
  return {static_cast<S>(angle), static_cast<S>(0.618 * angle), static_cast<S>(-0.755 * angle)};
}

/// x turned; use only the signs of the result. 6 add 6 mul.
template <typename S>
[[nodiscard]] Vector<S> turned(const Vector<S>& x) {
  return add<S>(x, cross<S>(turn<S>(), x));
}

/// The first component of a unit vector that exceeds 5/16 in magnitude. No rotation by multiples of
/// 15 degrees produces that number. Its sign distinguishes n from -n, even for nearly equal
/// vectors.
template <typename S>
inline const S kBeyond = static_cast<S>(0.3125);
template <typename S>
struct Leading {
  Mask<S> x, y;  ///< if neither: z

  [[nodiscard]] S of(const Vector<S>& n) const { return select(x, n.x(), select(y, n.y(), n.z())); }
};

/// 2 comparisons.
template <typename S>
[[nodiscard]] Leading<S> leading_component(const Vector<S>& n) {
  return {kBeyond<S> < magnitude(n.x()), kBeyond<S> < magnitude(n.y())};
}

/// Positive for exactly one of n and -n, by the sign of the leading component. 2 comparisons.
template <typename S>
[[nodiscard]] S orientation(const Vector<S>& n) {
  return leading_component(n).of(n);
}

/// Positive if n and t agree in the sign of n's leading component.
template <typename S>
[[nodiscard]] S along(const Vector<S>& t, const Vector<S>& n) {
  const Leading<S> l = leading_component(n);
  return move_sign(l.of(t), l.of(n));
}

/// Selects one facet of an opposite pair: the one on the side of h's sign, where h is the height of
/// Q's centre over P's. If h is 0 within `tie`, both have the same distance, and `orientation`
/// selects. The sign of a zero would put facets of one plane on different sides, and leave holes in
/// it. 1 comparison.
template <typename S>
[[nodiscard]] S side_of(S h, S tie, S orientation) {
  return select(magnitude(h) <= tie, orientation, h);
}

/// A candidate axis: the normal of a facet of Q - P.
template <typename S>
struct CandidateAxis {
  S separation;     ///< distance of the projections on n; -inf if the facet has no normal
  Vector<S> n;      ///< unit, P to Q
  Difference<S> x;  ///< nearest point of the facet
  S d2;             ///< |x.v|²
  Vector<S> edge;   ///< edge of Q
  S inverse_ff;     ///< 1 / edge², or 0 if the nearest point is not between the ends of that edge
};

/// The box's corner farthest in the direction given by signs. Wires.
template <typename S>
[[nodiscard]] Vector<S> corner(const Vector<S>& signs, const Vector<S>& a) {
  return {move_sign(signs.x(), a.x()), move_sign(signs.y(), a.y()), move_sign(signs.z(), a.z())};
}

/// x clamped to the box. 6 min/max.
template <typename S>
[[nodiscard]] Vector<S> clamp_to_box(const Vector<S>& x, const Vector<S>& a) {
  return {clamp(x.x(), -a.x(), a.x()), clamp(x.y(), -a.y(), a.y()), clamp(x.z(), -a.z(), a.z())};
}

/// a.|n|: half the box's width along n. 2 add 3 mul.
template <typename S>
[[nodiscard]] S box_radius(const Vector<S>& n, const Vector<S>& a) {
  return dot<S>(a, Vector<S>(magnitude(n.x()), magnitude(n.y()), magnitude(n.z())));
}

/// Face i of the box, on the side of `side`'s sign, with the vertex q of Q. The caller computes
/// `separation`. 5 add 3 mul, 4 min/max.
template <typename S>
[[nodiscard]] CandidateAxis<S> face_axis(int i, const Vector<S>& a, S side, const Vector<S>& q,
                                         S separation) {
  const int k = (i + 1) % 3, l = (i + 2) % 3;
  CandidateAxis<S> axis;
  axis.separation = separation;
  axis.n = Vector<S>::Zero();
  axis.n[i] = move_sign(side, S{1});
  axis.x.p[i] = move_sign(side, a[i]);
  axis.x.p[k] = clamp(q[k], -a[k], a[k]);
  axis.x.p[l] = clamp(q[l], -a[l], a[l]);
  axis.x.v = sub<S>(q, axis.x.p);
  axis.d2 = dot<S>(axis.x.v, axis.x.v);
  axis.edge = Vector<S>::Zero();
  axis.inverse_ff = S{0};
  return axis;
}

/// e_i x f, of unit length.
template <typename S>
struct EdgeNormal {
  S k, l;      ///< components; component i is 0
  S inverse2;  ///< 1 / |e_i x f|², 0 if there is no normal
  Mask<S> valid;
};

/// 1 add 5 mul 1 div 1 sqrt.
template <typename S>
[[nodiscard]] EdgeNormal<S> edge_normal(int i, const Vector<S>& f) {
  const int k = (i + 1) % 3, l = (i + 2) % 3;
  const S squared = f[k] * f[k] + f[l] * f[l];
  const auto valid = usable(squared);
  const S inverse = reciprocal_or_zero<S>(valid, square_root(squared));
  return {-(f[l] * inverse), f[k] * inverse, inverse * inverse, valid};
}

/// n.x for such a normal. 1 add 2 mul.
template <typename S>
[[nodiscard]] S project(int i, const EdgeNormal<S>& n, const Vector<S>& x) {
  return n.k * x[(i + 1) % 3] + n.l * x[(i + 2) % 3];
}

/// Nearest points of two edges. One is the box's edge along axis i through `at` (component i
/// unused), |s| <= a_i. The other is the edge q + t f of Q, low <= t <= 1. It solves t in the plane
/// perpendicular to the axis, then s, then t again for that s. `inverse2` is 1 / (f_k² + f_l²),
/// `inverse_ff` 1 / f.f. It fills in the fields of the nearest points. If s is not at an end,
/// component i of v is 0. 11 add 12 mul, 2 cmp, 4 min/max.
template <typename S>
void segment_segment(CandidateAxis<S>& axis, int i, S a, const Vector<S>& at, const Vector<S>& q,
                     const Vector<S>& f, S low, S inverse2, S inverse_ff) {
  const int k = (i + 1) % 3, l = (i + 2) % 3;
  const S wk = q[k] - at[k], wl = q[l] - at[l];
  const S across = wk * f[k] + wl * f[l];
  const S t1 = clamp(-(across * inverse2), low, S{1});
  const S s1 = q[i] + t1 * f[i];
  const S s = clamp(s1, -a, a);
  const S rest = q[i] - s;
  const S t2 = -((across + rest * f[i]) * inverse_ff);
  const S t = clamp(t2, low, S{1});
  Vector<S>& v = axis.x.v;
  v[i] = select(s1 == s, S{0}, rest + t * f[i]);
  v[k] = wk + t * f[k], v[l] = wl + t * f[l];
  axis.x.p[i] = s, axis.x.p[k] = at[k], axis.x.p[l] = at[l];
  axis.d2 = dot<S>(v, v);
  axis.edge = f;
  axis.inverse_ff = select(t2 == t, inverse_ff, S{0});
}

/// Edge i of the box and the edge q + t f of Q; n is e_i x f or its opposite. `signs` selects the
/// box's edge on the side to which n points.
template <typename S>
[[nodiscard]] CandidateAxis<S> edge_axis(int i, const Vector<S>& a, const Vector<S>& signs,
                                         const Vector<S>& q, const Vector<S>& f, S low,
                                         S inverse_ff, const EdgeNormal<S>& n, S side,
                                         S separation) {
  CandidateAxis<S> axis;
  axis.separation = select(n.valid, separation, -std::numeric_limits<S>::infinity());
  axis.n[i] = S{0};
  axis.n[(i + 1) % 3] = move_sign(side, n.k);
  axis.n[(i + 2) % 3] = move_sign(side, n.l);
  segment_segment<S>(axis, i, a[i], corner<S>(signs, a), q, f, low, n.inverse2, inverse_ff);
  return axis;
}

/// An axis and the key by which it is chosen.
template <typename S>
struct Chosen {
  S key;
  CandidateAxis<S> axis;
};

/// The one with the lesser key; ties go to `low`. 1 comparison.
template <typename S>
[[nodiscard]] Chosen<S> lesser(const Chosen<S>& low, const Chosen<S>& high) {
  const auto take = high.key < low.key;
  const CandidateAxis<S>&l = low.axis, &h = high.axis;
  Chosen<S> r;
  r.key = select(take, high.key, low.key);
  r.axis.separation = select(take, h.separation, l.separation);
  r.axis.n = select<S>(take, h.n, l.n);
  r.axis.x.v = select<S>(take, h.x.v, l.x.v);
  r.axis.x.p = select<S>(take, h.x.p, l.x.p);
  r.axis.d2 = select(take, h.d2, l.d2);
  r.axis.edge = select<S>(take, h.edge, l.edge);
  r.axis.inverse_ff = select(take, h.inverse_ff, l.inverse_ff);
  return r;
}

/// The axis with the least key, by a balanced tree over neighbours (0,1), (2,3), ... An odd last
/// one goes up unchanged; ties go to the lowest index. N - 1 comparisons. A tree need only carry
/// the fields used of its result.
template <typename S, std::size_t N>
[[nodiscard]] CandidateAxis<S> least(const std::array<Chosen<S>, N>& all) {
  if constexpr (N == 1) {
    return all[0].axis;
  } else {
    std::array<Chosen<S>, (N + 1) / 2> half;
    for (std::size_t i = 0; i < N / 2; ++i) half[i] = lesser(all[2 * i], all[2 * i + 1]);
    if constexpr (N % 2 == 1) half[N / 2] = all[N - 1];
    return least(half);
  }
}

/// Keeps the point of Q, and takes the point of the box nearest to where it would be s n away. If
/// faces are nearly parallel, points far apart on a facet are equally near the origin. 9 add 3 mul,
/// 6 min/max.
template <typename S>
[[nodiscard]] Difference<S> settle(const Difference<S>& x, S s, const Vector<S>& n,
                                   const Vector<S>& a) {
  const Vector<S> q = add<S>(x.p, x.v);
  const Vector<S> p = clamp_to_box<S>(sub<S>(q, scale<S>(n, s)), a);
  return {sub<S>(q, p), p};
}

/// A point near the origin and its slack.
template <typename S>
struct Nearest {
  Difference<S> x;
  S slack;
};

/// Polishes twice. The second step is used if it does not increase the slack. A step finds the
/// point nearest the origin on a segment, and may gain only rounding. It may then turn v by more
/// than it corrects, and the slack grows by the ratio of the bodies' size to the segment.
/// Function support(v) is the point of Q - P farthest against v. 37 add 29 mul 2 div 3 cmp, and 3
/// supports.
template <typename S, typename Support>
[[nodiscard]] Nearest<S> polish_twice(const Difference<S>& start, S tie, const Support& support) {
  const Difference<S> once = polish<S>(start, support(start.v), tie).x;
  const Polished<S> twice = polish<S>(once, support(once.v), tie);
  const S after = slack<S>(twice.x, support(twice.x.v));
  const auto worse = twice.slack_before < after;
  return {{select<S>(worse, once.v, twice.x.v), select<S>(worse, once.p, twice.x.p)},
          select(worse, twice.slack_before, after)};
}

/// Result of a pair's candidate axes before polishing.
template <typename S>
struct Choice {
  S s;                       ///< the largest distance of projections
  CandidateAxis<S> witness;  ///< if the bodies penetrate: n, v and p belong to s
  Difference<S> start;       ///< if they are apart: the nearest point, to be polished
};

/// The largest distance of projections gives s, and its axis the normal if the bodies penetrate.
/// If faces are parallel, or the bodies concentric, several axes share it or nearly so. Only one
/// of their facets contains the projection of the origin. The witness points are therefore the
/// points of the axis whose vector v is nearest to s n. For an axis whose distance ties with the
/// largest, n is that axis; for the others it is the axis with the largest distance. If the bodies
/// are apart, the axis with the least distance gives the nearest points, which are polished. `wide`
/// is the tie for normals that point away from each other.
template <typename S, std::size_t N>
[[nodiscard]] Choice<S> choose(const std::array<CandidateAxis<S>, N>& axes, S tie, S wide) {
  std::array<Chosen<S>, N> by_separation, by_witness, by_distance;
  for (std::size_t i = 0; i < N; ++i) {
    by_separation[i] = {-axes[i].separation, axes[i]};
    by_distance[i] = {axes[i].d2, axes[i]};
  }
  const CandidateAxis<S> largest = least(by_separation);
  const S s = largest.separation;
  const S tied = s - tie;
  const Leading<S> leading = leading_component(largest.n);
  const S lead = leading.of(largest.n);
  const S nearly = s - wide;
  for (std::size_t i = 0; i < N; ++i) {
    CandidateAxis<S> f = axes[i];
    const auto opposite = is_negative(move_sign(lead, leading.of(f.n)));
    f.n = select<S>(select(opposite, nearly, tied) <= f.separation, f.n, largest.n);
    const Vector<S> off = sub<S>(f.x.v, scale<S>(f.n, s));
    by_witness[i] = {dot<S>(off, off), f};
  }
  const CandidateAxis<S> near = least(by_distance);
  return {s, least(by_witness), {perpendicular<S>(near.x.v, near.edge, near.inverse_ff), near.x.p}};
}

/// The signed distance from all candidate axes of a pair; `a` are the half extents of P.
/// Function support(v) is the point of Q - P farthest against v.
template <typename S, std::size_t N, typename Support>
[[nodiscard]] SignedDistance<S> answer(const std::array<CandidateAxis<S>, N>& axes,
                                       const Vector<S>& a, S tie, const Support& support) {
  const Choice<S> choice = choose<S>(axes, tie, S{4} * tie);
  const S s = choice.s;
  const CandidateAxis<S>& witness = choice.witness;
  const Nearest<S> nearest = polish_twice<S>(choice.start, tie, support);
  return decide<S>({s, witness.n, settle<S>(witness.x, s, witness.n, a)}, nearest.x, S{0} < s, tie,
                   [&](const Direction<S>& direction) {
                     // The distance is between the two bounds: the midpoint has at most half the
                     // error.
                     const S distance_along = direction.d - nearest.slack * direction.inverse;
                     return PointDistance<S>{distance_along,
                                             (direction.d + max_num(s, distance_along)) * kHalf<S>};
                   });
}

}  // namespace cde::reference::convex
