// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <limits>

#include "cde/geometry/ops.hpp"
#include "cde/reference/pipes/ray_outcome.hpp"

namespace cde::reference {

/// Backward error bound: the result is exact for a cylinder whose radius and half height differ by
/// at most this many u (|o-c| + r + h). It is the worst-case sum of all roundings, to first order,
/// as a distance from the surface. The table is for the nearer root from far away, with W = |o-c|,
/// phi the angle of incidence across the axis, s = sin phi and c = cos phi:
///
///     w                                     W
///     n, as a turn of the ray               (1.155 + 1) W, as |d x a| <= 1.155 |d| term by term
///     m                                     (1.155 + 1) W c
///     B (three products, two sums), B i     (3 + 1) W c
///     C: m.m, the subtraction               (3 + 1) W c
///     C i, the quotient, the sum in q       3 W c; i itself cancels from C i / q
///     e through g and its own sums          4 W s
///
/// The sum is W (3.155 + 13.155 c + 4 s) <= 16.9 W. It is less for the farther root (15.0 W) and
/// the caps (10 W). Sizes r and h have smaller factors, at most 7.7 and 6. That leaves room for an
/// axis whose length is off by 2^-21, 8 u in fp32.
inline constexpr double kRayCylinderBand = 17;

/// A stretch of the ray: lo <= t <= hi, if `there` is set.
template <typename S>
struct RayStretch {
  S lo, hi;
  Mask<S> there;
};

/// The stretch between the planes of the caps, -h <= wz + t dz <= h.
///
///     1      i = 1 / dz                                            1 div
///     1      -h - wz, h - wz                                       2 sub
///     2      s = (-h - wz) i, e = (h - wz) i                       2 mul
///            exchanged if dz has the sign bit
///     2      flat = not |i| < inf; |wz| <= h                       2 cmp
///
/// flat: dz is 0, or so small that its reciprocal overflows. Then either all of the ray is between
/// the planes or none of it.
template <typename S>
[[nodiscard]] RayStretch<S> between_caps(S wz, S dz, S h, Mask<S>& flat) {
  const S inf = std::numeric_limits<S>::infinity();
  const S i = S(1) / dz;
  const S s = (-h - wz) * i, e = (h - wz) * i;
  const Mask<S> down = is_negative(dz);
  flat = !(magnitude(i) < inf);
  return {select(flat, -inf, select(down, e, s)), select(flat, inf, select(down, s, e)),
          !flat || magnitude(wz) <= h};
}

/// Ray against the surface of a solid cylinder with flat caps. T is the smallest t in [tmin, tmax]
/// at which the ray enters or leaves it. The solid lies between the planes of the caps and within
/// the infinite cylinder. The ray's stretches in both are intersected.
///
/// The lateral surface is A t^2 + 2 B t + C = 0 with n = d x a, m = w x a. Its discriminant is r^2
/// A - e^2 with e = w.n. This equals B^2 - AC by Lagrange's identity, without its cancellation. e
/// uses g, which is w without its part along the axis. If the ray runs nearly along the axis, n is
/// small and its rounding error may lie along the axis, where w can be long.
///
///     1      w = o - c                                             3 sub
///     1-2    n = d x a                                             6 mul, 3 sub
///     2-3    m = w x a                                             6 mul, 3 sub
///     1-3    dz = d.a                                              3 mul, 2 add
///     2-4    wz = w.a                                              3 mul, 2 add
///     1      rr = r r                                              1 mul
///     3-5    A = n.n                                               3 mul, 2 add
///     4-6    B = m.n, mm = m.m                                     6 mul, 4 add
///     5-6    g = w - wz a                                          3 mul, 3 sub
///     6      i = 1 / A                                             1 div
///     7-9    e = g.n                                               3 mul, 2 add
///     7      C = mm - rr                                           1 sub
///     7-8    rr i, B i, C i                                        3 mul
///     10-11  (e i) (e i)                                           2 mul
///     12     D = rr i - that                                       1 sub
///     13     root = sqrt(D)                                        1 sqrt
///     14     q = -(B i + root with the sign of B)                  1 add
///     15-16  cq = min(|C i / q|, |q|) with the sign of C i / q     1 div, 1 min/max
///            lo, hi = q, cq; exchanged if B has the sign bit
///     4-6    s, e: the stretch between the caps                    2 mul, 1 div, 2 sub, 2 cmp
///     8-13   r^2 i < inf, 0 <= D, C <= 0                           3 cmp
///     17     enter = max(lo, s), leave = min(hi, e)                2 min/max
///     18     enter <= leave; both against tmin and tmax            5 cmp
///            t = enter if it is in the interval, else leave
///     19-20  CP = o + t d                                          3 mul, 3 add
///     21     the outcome is selected
///
/// 44 mul, 3 div, 1 sqrt, 16 add, 16 sub, 10 cmp, 3 min/max; 21 cycles with one cycle per operator.
/// The equation is first divided by A, so that D, like t^2, is a ratio of products of two lengths.
/// Ranges and the reason for the minimum are as for the sphere.
///
/// If A = 0, or is so small that r^2 / A overflows, the ray runs along the axis. The lateral
/// surface then bounds nothing if C <= 0, and everything otherwise. Testing 1 / A is not enough:
/// (e/A)^2 then overflows as well, and the difference of two infinities would be a miss. In this
/// case r is 2^(bias/2) times |n|, so |n| < u |d| if r is less than 2^38 |d| in fp32,
/// LengthRange::ray_ratio.
template <typename S, bool AtSizeOne = false>
[[nodiscard]] Outcome<S> ray_cylinder(const BasicRay<S>& ray, const BasicCylinder<S>& cylinder) {
  if constexpr (!AtSizeOne) return at_size_one<S>(ray, cylinder, ray_cylinder<S, true>);
  const S zero(0), one(1), inf = std::numeric_limits<S>::infinity();
  const Vector<S>& axis = cylinder.axis;
  const Vector<S> w = sub<S>(ray.o, cylinder.c);
  const Vector<S> n = cross<S>(ray.d, axis), m = cross<S>(w, axis);
  const S rr = cylinder.radius * cylinder.radius;
  const S a = dot<S>(n, n), b = dot<S>(m, n), c = dot<S>(m, m) - rr;
  const S wz = dot<S>(w, axis);
  const S e = dot<S>(sub<S>(w, scale<S>(axis, wz)), n);
  const S i = one / a, ei = e * i;
  const S rri = rr * i;
  const S discriminant = rri - ei * ei;
  const S q = -(b * i + move_sign(b, square_root(discriminant)));
  const S ci = c * i;
  const S cq = move_sign(ci, move_sign(q, min_num(magnitude(ci / q), magnitude(q))));

  const Mask<S> slanted = rri < inf, backwards = is_negative(b);
  const RayStretch<S> lateral{select(slanted, select(backwards, cq, q), -inf),
                              select(slanted, select(backwards, q, cq), inf),
                              (slanted && zero <= discriminant) || (!slanted && c <= zero)};
  Mask<S> flat{};
  const RayStretch<S> slab = between_caps(wz, dot<S>(ray.d, axis), cylinder.half_height, flat);
  const S enter = max_num(lateral.lo, slab.lo), leave = min_num(lateral.hi, slab.hi);
  const Mask<S> meets = lateral.there && slab.there && (slanted || !flat) && enter <= leave;
  const Mask<S> enter_in = in_interval(ray, enter), leave_in = in_interval(ray, leave);
  const S t = select(enter_in, enter, leave);
  return ray_outcome<S>(meets && (enter_in || leave_in), t, point_at(ray, t));
}

}  // namespace cde::reference
