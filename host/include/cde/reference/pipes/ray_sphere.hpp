// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/geometry/ops.hpp"
#include "cde/reference/pipes/ray_outcome.hpp"

namespace cde::reference {

/// Backward error bound: the result is exact for a sphere whose radius differs by at most this many
/// u (|o-c| + r). It is the worst-case sum of all roundings, to first order, as a distance from the
/// surface. The table is for the nearer root from far away, with W = |o-c|, phi the angle of
/// incidence, s = sin phi and c = cos phi:
///
///     f                                     W
///     b (three products, two sums), b i     (3 + 1) W c
///     cc: f.f, the subtraction              (3 + 1) W c
///     cc i, the quotient, the sum in tb     3 W c; i itself cancels from cc i / tb
///     l, by k d, into D                     W s
///
/// The sum is W (1 + 11 c + s) <= 12.1 W; it is less for the farther root (10.1 W). r has the
/// smaller factor of 5.5.
inline constexpr double kRaySphereBand = 13;

/// Ray against the surface of a sphere. T is the smallest root of |o + t d - c| = r in [tmin,
/// tmax], so a ray that starts inside reports its exit.
///
/// The discriminant is r^2 - |l|^2 with l the vector from the centre to the nearest point of the
/// ray's line. Source: Haines et al., "Precision Improvements for Ray/Sphere Intersection", Ray
/// Tracing Gems 2019. By contrast b^2 - ac would lose all its digits if the ray starts many radii
/// away.
///
///     1      f = o - c                                             3 sub
///     1-3    a = d.d                                               3 mul, 2 add
///     2-4    b = -(f.d), ff = f.f                                  6 mul, 4 add
///     1      rr = r r                                              1 mul
///     4      i = 1 / a                                             1 div
///     5      k = b i                                               1 mul
///     6-7    l = f + k d                                           3 mul, 3 add
///     8-10   ll = l.l                                              3 mul, 2 add
///     5      cc = ff - rr                                          1 sub
///     11     D = rr - ll                                           1 sub
///     6      ci = cc i                                             1 mul
///     12     D i                                                   1 mul
///     12     0 <= D                                                1 cmp
///     13     root = sqrt(D i)                                      1 sqrt
///     14     tb = k + root with the sign of b                      1 add
///     15-16  ta = min(|ci / tb|, |tb|) with the sign of ci / tb    1 div, 1 min/max
///            near, far = ta, tb; exchanged if b has the sign bit
///     17     tmin <= near, near <= tmax, tmin <= far, far <= tmax  4 cmp
///            t = near if it is in the interval, else far
///     18-19  CP = o + t d                                          3 mul, 3 add
///     20     the outcome is selected
///
/// 22 mul, 2 div, 1 sqrt, 15 add, 5 sub, 5 cmp, 1 min/max; 20 cycles with one cycle per operator.
/// The root farther from the origin is tb, the nearer one ta, so |ta| <= |tb|. For a tangent that
/// starts at the surface both ci and tb are only rounding error, and their quotient is arbitrary.
/// The minimum bounds it by tb. Only products of two lengths, ratios of those, and squares of t
/// occur. So |d|, |o-c|, r and their ratios may be anything whose square is a normal number.
template <typename S, bool AtSizeOne = false>
[[nodiscard]] Outcome<S> ray_sphere(const BasicRay<S>& ray, const BasicSphere<S>& sphere) {
  if constexpr (!AtSizeOne) return at_size_one<S>(ray, sphere, ray_sphere<S, true>);
  const S zero(0), one(1);
  const Vector<S> f = sub<S>(ray.o, sphere.c);
  const S a = dot<S>(ray.d, ray.d), b = -dot<S>(f, ray.d), rr = sphere.r * sphere.r;
  const S i = one / a;
  const S k = b * i;
  const Vector<S> l = add<S>(f, scale<S>(ray.d, k));
  const S discriminant = rr - dot<S>(l, l), cc = dot<S>(f, f) - rr;
  const S tb = k + move_sign(b, square_root(discriminant * i));
  const S cci = cc * i;
  const S ta = move_sign(cci, move_sign(tb, min_num(magnitude(cci / tb), magnitude(tb))));
  const Mask<S> backwards = is_negative(b);
  const S near = select(backwards, tb, ta), far = select(backwards, ta, tb);
  const Mask<S> near_in = in_interval(ray, near), far_in = in_interval(ray, far);
  const S t = select(near_in, near, far);
  return ray_outcome<S>(zero <= discriminant && (near_in || far_in), t, point_at(ray, t));
}

}  // namespace cde::reference
