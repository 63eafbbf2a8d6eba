#pragma once
#include "cde/reference/cylinder/search.hpp"

/// Witness points: a point of A that is, moved by s n, a point of B. The support points for n will
/// not do where faces or edges lie on each other: every point of them is one. Alternating
/// projection onto A and onto B moved by -s n (von Neumann; Bauschke and Borwein, SIAM Review 38,
/// 1996) finds one that both share.
namespace cde::reference::cylinder {

/// Nearest point of the solid cylinder. 24 mul, 16 add or sub, 1 div, 1 sqrt, 3 min or max.
template <typename S>
[[nodiscard]] Vector<S> project_cylinder(const Vector<S>& x, const Vector<S>& c, const Vector<S>& a,
                                         S half, S radius) {
  const Vector<S> w = sub<S>(x, c), l = cross<S>(cross<S>(a, w), a);
  const S z = clamp<S>(dot<S>(a, w), -half, half);
  const S f = min_num(S(1), radius / square_root(dot<S>(l, l)));
  return add<S>(c, add<S>(scale<S>(a, z), scale<S>(l, f)));
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

template <typename S>
[[nodiscard]] Vector<S> project_a(const Vector<S>& x, const Pair<S>& pair) {
  switch (pair.body) {
    case Body::kCylinder:
      return project_cylinder<S>(x, Vector<S>::Zero(), pair.axis[0], pair.half[0], pair.radius);
    case Body::kBox:
      return project_box<S>(x, pair);
    default:
      return project_triangle<S>(x, pair);
  }
}

/// Nearest point of B moved by -s n.
template <typename S>
[[nodiscard]] Vector<S> project_b(const Vector<S>& x, const Pair<S>& pair, const Vector<S>& shift) {
  return sub<S>(project_cylinder<S>(add<S>(x, shift), pair.d, pair.b, pair.b_half, pair.b_radius),
                shift);
}

template <typename S>
[[nodiscard]] S squared(const Vector<S>& v) {
  return dot<S>(v, v);
}

/// A witness pass. kTouch starts from that body's support point which is nearer to the other body:
/// a corner or rim that meets a face knows where. kProject goes to B and back to A, and on to where
/// the two faces would cross if they were flat (Gubin, Polyak and Raik, 1967), which without bounds
/// is exact in one pass; every second pass stays on A.
template <typename S>
void witness(const Pair<S>& pair, Search<S>& s, const Pass& p) {
  const Vector<S> shift = scale<S>(s.best_n, s.best_g);
  if (p.phase == Phase::kTouch) {
    const Evaluation<S> at = evaluate<S>(pair, s.best_n);
    const Vector<S> of_b = add<S>(at.pa, sub<S>(at.plus.y, shift));
    const Vector<S> near_b = project_a<S>(of_b, pair), near_a = project_b<S>(at.pa, pair, shift);
    const Mask<S> b_first = squared<S>(sub<S>(near_b, of_b)) < squared<S>(sub<S>(near_a, at.pa));
    s.q = select<S>(b_first, near_b, at.pa);
    return;
  }
  const Vector<S> on_b = project_b<S>(s.q, pair, shift), on_a = project_a<S>(on_b, pair);
  const Vector<S> away = sub<S>(on_b, s.q), move = sub<S>(on_a, s.q);
  const S gain = squared<S>(away) / dot<S>(away, move);
  const Mask<S> further = S(1) < gain && gain < S(0x1p10) && p.index % 2 == 0;
  s.q = select<S>(further, add<S>(s.q, scale<S>(move, gain)), on_a);
}

}  // namespace cde::reference::cylinder
