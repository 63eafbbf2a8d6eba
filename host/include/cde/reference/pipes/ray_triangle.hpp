// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/contract/pairs.hpp"
#include "cde/geometry/ops.hpp"
#include "cde/reference/pipes/ray_box.hpp"
#include "cde/reference/pipes/ray_outcome.hpp"
#include "cde/support/error.hpp"

/// @file
/// Ray against triangle, two-sided, by four algorithms. The three barycentric coordinates are
/// compared unscaled, without division. The sign of the determinant is moved onto each, and none
/// may then be negative. A NaN fails every comparison, so it is a miss.
///
/// With Box a hit must also lie in the triangle's box (ray_box.hpp), and a triangle without area is
/// never hit. Without Box a ray in the plane of a triangle, or within rounding of it, may hit
/// anywhere in that plane. The operators of the box rule, stated in ray_box.hpp, add to those
/// stated here.
///
/// u is the unit roundoff, E1 = V1-V0, E2 = V2-V0, N = E1 x E2 the normal, cos = |N.D| / (|N| |D|),
/// L the largest |coordinate| of o and the vertices. Each algorithm decides correctly if the ray
/// hits the triangle's plane farther from all three edge lines than its band. The bands are checked
/// against exact arithmetic by tests/numerics/ray_pairs_test.cpp.
namespace cde::reference {

/// Whether p = o + t d is in the triangle's box; always true without Box.
template <bool Box, typename S>
[[nodiscard]] Mask<S> follows_rule(const BasicTriangle<S>& triangle, const Vector<S>& td,
                                   const Vector<S>& p) {
  if constexpr (Box) return in_box(triangle_bounds(triangle), td, p);
  return Mask<S>(true);
}

/// Möller and Trumbore, "Fast, Minimum Storage Ray-Triangle Intersection", 1997. RTL:
/// rtl/pipes/ray_triangle_moller.sv.
/// 27 mul, 1 div, 12 add, 15 sub, 8 cmp; 10 cycles with one cycle per operator.
template <typename S, bool Box = false, bool AtSizeOne = false>
[[nodiscard]] Outcome<S> ray_triangle_moller(const BasicRay<S>& ray,
                                             const BasicTriangle<S>& triangle) {
  if constexpr (!AtSizeOne) return at_size_one<S>(ray, triangle, ray_triangle_moller<S, Box, true>);
  const Vector<S> e1 = sub<S>(triangle.v1, triangle.v0), e2 = sub<S>(triangle.v2, triangle.v0),
                  tv = sub<S>(ray.o, triangle.v0);
  const Vector<S> p = cross<S>(ray.d, e2), q = cross<S>(tv, e1);
  const S det = dot<S>(p, e1), u = dot<S>(p, tv), v = dot<S>(q, ray.d), tn = dot<S>(q, e2);
  const S uv = u + v;
  const S size = magnitude(det), zero(0);
  const S us = move_sign(det, u), vs = move_sign(det, v), uvs = move_sign(det, uv);
  const Mask<S> inside =
      zero <= us && us <= size && zero <= vs && vs <= size && uvs <= size && zero < size;
  const S t = tn / det;
  const Vector<S> td = scale<S>(ray.d, t), cp = add<S>(ray.o, td);
  return ray_outcome<S>(inside && in_interval(ray, t) && follows_rule<Box, S>(triangle, td, cp), t,
                        cp);
}

/// The same with the operands as vectors.
template <typename S>
[[nodiscard]] Outcome<S> ray_triangle_moller(const Vector<S>& o, const Vector<S>& d, S tmin, S tmax,
                                             const Vector<S>& v0, const Vector<S>& v1,
                                             const Vector<S>& v2) {
  return ray_triangle_moller<S>(BasicRay<S>{o, d, tmin, tmax}, BasicTriangle<S>{v0, v1, v2});
}

/// The component of a vector that is largest by magnitude (ties: the lowest index), as two masks,
/// and the components in cyclic order from it. Selections are wires.
template <typename S>
struct DominantAxis {
  Mask<S> y_over_x, z_over_both;

  /// 2 cmp in sequence.
  explicit DominantAxis(const Vector<S>& v)
      : y_over_x(magnitude(v.x()) < magnitude(v.y())),
        z_over_both(select(y_over_x, magnitude(v.y()), magnitude(v.x())) < magnitude(v.z())) {}

  [[nodiscard]] S pick(S if_x, S if_y, S if_z) const {
    return select(z_over_both, if_z, select(y_over_x, if_y, if_x));
  }
  [[nodiscard]] S largest(const Vector<S>& v) const { return pick(v.x(), v.y(), v.z()); }
  [[nodiscard]] S next(const Vector<S>& v) const { return pick(v.y(), v.z(), v.x()); }
  [[nodiscard]] S after_next(const Vector<S>& v) const { return pick(v.z(), v.x(), v.y()); }
};

/// Whether no coordinate has the opposite sign of det, and det is not 0. 4 cmp.
template <typename S>
[[nodiscard]] Mask<S> same_side(S det, S u, S v, S w) {
  const S zero(0);
  return zero <= move_sign(det, u) && zero <= move_sign(det, v) && zero <= move_sign(det, w) &&
         zero < magnitude(det);
}

/// Badouel and Pluecker compute with world positions, so their error grows with the distance of the
/// scene from the world's origin. Moeller and watertight compute relative to the ray's origin.
///
/// Band of Badouel, in u (L + slim / 4) / cos, and bound of T |D|, in u (L + slim) / cos. Here slim
/// is |E1| |E2| (|E1| + |E2|) / |N|: some edge lengths for a regular triangle and more for a
/// needle.
inline constexpr double kBadouelBand = 8, kBadouelDepth = 8;

/// Badouel, "An Efficient Ray-Polygon Intersection", Graphics Gems 1990, in the paper's equations
/// (1) and (2). First the plane is intersected, then two coordinates in the plane's dominant
/// projection are tested.
///
///     1      E1 = V1-V0, E2 = V2-V0                                6 sub
///     2-3    N = E1 x E2                                           6 mul, 3 sub
///     4-6    w = N.V0, s = N.O, nd = N.D                           9 mul, 6 add
///     4-5    k = argmax |N|, i = k+1, j = k+2 (cyclic)             2 cmp
///     7      w - s                                                 1 sub
///     8      t = (w - s) / nd                                      1 div
///     9-10   P = O + t D                                           3 mul, 3 add
///     9      tmin <= t, t <= tmax, 0 < |nd|                        3 cmp
///     11     g = P_i - V0_i, h = P_j - V0_j                        2 sub
///     12-13  alpha = g E2_j - h E2_i, beta = h E1_i - g E1_j       4 mul, 2 sub
///     14     alpha + beta                                          1 add
///     15     0 <= alpha, 0 <= beta, alpha + beta <= |N_k|          3 cmp
///     16     the outcome is selected
///
/// 22 mul, 1 div, 10 add, 14 sub, 8 cmp; 16 cycles with one cycle per operator. The paper's Table 2
/// has 27 mul, 2 div, 13 add, 23 sub, 6 cmp, and Table 1 the same 16 cycles. Here alpha and beta
/// are compared with N_k instead of divided by it. That saves the second divider and rounds less.
/// The paper does not explain its other operators. Two more comparators test the interval.
template <typename S, bool Box = false, bool AtSizeOne = false>
[[nodiscard]] Outcome<S> ray_triangle_badouel(const BasicRay<S>& ray,
                                              const BasicTriangle<S>& triangle) {
  if constexpr (!AtSizeOne)
    return at_size_one<S>(ray, triangle, ray_triangle_badouel<S, Box, true>);
  const Vector<S> e1 = sub<S>(triangle.v1, triangle.v0), e2 = sub<S>(triangle.v2, triangle.v0);
  const Vector<S> normal = cross<S>(e1, e2);
  const DominantAxis<S> axis(normal);
  const S w = dot<S>(normal, triangle.v0), s = dot<S>(normal, ray.o), nd = dot<S>(normal, ray.d);
  const S t = (w - s) / nd;
  const Vector<S> td = scale<S>(ray.d, t), p = add<S>(ray.o, td);
  const S g = axis.next(p) - axis.next(triangle.v0);
  const S h = axis.after_next(p) - axis.after_next(triangle.v0);
  const S alpha = g * axis.after_next(e2) - h * axis.next(e2);
  const S beta = h * axis.next(e1) - g * axis.after_next(e1);
  const S sum = alpha + beta, nk = axis.largest(normal), zero(0);
  const Mask<S> inside = zero <= move_sign(nk, alpha) && zero <= move_sign(nk, beta) &&
                         move_sign(nk, sum) <= magnitude(nk) && zero < magnitude(nd);
  return ray_outcome<S>(inside && in_interval(ray, t) && follows_rule<Box, S>(triangle, td, p), t,
                        p);
}

/// Band of Pluecker, in u L / cos, and bound of T |D|, in that times 1 + T |D| (sum of the edge
/// lengths) / |N|.
inline constexpr double kPlueckerBand = 8, kPlueckerDepth = 8;

/// Pluecker coordinates, the paper's equations (4) to (6). A line through x along l is {l : l x x}.
/// The inner product of two lines tells on which side they pass each other.
///
///     1      p01 = V1-V0, p12 = V2-V1, p20 = V0-V2, s = O-V0       12 sub
///     1-2    qr = D x O                                            6 mul, 3 sub
///     2-3    q01 = p01 x V0, q12 = p12 x V1, q20 = p20 x V2        18 mul, 9 sub
///     2-3    N = p20 x p01                                         6 mul, 3 sub
///     4-7    w_ij = D.q_ij + qr.p_ij                               18 mul, 15 add
///     4-6    N.s                                                   3 mul, 2 add
///     8-9    W = (w01 + w12) + w20                                 2 add
///     10     t = (N.s) / W                                         1 div
///     10     0 <= each w_ij with the sign of W, 0 < |W|            4 cmp
///     11     tmin <= t, t <= tmax                                  2 cmp
///     11-12  CP = O + t D                                          3 mul, 3 add
///     13     the outcome is selected
///
/// 54 mul, 1 div, 22 add, 27 sub, 6 cmp; 13 cycles with one cycle per operator. The paper's Table 2
/// has 54 mul, 1 div, 31 add, 17 sub, 3 cmp: 48 additions and subtractions instead of 49, without
/// the interval and det = 0. Table 1 has 17 cycles. Moments relative to the world's origin make
/// this the least accurate of the four.
///
/// With Box t = -(N.s) / (N.D). W equals -(N.D) except for cancellation among its three products.
/// Far from a small triangle that would move the point out of its box. 3 mul, 2 add more.
template <typename S, bool Box = false, bool AtSizeOne = false>
[[nodiscard]] Outcome<S> ray_triangle_pluecker(const BasicRay<S>& ray,
                                               const BasicTriangle<S>& triangle) {
  if constexpr (!AtSizeOne)
    return at_size_one<S>(ray, triangle, ray_triangle_pluecker<S, Box, true>);
  const Vector<S>&v0 = triangle.v0, &v1 = triangle.v1, &v2 = triangle.v2;
  const Vector<S> qr = cross<S>(ray.d, ray.o);
  const Vector<S> p01 = sub<S>(v1, v0), p12 = sub<S>(v2, v1), p20 = sub<S>(v0, v2);
  const auto product = [&](const Vector<S>& p, const Vector<S>& on) {
    return dot<S>(ray.d, cross<S>(p, on)) + dot<S>(qr, p);
  };
  const S w01 = product(p01, v0), w12 = product(p12, v1), w20 = product(p20, v2);
  const S sum = (w01 + w12) + w20;
  const Vector<S> normal = cross<S>(p20, p01);
  const S distance = dot<S>(normal, sub<S>(ray.o, v0));
  const S t = Box ? -distance / dot<S>(normal, ray.d) : distance / sum;
  const Vector<S> td = scale<S>(ray.d, t), cp = add<S>(ray.o, td);
  const Mask<S> inside = same_side(sum, w01, w12, w20);
  return ray_outcome<S>(inside && in_interval(ray, t) && follows_rule<Box, S>(triangle, td, cp), t,
                        cp);
}

/// Band of watertight, in u max|v-o| / cos, and bound of T |D|, in that times 1 + (longest edge)^2
/// / |N|. F stays sharp on needles, T does not.
inline constexpr double kWatertightBand = 2, kWatertightDepth = 8;

/// Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2013, for fp32. Space is
/// sheared so that the ray runs along its dominant axis, and the edge functions are evaluated in
/// the plane across it. Exchanging two vertices only flips the sign of an edge function, so both
/// triangles at an edge see the ray on the same side. U, V and W must never use an FMA.
///
///     1      A = V0-O, B = V1-O, C = V2-O                          9 sub
///     1-2    kz = argmax |D|, kx = kz+1, ky = kz+2 (cyclic)        2 cmp
///     3      Sz = 1 / D_kz                                         1 div
///     4      Sx = D_kx Sz, Sy = D_ky Sz                            2 mul
///     5-6    Ax = A_kx - Sx A_kz, Ay = A_ky - Sy A_kz, B, C        6 mul, 6 sub
///     7-8    U = Cx By - Cy Bx, V = Ax Cy - Ay Cx, W = Bx Ay - By Ax   6 mul, 3 sub
///     9-10   det = (U + V) + W                                     2 add
///     9-11   Z = (U A_kz + V B_kz) + W C_kz                        3 mul, 2 add
///     11     0 <= U, V, W with the sign of det, 0 < |det|          4 cmp
///     12-13  t = (Z / det) Sz                                      1 div, 1 mul
///     14     tmin <= t, t <= tmax                                  2 cmp
///     11     i = 1 / det                                           1 div
///     12     b0 = U i, b1 = V i, b2 = W i                          3 mul
///     13-15  b0 A + b1 B + b2 C                                    9 mul, 6 add
///     16     CP = O + that                                         3 add
///     17     the outcome is selected
///
/// 30 mul, 3 div, 13 add, 18 sub, 8 cmp; 17 cycles with one cycle per operator. The first four
/// steps need only the ray. The original multiplies A_kz, B_kz and C_kz by Sz. Here Sz is applied
/// last, so only lengths are multiplied before it, and no product overflows where no other pair's
/// does. det = 0 is a miss. Without Box, rounding may report a hit for a triangle that is seen
/// edge-on or has no area.
///
/// The original exchanges kx and ky for D_kz < 0 to reverse the winding. A two-sided test does not
/// need that. With Box the point of the rule is o + t D: 3 mul and 3 add more. Neither 1 / D_kz nor
/// 1 / det may overflow: |D| and the triangle's projected area must be above 2^-126.
template <typename S, bool Box = false, bool AtSizeOne = false>
[[nodiscard]] Outcome<S> ray_triangle_watertight(const BasicRay<S>& ray,
                                                 const BasicTriangle<S>& triangle) {
  if constexpr (!AtSizeOne)
    return at_size_one<S>(ray, triangle, ray_triangle_watertight<S, Box, true>);
  const Vector<S> a = sub<S>(triangle.v0, ray.o), b = sub<S>(triangle.v1, ray.o),
                  c = sub<S>(triangle.v2, ray.o);
  const DominantAxis<S> axis(ray.d);
  const S one(1);
  const S sz = one / axis.largest(ray.d);
  const S sx = axis.next(ray.d) * sz, sy = axis.after_next(ray.d) * sz;
  const auto shear = [&](const Vector<S>& p) -> Vector<S> {
    const S along = axis.largest(p);
    return {axis.next(p) - sx * along, axis.after_next(p) - sy * along, along};
  };
  const Vector<S> as = shear(a), bs = shear(b), cs = shear(c);
  const S u = cs.x() * bs.y() - cs.y() * bs.x();
  const S v = as.x() * cs.y() - as.y() * cs.x();
  const S w = bs.x() * as.y() - bs.y() * as.x();
  const S det = (u + v) + w;
  const S t = (((u * as.z() + v * bs.z()) + w * cs.z()) / det) * sz;
  const S i = one / det;
  const Vector<S> weights = scale<S>({u, v, w}, i);
  const Vector<S> hit{dot<S>(weights, {a.x(), b.x(), c.x()}),
                      dot<S>(weights, {a.y(), b.y(), c.y()}),
                      dot<S>(weights, {a.z(), b.z(), c.z()})};
  Mask<S> met = same_side(det, u, v, w) && in_interval(ray, t);
  if constexpr (Box) {
    const Vector<S> td = scale<S>(ray.d, t);
    met = met && follows_rule<Box, S>(triangle, td, add<S>(ray.o, td));
  }
  return ray_outcome<S>(met, t, add<S>(ray.o, hit));
}

/// Calls use(test), where test(ray, triangle) is the algorithm's reference, with or without the box
/// rule. Every test has its own type, so a loop over it can inline it.
template <class S, class Use>
auto with_ray_triangle(Algorithm algorithm, bool box, Use use) {
// NOLINTNEXTLINE(bugprone-macro-parentheses): a template's name
#define CDE_RAY(FUNCTION)                                                       \
  box ? use([](const BasicRay<S>& r, const BasicTriangle<S>& t) -> Outcome<S> { \
    return FUNCTION<S, true>(r, t);                                             \
  })                                                                            \
      : use([](const BasicRay<S>& r, const BasicTriangle<S>& t) -> Outcome<S> { \
          return FUNCTION<S, false>(r, t);                                      \
        })
  switch (algorithm) {
    case Algorithm::kMoller:
      return CDE_RAY(ray_triangle_moller);
    case Algorithm::kBadouel:
      return CDE_RAY(ray_triangle_badouel);
    case Algorithm::kPluecker:
      return CDE_RAY(ray_triangle_pluecker);
    case Algorithm::kWatertight:
      return CDE_RAY(ray_triangle_watertight);
  }
#undef CDE_RAY
  throw Error(ErrorCode::kUsage, "there is no such algorithm of ray-triangle");
}

template <class S>
using RayTriangleTest = Outcome<S> (*)(const BasicRay<S>&, const BasicTriangle<S>&);

/// The same as a function pointer.
template <class S>
[[nodiscard]] RayTriangleTest<S> ray_triangle_test(Algorithm algorithm, bool box) {
  return with_ray_triangle<S>(algorithm, box, [](auto test) -> RayTriangleTest<S> { return test; });
}

}  // namespace cde::reference
