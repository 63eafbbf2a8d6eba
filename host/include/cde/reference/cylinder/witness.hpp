#pragma once
#include "cde/reference/cylinder/search.hpp"

/// Witness points: a point of A that is, moved by s n, a point of B. The support points for n will
/// not do where faces or edges lie on each other: every point of them is one. Alternating
/// projection onto the face of A and that of B moved by -s n (von Neumann; Bauschke and Borwein,
/// SIAM Review 38, 1996) finds one that both share.
namespace cde::reference::cylinder {

/// How far from perpendicular to the axis, in radians, a normal still touches the whole length of a
/// cylinder's side: what rounding leaves of a normal that is.
template <typename S>
inline constexpr double kAlongside = 16 * kUnitRoundoff<S>;

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

/// Nearest point of the box around the origin. 18 mul, 12 add, 6 min or max.
template <typename S>
[[nodiscard]] Vector<S> project_box(const Vector<S>& x, const Pair<S>& pair) {
  std::array<Vector<S>, 3> p;
  for (int i = 0; i < 3; ++i)
    p[i] = scale<S>(pair.axis[i], clamp<S>(dot<S>(pair.axis[i], x), -pair.half[i], pair.half[i]));
  return add<S>(p[0], add<S>(p[1], p[2]));
}

/// Nearest point of the triangle: of its plane if that lies inside, else of an edge. An edge or a
/// triangle without length or area is selected away by its NaN, and v0 remains. 48 mul, 41 add or
/// sub, 3 div, 11 cmp or min or max.
template <typename S>
[[nodiscard]] Vector<S> project_triangle(const Vector<S>& x, const Pair<S>& pair) {
  const S zero(0);
  const std::array<Vector<S>, 3> from = {Vector<S>::Zero(), Vector<S>::Zero(), pair.reach[0]};
  Mask<S> inside = true;
  Vector<S> best = Vector<S>::Zero();
  S least = dot<S>(x, x);
  for (int i = 0; i < 3; ++i) {
    const Vector<S> edge = pair.reach[i], w = sub<S>(x, from[i]);
    const S t = clamp<S>(dot<S>(w, edge) / dot<S>(edge, edge), zero, S(1));
    const Vector<S> p = add<S>(from[i], scale<S>(edge, t)), r = sub<S>(x, p);
    const S rr = dot<S>(r, r);
    best = select<S>(rr < least, p, best);
    least = min_num(rr, least);
    // v0 v2 runs against the other two.
    const S side = dot<S>(cross<S>(edge, w), pair.face);
    inside = inside && (i == 1 ? side <= zero : zero <= side);
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
};

template <typename S>
[[nodiscard]] Contact<S> contact(const Pair<S>& pair, const Search<S>& s, bool lines) {
  const Vector<S>& n = s.best_n;
  const S flat(kAlongside<S>);
  Contact<S> c;
  c.at = evaluate<S>(pair, n);
  c.shift = scale<S>(n, s.best_g);
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
      return project_box<S>(x, pair);
    default:
      return project_triangle<S>(x, pair);
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
  const Contact<S> c = contact<S>(pair, s, p.index + 2 < kProjections);
  if (p.phase == Phase::kTouch) {
    const Vector<S> of_b = add<S>(c.at.pa, sub<S>(c.at.plus.y, c.shift));
    const Vector<S> on_a = project_a<S>(of_b, pair, c), on_b = project_cylinder<S>(c.at.pa, c.b);
    const Mask<S> b_first = squared<S>(sub<S>(on_a, of_b)) < squared<S>(sub<S>(on_b, c.at.pa));
    s.q = select<S>(b_first, on_a, c.at.pa);
    return;
  }
  const Vector<S> on_b = project_cylinder<S>(s.q, c.b), on_a = project_a<S>(on_b, pair, c);
  const Vector<S> away = sub<S>(on_b, s.q), move = sub<S>(on_a, s.q);
  const S gain = squared<S>(away) / dot<S>(away, move);
  const Mask<S> further = S(1) < gain && gain < S(1 / kAlongside<S>) && Mask<S>(p.index % 2 == 0);
  s.q = select<S>(further, add<S>(s.q, scale<S>(move, gain)), on_a);
}

}  // namespace cde::reference::cylinder
