// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/reference/pipes/cylinder/search.hpp"

/// @file
/// Witness points: a point of A that becomes a point of B when moved by s n. The support points for
/// n do not suffice if faces or edges touch along their length: every point of them is a support
/// point. Alternating projection finds a point that both share. It projects onto A and onto B moved
/// by -s n (von Neumann; Bauschke and Borwein, SIAM Review 38, 1996).
///
/// It first projects between the features that n touches: a vertex, edge, face, line of a side, cap
/// or rim. These meet at large angles even if the solids separate by a millionth. Then it projects
/// between all features that n nearly touches. Finally it projects between the solids, which is
/// right even if n is not. Solids that are clearly apart are not shifted: the projections approach
/// their nearest points, and n is the direction between them. The best point of all steps is kept.
namespace cde::reference::cylinder {

/// Angle in radians within which a normal touches the whole of an edge, face, cap or line of a
/// side. The first value is what rounding leaves of a normal that does. The second allows for an
/// error of the first normal.
template <typename S>
inline constexpr std::array<double, 2> kTouching = {64 * kUnitRoundoff<S>,
                                                    0x1p14 * kUnitRoundoff<S>};

/// Clearly apart means that s is more than this share of the sum of both distances.
inline constexpr double kClear = 0x1p-6;

/// A cylinder, and how n touches it.
template <typename S>
struct Cylindrical {
  Vector<S> c, a;
  S half, radius;
  S end;  ///< height of the cap on n's side
  /// From the axis to the line of the side, or to the point of the rim that n touches.
  Vector<S> side;
  Mask<S> alongside;  ///< n touches that line, which then replaces the round side
  Mask<S> flat;       ///< n touches the whole cap
  Mask<S> rim;        ///< n touches only the cap's rim, which then replaces the cylinder
};

/// Nearest point of the solid cylinder, of its rim, or of a line of its side. A round side and a
/// tangent plane separate so slowly that each projection only halves the error. From the axis the
/// whole rim is equally near, and l has no direction. The point that n touches is then used.
/// Operators: 24 mul, 16 add or sub, 1 div, 1 sqrt, 1 cmp, 3 min or max.
template <typename S>
[[nodiscard]] Vector<S> project_cylinder(const Vector<S>& x, const Cylindrical<S>& cylinder) {
  const Vector<S>& a = cylinder.a;
  const Vector<S> w = sub<S>(x, cylinder.c), l = cross<S>(cross<S>(a, w), a);
  const S z =
      select<S>(cylinder.rim, cylinder.end, clamp<S>(dot<S>(a, w), -cylinder.half, cylinder.half));
  const S square = dot<S>(l, l), least(4 * static_cast<double>(std::numeric_limits<S>::min()));
  const S ratio = cylinder.radius / square_root(square);
  const S f = select<S>(cylinder.rim, ratio, min_num(S(1), ratio));
  const Mask<S> named = cylinder.alongside || (cylinder.rim && square < least);
  const Vector<S> across = select<S>(named, cylinder.side, Vector<S>(scale<S>(l, f)));
  return add<S>(cylinder.c, add<S>(scale<S>(a, z), across));
}

/// How n touches the polyhedron A: with `features`, its features within `near` radian.
template <typename S>
struct Touching {
  Vector<S> n;
  S near;
  Mask<S> features;
};

/// Nearest point of the box around the origin, or of the vertex, edge or face that n touches. 27
/// mul, 18 add, 3 cmp, 6 min or max.
template <typename S>
[[nodiscard]] Vector<S> project_box(const Vector<S>& x, const Pair<S>& pair,
                                    const Touching<S>& touching) {
  std::array<Vector<S>, 3> p;
  for (int i = 0; i < 3; ++i) {
    const S tilt = dot<S>(pair.axis[i], touching.n);
    const Mask<S> fixed = touching.near < magnitude(tilt) && touching.features;
    const S at = clamp<S>(dot<S>(pair.axis[i], x), -pair.half[i], pair.half[i]);
    p[i] = scale<S>(pair.axis[i], select<S>(fixed, move_sign(tilt, pair.half[i]), at));
  }
  return add<S>(p[0], add<S>(p[1], p[2]));
}

/// Nearest point of the triangle, or of the vertex, edge or face that n touches. It is the point of
/// the plane if that lies inside and is no farther, because the normal of a sliver may lean along
/// it. Otherwise it is a point of an edge. An edge or a triangle without length or area is selected
/// away by its NaN, and v0 remains.
/// Operators: 64 mul, 54 add or sub, 3 div, 15 cmp or min or max.
template <typename S>
[[nodiscard]] Vector<S> project_triangle(const Vector<S>& x, const Pair<S>& pair,
                                         const Touching<S>& touching) {
  const S zero(0);
  const Vector<S>& n = touching.n;
  const Mask<S> solid = !touching.features;
  const Vector<S> v0 = Vector<S>::Zero(), v1 = pair.reach[0], v2 = pair.reach[1];
  const std::array<Vector<S>, 3> from = {v0, v0, v1};
  const std::array<Vector<S>, 3> along = {pair.axis[0], pair.axis[2], pair.axis[1]};
  const S p1 = dot<S>(n, v1), p2 = dot<S>(n, v2);
  const Mask<S> second = p1 < p2, first = zero < max_num(p1, p2);
  // Which edges end at the vertex that n touches, and which edges n touches along their length.
  const std::array<Mask<S>, 3> ends = {!(first && second), second || !first, first};
  std::array<Mask<S>, 3> flat;
  for (int i = 0; i < 3; ++i) flat[i] = magnitude(dot<S>(n, along[i])) <= touching.near || solid;
  const Mask<S> face = flat[0] && flat[1] && flat[2];
  Mask<S> inside = face;
  Vector<S> best = select<S>(first && touching.features, select<S>(second, v2, v1), v0);
  const Vector<S> apart = sub<S>(x, best);
  S least = dot<S>(apart, apart);
  for (int i = 0; i < 3; ++i) {
    const Vector<S> edge = pair.reach[i], w = sub<S>(x, from[i]);
    const S t = clamp<S>(dot<S>(w, edge) / dot<S>(edge, edge), zero, S(1));
    const Vector<S> p = add<S>(from[i], scale<S>(edge, t)), r = sub<S>(x, p);
    const S rr = dot<S>(r, r);
    const Mask<S> nearer = rr < least && flat[i] && (ends[i] || face);
    best = select<S>(nearer, p, best);
    least = select<S>(nearer, rr, least);
    // Edge v0 v2 runs against the other two. Strict comparison: without area nothing is inside.
    const S side = dot<S>(cross<S>(edge, w), pair.face);
    inside = inside && (i == 1 ? side < zero : zero < side);
  }
  const S height = dot<S>(x, pair.face);
  const Vector<S> plane = sub<S>(x, scale<S>(pair.face, height));
  return select<S>(inside && height * height <= least, plane, best);
}

/// Settings of a witness pass beside its projections, derived from its number.
struct WitnessPass {
  bool touch;      ///< starts from support points instead of projecting
  bool first;      ///< uses what n touches; otherwise what it nearly touches
  bool features;   ///< between features; otherwise between the solids
  bool lines;      ///< includes lines of sides, which a start from the other body may miss
  bool unshifted;  ///< without shifting B, if clearly apart
  bool trial;      ///< n is the direction between the nearest points so far
  bool further;    ///< extrapolates to where flat faces would cross
  explicit WitnessPass(const Pass& p)
      : touch(p.phase == Phase::kTouch),
        first(p.track == 0),
        features(touch || first || p.index < kProjections[1] - 2),
        lines(first || !touch),
        unshifted(!touch && !first && kUnshifted <= p.index),
        trial(unshifted && kUnshifted < p.index),
        further(first || p.index % 2 == 1) {}
};

/// How n touches a cylinder with axis a; `at` is its rim for n, `along` is a.n.
template <typename S>
[[nodiscard]] Cylindrical<S> touched(const Vector<S>& a, S half, S radius, S along,
                                     const Rim<S>& at, const Touching<S>& touching, bool lines,
                                     bool rims) {
  Cylindrical<S> t;
  const Mask<S> level = magnitude(along) <= touching.near;
  t.c = Vector<S>::Zero(), t.a = a, t.half = half, t.radius = radius;
  t.end = move_sign(along, half), t.side = at.side;
  t.alongside = touching.features && level && Mask<S>(lines);
  t.flat = at.kappa == S(0) || radius <= at.kappa * touching.near;
  t.rim = touching.features && Mask<S>(rims) && !level && !t.flat;
  return t;
}

template <typename S>
[[nodiscard]] Vector<S> project_a(const Vector<S>& x, const Pair<S>& pair, const Cylindrical<S>& a,
                                  const Touching<S>& touching) {
  switch (pair.body) {
    case Body::kCylinder:
      return project_cylinder<S>(x, a);
    case Body::kBox:
      return project_box<S>(x, pair, touching);
    default:
      return project_triangle<S>(x, pair, touching);
  }
}

template <typename S>
[[nodiscard]] S squared(const Vector<S>& v) {
  return dot<S>(v, v);
}

/// A witness pass. Phase kTouch starts from the body whose support point is nearer to the other
/// body, because a corner or rim on a face determines the place. It may instead start from the
/// middle of a cap that is touched entirely: the nearest point of the other's feature is on the cap
/// if any is. Phase kProject projects to B and back to A, then continues to where the two faces
/// would cross if they were flat (Gubin, Polyak and Raik, 1967). Without bounds that is exact in
/// one pass. If the solids are clearly apart, it extrapolates the last two steps instead (Anderson,
/// 1965). The direction between the nearest points becomes n if g does not fall, and both together
/// are no worse than before.
template <typename S>
void witness(const Pair<S>& pair, Search<S>& s, const Pass& p) {
  const WitnessPass now(p);
  const bool cylinders = pair.body == Body::kCylinder;
  const S one(1), most(1 / kTouching<S>[0]);
  // Points too near for a direction leave n unchanged.
  const Vector<S> n = now.trial ? normalise_or<S>(s.next, s.best_n) : s.best_n;
  const Evaluation<S> at = evaluate<S>(pair, n);
  const S sum = magnitude(at.plus.g) + magnitude(at.minus.g);
  const Mask<S> clear = Mask<S>(now.unshifted) && sum * S(kClear) < s.best_g;
  const Touching<S> touching = {s.best_n, S(kTouching<S>[now.first ? 0 : 1]),
                                Mask<S>(now.features) && !clear};
  const bool rims = now.first || !cylinders;
  Cylindrical<S> a{};
  if (cylinders)
    a = touched<S>(pair.axis[0], pair.half[0], pair.radius, dot<S>(pair.axis[0], s.best_n), at.a,
                   touching, now.lines, rims);
  Cylindrical<S> b = touched<S>(pair.b, pair.b_half, pair.b_radius, -dot<S>(pair.b, n), at.b,
                                touching, now.lines, rims);
  b.side = -b.side;
  const Vector<S> shift = scale<S>(s.best_n, s.best_g);
  b.c = select<S>(clear, pair.d, Vector<S>(sub<S>(pair.d, shift)));

  // From A's point to B, and from B's to A.
  const Mask<S> cap_a = Mask<S>(now.first && cylinders) && a.flat && !b.rim;
  const Mask<S> cap_b = Mask<S>(now.first) && b.flat && (!a.rim || Mask<S>(!cylinders));
  Vector<S> end_a, end_b;
  for (int k = 0; k < 3; ++k) end_a[k] = move_sign(a.end, pair.reach[0][k]);
  for (int k = 0; k < 3; ++k) end_b[k] = move_sign(b.end, pair.b_reach[k]);
  const Vector<S> of_b = select<S>(cap_b, Vector<S>(add<S>(b.c, end_b)),
                                   Vector<S>(add<S>(at.pa, sub<S>(at.plus.y, shift))));
  const bool fresh = now.unshifted && !now.trial;
  const Vector<S> from = now.touch ? select<S>(cap_a, end_a, at.pa)
                         : fresh   ? select<S>(clear, s.witness, s.q)
                                   : s.q;
  const Vector<S> on_b = project_cylinder<S>(from, b);
  const Vector<S> to_a = now.touch ? of_b : on_b, on_a = project_a<S>(to_a, pair, a, touching);

  // The quality of the point, and of n with it.
  const Vector<S> step = sub<S>(on_b, from), apart = sub<S>(to_a, on_a);
  const S away = squared<S>(step);
  const Vector<S> missing = sub<S>(
      apart, select<S>(clear, Vector<S>(scale<S>(n, s.best_g)), Vector<S>(Vector<S>::Zero())));
  const S miss = squared<S>(missing);
  const Mask<S> b_first = (miss < away && !cap_a) || cap_b;
  const Vector<S> start = select<S>(b_first, on_a, select<S>(cap_a, on_b, from));
  const Vector<S> point = now.touch ? start : on_a;
  const S off = now.touch ? select<S>(b_first, miss, away) : miss;
  const S noise = sum * S(4 * kUnitRoundoff<S>), bound = max_num(s.off, noise * noise);
  const Mask<S> no_lower = s.best_g - at.plus.g <= sum * S(2 * kUnitRoundoff<S>);
  const Mask<S> take = (off < select<S>(clear, bound, s.off) && (no_lower || !clear)) ||
                       Mask<S>(now.touch && now.first);
  s.witness = select<S>(take, point, s.witness);
  s.off = select<S>(take, off, s.off);
  const Mask<S> turn = take && clear;
  s.best_n = select<S>(turn, n, s.best_n);
  s.best_g = select<S>(turn, max_num(s.best_g, at.plus.g), s.best_g);

  // The start of the next pass.
  const Vector<S> move = sub<S>(on_a, from), bend = sub<S>(move, s.lo_y);
  const Vector<S> against = select<S>(clear, bend, step);
  const S gain =
      select<S>(clear, dot<S>(move, bend), away) / dot<S>(against, select<S>(clear, bend, move));
  const Vector<S> along = select<S>(clear, Vector<S>(sub<S>(sub<S>(s.lo_n, from), bend)), move);
  const Mask<S> bounded = magnitude(gain) < most && (clear || one < gain);
  const Mask<S> further = bounded && (clear ? Mask<S>(now.trial) : Mask<S>(now.further));
  const Vector<S> beyond = add<S>(select<S>(clear, on_a, from), scale<S>(along, gain));
  s.q = now.touch ? start : select<S>(further, beyond, on_a);
  s.next = select<S>(clear, apart, s.best_n);
  s.lo_n = from, s.lo_y = move;
}

}  // namespace cde::reference::cylinder
