#pragma once
#include "cde/reference/ops.hpp"
#include "cde/reference/ray_outcome.hpp"

/// Ray against triangle, two-sided. Barycentric coordinates are compared unscaled, without a
/// division: a coordinate with the sign of the determinant moved onto it must not be negative.
/// A NaN fails every comparison, so it is a miss.
namespace cde::reference {

/// After Möller and Trumbore, "Fast, Minimum Storage Ray-Triangle Intersection", 1997, as in
/// rtl/pipes/ray_triangle_moller.sv: 27 mul, 1 div, 12 add, 15 sub, 8 cmp. 10 clocks at one an
/// operator.
template <typename S>
[[nodiscard]] Outcome<S> ray_triangle_moller(const BasicRay<S>& ray,
                                             const BasicTriangle<S>& triangle) {
  if (bad(ray) || bad(triangle)) return bad_outcome<S>();
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
  return ray_outcome<S>(inside && in_interval(ray, t), t, point_at(ray, t));
}

/// The same, from vectors.
template <typename S>
[[nodiscard]] Outcome<S> ray_triangle_moller(const Vector<S>& o, const Vector<S>& d, S tmin, S tmax,
                                             const Vector<S>& v0, const Vector<S>& v1,
                                             const Vector<S>& v2) {
  return ray_triangle_moller(BasicRay<S>{o, d, tmin, tmax}, BasicTriangle<S>{v0, v1, v2});
}

}  // namespace cde::reference
