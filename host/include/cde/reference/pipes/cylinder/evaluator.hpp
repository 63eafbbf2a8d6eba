// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <limits>

#include "cde/geometry/ops.hpp"

/// @file
/// g(n) = -h_B(-n) - h_A(n): the distance between the projections of A and B on the unit normal n.
/// It comes with all that the search needs: points of the Minkowski difference and curvatures. B is
/// a cylinder; A is a cylinder, a box or a triangle. Everything is relative to A's origin (the
/// centre of a box or cylinder, v0 of a triangle), so nothing depends on the position of the scene.
namespace cde::reference::cylinder {

/// Shape of the primary.
enum class Body { kCylinder, kBox, kTriangle };

/// Operands of a pair for the evaluator: 39 words. The triangle's `axis` and `face` are written by
/// its first passes, everything else once when the pair enters.
template <typename S>
struct Pair {
  Body body = Body::kCylinder;
  Vector<S> origin = Vector<S>::Zero();  ///< A's origin, world frame; read at the output
  Vector<S> d;                           ///< centre of B
  Vector<S> b;                           ///< B: axis, half height times axis, radius
  Vector<S> b_reach;
  S b_half, b_radius;
  /// Unit axis of the cylinder ([0]), axes of the box, or edges of the triangle.
  std::array<Vector<S>, 3> axis;
  /// Cylinder: half height times axis ([0]). Box: half extent times axis. Triangle: v1 - v0, v2 -
  /// v0 and v2 - v1.
  std::array<Vector<S>, 3> reach;
  std::array<S, 3> half;  ///< half height ([0]), or half extents; unused for a triangle
  S radius;               ///< of the cylinder
  Vector<S> face;         ///< unit normal of the triangle
};

/// A cylinder's rim in direction n. Field `kappa` is the radius of curvature of the support
/// function across n, r / |a x n|, in the tangent direction v = unit(a x n). On the axis both are
/// 0.
template <typename S>
struct Rim {
  S width;         ///< r |a x n|
  Vector<S> side;  ///< r unit(a x n) x a: from the axis to the support point
  S kappa;
  Vector<S> v;
};

/// 24 mul, 10 add or sub, 1 div, 1 sqrt, 1 cmp. `off`: the support point is the centre of the cap.
///
/// It uses a x n, because n - (a.n) a loses all its digits near the axis. Within u of the axis a x
/// n is only rounding error, and 1/m could overflow. There the centre of the cap is equally good.
template <typename S>
[[nodiscard]] Rim<S> rim(const Vector<S>& a, S r, const Vector<S>& n, Mask<S> off) {
  const S u(kUnitRoundoff<S>), zero(0);
  const Vector<S> x = cross<S>(a, n);
  const S m = square_root(dot<S>(x, x));
  const Mask<S> none = off || m <= u;
  const S i = select<S>(none, zero, S(1) / m);
  const S kappa = r * i;
  return {select<S>(off, zero, r * m), scale<S>(cross<S>(x, a), kappa), kappa, scale<S>(x, i)};
}

/// g and a point y of B - A with n.y = g, the nearest point of B - A along n.
template <typename S>
struct Touch {
  S g;
  Vector<S> n;
  Vector<S> y;
};

/// Results for both orientations of a normal, with shared values.
template <typename S>
struct Evaluation {
  Touch<S> plus, minus;  ///< for n and for -n
  Rim<S> a, b;           ///< for n; -n has the opposite v, which makes no difference
  Vector<S> pa;          ///< support point of A for n
};

/// Support of A, for n and -n.
template <typename S>
struct Reach {
  S high, low;        ///< max and min of n.x over A
  Vector<S> at_high;  ///< support point of the maximum
  Vector<S> at_low;
};

/// 9 mul, 12 add, 4 cmp in addition to the rim. Signs and selections of vertices are wires.
template <typename S>
[[nodiscard]] Reach<S> reach(const Pair<S>& pair, const Vector<S>& n, const Rim<S>& rim_a) {
  const S zero(0);
  std::array<S, 3> p;
  std::array<Vector<S>, 3> end;
  for (int i = 0; i < 3; ++i) {
    p[i] = dot<S>(n, pair.reach[i]);
    for (int k = 0; k < 3; ++k) end[i][k] = move_sign(p[i], pair.reach[i][k]);
  }
  if (pair.body == Body::kTriangle) {
    const Vector<S> v0 = Vector<S>::Zero();
    const Mask<S> second = p[0] < p[1], first = zero < max_num(p[0], p[1]);
    const Mask<S> third = p[1] < p[0], last = min_num(p[0], p[1]) < zero;
    return {max_num(zero, max_num(p[0], p[1])), min_num(zero, min_num(p[0], p[1])),
            select<S>(first, select<S>(second, pair.reach[1], pair.reach[0]), v0),
            select<S>(last, select<S>(third, pair.reach[1], pair.reach[0]), v0)};
  }
  const bool box = pair.body == Body::kBox;
  const S high = magnitude(p[0]) + (box ? magnitude(p[1]) + magnitude(p[2]) : rim_a.width);
  const Vector<S> at =
      add<S>(end[0], box ? Vector<S>(add<S>(end[1], end[2])) : Vector<S>(rim_a.side));
  return {high, -high, at, -at};
}

/// One pass through the evaluator; n has unit length. With `off_a` or `off_b` the rim of that
/// cylinder counts as the centre of its cap. This gives the one-sided derivatives of g beside the
/// axis.
template <typename S>
[[nodiscard]] Evaluation<S> evaluate(const Pair<S>& pair, const Vector<S>& n, bool off_a = false,
                                     bool off_b = false) {
  Evaluation<S> e;
  const Vector<S> zero = Vector<S>::Zero();
  if (pair.body == Body::kCylinder) {
    e.a = rim<S>(pair.axis[0], pair.radius, n, off_a);
  } else {
    e.a = {S(0), zero, S(0), zero};
  }
  e.b = rim<S>(pair.b, pair.b_radius, n, off_b);
  const Reach<S> a = reach<S>(pair, n, e.a);
  const S along = dot<S>(pair.b, n);
  const S half = magnitude(along) * pair.b_half + e.b.width;
  Vector<S> pb;
  for (int k = 0; k < 3; ++k) pb[k] = move_sign(along, pair.b_reach[k]);
  pb = add<S>(pb, e.b.side);
  const S centre = dot<S>(pair.d, n);
  e.pa = a.at_high;
  e.plus = {(centre - a.high) - half, n, sub<S>(sub<S>(pair.d, a.at_high), pb)};
  e.minus = {(a.low - centre) - half, -n, add<S>(sub<S>(pair.d, a.at_low), pb)};
  return e;
}

/// n with unit length. NaN, which then loses every comparison, if the square of the vector is near
/// the subnormal numbers. Such a vector could become longer than 1, and g too large. 6 mul, 2 add,
/// 1 div, 1 sqrt, 1 cmp.
template <typename S>
[[nodiscard]] Vector<S> normalise(const Vector<S>& raw) {
  const S square = dot<S>(raw, raw), least(4 * static_cast<double>(std::numeric_limits<S>::min()));
  return scale<S>(raw, select<S>(least <= square, S(1) / square_root(square), canonical_nan<S>()));
}
/// The same, with `other` instead of NaN.
template <typename S>
[[nodiscard]] Vector<S> normalise_or(const Vector<S>& raw, const Vector<S>& other) {
  const S square = dot<S>(raw, raw), least(4 * static_cast<double>(std::numeric_limits<S>::min()));
  return select<S>(least <= square, Vector<S>(scale<S>(raw, S(1) / square_root(square))), other);
}

}  // namespace cde::reference::cylinder
