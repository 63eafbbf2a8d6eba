// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/reference/pipes/convex/candidate_axes.hpp"
#include "cde/reference/pipes/convex/closest_point.hpp"
#include "cde/reference/pipes/convex/frame.hpp"
#include "cde/reference/pipes/scale.hpp"

namespace cde::reference {
namespace convex {

/// Sphere against oriented box, in the box's frame: p = U^T (cs - cb), q = p clamped to the box.
/// Outside, the distance is |p - q|. Its direction is exact if p is beyond a face, since the other
/// components are zero. Inside, or so near the surface that |p - q|² is subnormal, the nearest face
/// counts; ties go to the lowest axis. 36 add 37 mul 1 div 1 sqrt.
template <typename S>
[[nodiscard]] Outcome<S> sphere_obb(const BasicSphere<S>& a, const BasicObb<S>& b) {
  const Vector<S> p = to_local<S>(b.rotation, sub<S>(a.c, b.c));
  const Vector<S> q = clamp_to_box<S>(p, b.half);
  const Vector<S> v = sub<S>(p, q);
  const S dd = dot<S>(v, v);
  const auto outside = usable(dd);
  const S d = square_root(dd);

  // From the face to the sphere's centre, per axis; the face with the least depth counts.
  const Vector<S> depth(b.half.x() - magnitude(p.x()), b.half.y() - magnitude(p.y()),
                        b.half.z() - magnitude(p.z()));
  const auto face = least3(depth.x(), depth.y(), depth.z());
  const S zero{0}, one{1};
  const Vector<S> face_n = select3<S>(
      face.first, face.second, Vector<S>(move_sign(p.x(), one), zero, zero),
      Vector<S>(zero, move_sign(p.y(), one), zero), Vector<S>(zero, zero, move_sign(p.z(), one)));
  const Vector<S> on_face = corner<S>(p, b.half);
  const Vector<S> face_q =
      select3<S>(face.first, face.second, Vector<S>(on_face.x(), p.y(), p.z()),
                 Vector<S>(p.x(), on_face.y(), p.z()), Vector<S>(p.x(), p.y(), on_face.z()));

  // The normal out of the box; the result's normal is its opposite. CP = pB + (s / 2) n.
  const S s = select(outside, d, -face.value) - a.r;
  const Vector<S> n = select<S>(outside, unit<S>(v, d), face_n);
  const Vector<S> local = add<S>(select<S>(outside, q, face_q), scale<S>(n, s * kHalf<S>));
  return outcome<S>(s, add<S>(b.c, to_world<S>(b.rotation, local)), -to_world<S>(b.rotation, n));
}

}  // namespace convex

/// Sphere A against OBB B; see convex::sphere_obb.
template <typename S>
[[nodiscard]] Outcome<S> sphere_obb(const BasicSphere<S>& a, const BasicObb<S>& b) {
  return at_size_one<S>(a, b,
                        [](const auto& x, const auto& y) { return convex::sphere_obb(x, y); });
}

}  // namespace cde::reference
