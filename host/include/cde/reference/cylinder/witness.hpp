#pragma once
#include "cde/reference/cylinder/search.hpp"

/// Witness points: a point of A that is, moved by s n, a point of B. The support points for n will
/// not do where faces or edges lie on each other: every point of them is one. Alternating
/// projection onto the face of A and that of B moved by -s n (von Neumann; Bauschke and Borwein,
/// SIAM Review 38, 1996) finds one that both share: first between the features that n touches, a
/// vertex, edge, face or line, which meet at large angles where the solids part by a millionth;
/// then between the solids, which is right where n is not. The best point of either stays.
namespace cde::reference::cylinder {

/// How far from perpendicular to the axis, in radians, a normal still touches the whole length of a
/// cylinder's side: what rounding leaves of a normal that is.
template <typename S>
inline constexpr double kAlongside = 16 * kUnitRoundoff<S>;

/// How far off, a normal still touches the whole of an edge or face.
template <typename S>
inline constexpr double kAcross = 64 * kUnitRoundoff<S>;

/// A cylinder, and where n touches its side.
template <typename S>
struct Cylindrical {
  Vector<S> c, a;
  S half, radius;
  Vector<S> side;     ///< from the axis to the line of the side
  Mask<S> alongside;  ///< the side is that line instead of round
};

/// Nearest point of the solid cylinder, or of a line of its side: a round side and a plane that
/// touches it part so slowly that every projection merely halves the error. 24 mul, 16 add or sub,
/// 1 div, 1 sqrt, 3 min or max.
template <typename S>
[[nodiscard]] Vector<S> project_cylinder(const Vector<S>& x, const Cylindrical<S>& cylinder) {
  const Vector<S>& a = cylinder.a;
  const Vector<S> w = sub<S>(x, cylinder.c), l = cross<S>(cross<S>(a, w), a);
  const S z = clamp<S>(dot<S>(a, w), -cylinder.half, cylinder.half);
  const S f = min_num(S(1), cylinder.radius / square_root(dot<S>(l, l)));
  const Vector<S> across = select<S>(cylinder.alongside, cylinder.side, Vector<S>(scale<S>(l, f)));
  return add<S>(cylinder.c, add<S>(scale<S>(a, z), across));
}

/// Nearest point of the box around the origin, or of the vertex, edge or face that n touches. 27
/// mul, 18 add, 3 cmp, 6 min or max.
template <typename S>
[[nodiscard]] Vector<S> project_box(const Vector<S>& x, const Pair<S>& pair, const Vector<S>& n,
                                    bool feature) {
  std::array<Vector<S>, 3> p;
  for (int i = 0; i < 3; ++i) {
    const S tilt = dot<S>(pair.axis[i], n);
    const Mask<S> fixed = S(kAcross<S>) < magnitude(tilt) && Mask<S>(feature);
    const S at = clamp<S>(dot<S>(pair.axis[i], x), -pair.half[i], pair.half[i]);
    p[i] = scale<S>(pair.axis[i], select<S>(fixed, move_sign(tilt, pair.half[i]), at));
  }
  return add<S>(p[0], add<S>(p[1], p[2]));
}

/// Nearest point of the triangle, or of the vertex, edge or face that n touches: of its plane if
/// that lies inside, else of an edge. An edge or a triangle without length or area is selected away
/// by its NaN, and v0 remains. 63 mul, 54 add or sub, 3 div, 14 cmp or min or max.
template <typename S>
[[nodiscard]] Vector<S> project_triangle(const Vector<S>& x, const Pair<S>& pair,
                                         const Vector<S>& n, bool feature) {
  const S zero(0);
  const Vector<S> v0 = Vector<S>::Zero(), v1 = pair.reach[0], v2 = pair.reach[1];
  const std::array<Vector<S>, 3> from = {v0, v0, v1};
  const std::array<Vector<S>, 3> along = {pair.axis[0], pair.axis[2], pair.axis[1]};
  const S p1 = dot<S>(n, v1), p2 = dot<S>(n, v2);
  const Mask<S> second = p1 < p2, first = zero < max_num(p1, p2);
  // Which edges end at the vertex that n touches.
  const std::array<Mask<S>, 3> ends = {!(first && second), second || !first, first};
  Mask<S> inside = true;
  Vector<S> best = select<S>(first && Mask<S>(feature), select<S>(second, v2, v1), v0);
  const Vector<S> apart = sub<S>(x, best);
  S least = dot<S>(apart, apart);
  for (int i = 0; i < 3; ++i) {
    const Vector<S> edge = pair.reach[i], w = sub<S>(x, from[i]);
    const S t = clamp<S>(dot<S>(w, edge) / dot<S>(edge, edge), zero, S(1));
    const Vector<S> p = add<S>(from[i], scale<S>(edge, t)), r = sub<S>(x, p);
    const S rr = dot<S>(r, r);
    const Mask<S> flat = magnitude(dot<S>(n, along[i])) <= S(kAcross<S>) || Mask<S>(!feature);
    const Mask<S> nearer = rr < least && flat && (ends[i] || Mask<S>(!feature));
    best = select<S>(nearer, p, best);
    least = select<S>(nearer, rr, least);
    // v0 v2 runs against the other two.
    const S side = dot<S>(cross<S>(edge, w), pair.face);
    inside = inside && (i == 1 ? side <= zero : zero <= side) && flat;
  }
  const Vector<S> plane = sub<S>(x, scale<S>(pair.face, dot<S>(x, pair.face)));
  return select<S>(inside, plane, best);
}

/// What the projections of a pass need: n, s n, and both cylinders as n touches them.
template <typename S>
struct Contact {
  Evaluation<S> at;
  Vector<S> shift;
  Cylindrical<S> a, b;  ///< b moved by -s n
  Vector<S> n;
  bool feature;  ///< A is what n touches of it
};

template <typename S>
[[nodiscard]] Contact<S> contact(const Pair<S>& pair, const Search<S>& s, bool feature,
                                 bool lines) {
  const Vector<S>& n = s.best_n;
  const S flat(kAlongside<S>);
  Contact<S> c;
  c.at = evaluate<S>(pair, n);
  c.shift = scale<S>(n, s.best_g);
  c.n = n, c.feature = feature;
  c.a = {Vector<S>::Zero(), pair.axis[0],
         pair.half[0],      pair.radius,
         c.at.a.side,       Mask<S>(lines) && magnitude(dot<S>(pair.axis[0], n)) <= flat};
  c.b = {sub<S>(pair.d, c.shift),
         pair.b,
         pair.b_half,
         pair.b_radius,
         -c.at.b.side,
         Mask<S>(lines) && magnitude(dot<S>(pair.b, n)) <= flat};
  return c;
}

template <typename S>
[[nodiscard]] Vector<S> project_a(const Vector<S>& x, const Pair<S>& pair, const Contact<S>& c) {
  switch (pair.body) {
    case Body::kCylinder:
      return project_cylinder<S>(x, c.a);
    case Body::kBox:
      return project_box<S>(x, pair, c.n, c.feature);
    default:
      return project_triangle<S>(x, pair, c.n, c.feature);
  }
}

template <typename S>
[[nodiscard]] S squared(const Vector<S>& v) {
  return dot<S>(v, v);
}

/// A witness pass. kTouch starts from that body's support point which is nearer to the other body:
/// a corner or rim that meets a face knows where. kProject goes to B and back to A, and on to where
/// the two faces would cross if they were flat (Gubin, Polyak and Raik, 1967), which without bounds
/// is exact in one pass; every second pass stays on A. The last two see the true, round side, which
/// makes up for what n is off.
template <typename S>
void witness(const Pair<S>& pair, Search<S>& s, const Pass& p) {
  const bool touch = p.phase == Phase::kTouch, feature = p.track == 0;
  const Contact<S> c =
      contact<S>(pair, s, feature, feature || (!touch && p.index + 2 < kProjections[1]));
  const Vector<S> of_b = add<S>(c.at.pa, sub<S>(c.at.plus.y, c.shift));
  const Vector<S> from = touch ? c.at.pa : s.q, on_b = project_cylinder<S>(from, c.b);
  const Vector<S> to_a = touch ? of_b : on_b, on_a = project_a<S>(to_a, pair, c);
  const Vector<S> step = sub<S>(on_b, from);
  const S away = squared<S>(step), apart = squared<S>(sub<S>(on_a, to_a));
  const Mask<S> b_first = apart < away;
  const Vector<S> point = touch ? select<S>(b_first, on_a, from) : on_a;
  const S off = touch ? select<S>(b_first, apart, away) : apart;
  const Mask<S> take = off < s.off || Mask<S>(touch && feature);
  s.witness = select<S>(take, point, s.witness);
  s.off = select<S>(take, off, s.off);
  if (touch) {
    s.q = point;
    return;
  }
  const Vector<S> move = sub<S>(on_a, from);
  const S gain = away / dot<S>(step, move);
  const Mask<S> further =
      S(1) < gain && gain < S(1 / kAlongside<S>) && Mask<S>(p.index % 2 == p.track);
  s.q = select<S>(further, add<S>(from, scale<S>(move, gain)), on_a);
}

}  // namespace cde::reference::cylinder
