// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "cde/geometry/check.hpp"
#include "cde/geometry/ops.hpp"
#include "cde/geometry/primitives.hpp"
#include "cde/reference/pipes/convex/facets.hpp"
#include "cde/reference/pipes/convex/frame.hpp"
#include "cde/reference/pipes/scale.hpp"

/// Certain hit, certain miss, uncertain (docs/verdicts.md). A pipe of a narrow format proposes a
/// normal and a point; what decides is a short sum in the wide format, whose rounding is bounded
/// without knowing anything of the pipe: a plane that separates the bodies is a proof of a miss, a
/// point inside both a proof of a hit, wherever they come from. No card has it.
namespace cde::cli::verdict {

using namespace cde::reference;  // the operators

enum class Certain : std::uint8_t { kNeither, kMiss, kHit };

/// Rounding of a gap, and of how deep a point is inside a body, as a share of S: the sums below
/// have at most 9.2 u S and 30 u S, and axes of length one and at right angles may be off by
/// kUnitTolerance = 16 u each.
template <typename S>
inline constexpr double kGap = 2 * kUnitTolerance<S>;
template <typename S>
inline constexpr double kDepth = 4 * kUnitTolerance<S>;

/// The point that a shape's words are taken relative to: its centre, or a corner.
template <typename S>
Vector<S> origin(const BasicSphere<S>& x) {
  return x.c;
}
template <typename S>
Vector<S> origin(const BasicObb<S>& x) {
  return x.c;
}
template <typename S>
Vector<S> origin(const BasicCylinder<S>& x) {
  return x.c;
}
template <typename S>
Vector<S> origin(const BasicTriangle<S>& x) {
  return x.v0;
}
template <typename S>
Vector<S> origin(const BasicAabb<S>& x) {
  return x.min;
}

/// |x| + |y| + |z|
template <typename S>
S sum_of_sizes(const Vector<S>& v) {
  return (magnitude(v.x()) + magnitude(v.y())) + magnitude(v.z());
}

/// A bound of |x - origin| over the shape: its part of S.
template <typename S>
S reach(const BasicSphere<S>& x) {
  return x.r;
}
template <typename S>
S reach(const BasicObb<S>& x) {
  return (x.half.x() + x.half.y()) + x.half.z();
}
template <typename S>
S reach(const BasicCylinder<S>& x) {
  return x.half_height + x.radius;
}
template <typename S>
S reach(const BasicTriangle<S>& x) {
  return sum_of_sizes<S>(sub<S>(x.v1, x.v0)) + sum_of_sizes<S>(sub<S>(x.v2, x.v0));
}
template <typename S>
S reach(const BasicAabb<S>& x) {
  return sum_of_sizes<S>(sub<S>(x.max, x.min));
}

/// max n.(x - origin) over the shape; `nn` is n.n, near one, and |n| <= (1 + nn) / 2.
template <typename S>
S support(const BasicSphere<S>& x, const Vector<S>&, S nn) {
  return x.r * ((nn + S(1)) * convex::kHalf<S>);
}
template <typename S>
S support(const BasicObb<S>& x, const Vector<S>& n, S) {
  const Vector<S> m = convex::to_local<S>(x.rotation, n);
  return dot<S>(x.half, Vector<S>(magnitude(m.x()), magnitude(m.y()), magnitude(m.z())));
}
template <typename S>
S support(const BasicCylinder<S>& x, const Vector<S>& n, S) {
  const Vector<S> across = cross<S>(x.axis, n);
  return x.half_height * magnitude(dot<S>(x.axis, n)) +
         x.radius * square_root(dot<S>(across, across));
}
template <typename S>
S support(const BasicTriangle<S>& x, const Vector<S>& n, S) {
  return max_num(max_num(dot<S>(n, sub<S>(x.v1, x.v0)), dot<S>(n, sub<S>(x.v2, x.v0))), S(0));
}
template <typename S>
S support(const BasicAabb<S>& x, const Vector<S>& n, S) {
  const Vector<S> size = sub<S>(x.max, x.min);
  return dot<S>(size, Vector<S>(max_num(n.x(), S(0)), max_num(n.y(), S(0)), max_num(n.z(), S(0))));
}

/// p, relative to the origin, is inside by `margin` or more. No point is inside a triangle; those
/// that `on_triangle` makes are on it.
template <typename S>
bool inside(const BasicSphere<S>& x, const Vector<S>& p, S margin) {
  const S r = x.r - margin;
  return S(0) < r && dot<S>(p, p) <= r * r;
}
template <typename S>
bool inside(const BasicObb<S>& x, const Vector<S>& p, S margin) {
  const Vector<S> q = convex::to_local<S>(x.rotation, p);
  return magnitude(q.x()) <= x.half.x() - margin && magnitude(q.y()) <= x.half.y() - margin &&
         magnitude(q.z()) <= x.half.z() - margin;
}
template <typename S>
bool inside(const BasicCylinder<S>& x, const Vector<S>& p, S margin) {
  const S r = x.radius - margin;
  const Vector<S> across = cross<S>(x.axis, p);
  return magnitude(dot<S>(x.axis, p)) <= x.half_height - margin && S(0) < r &&
         dot<S>(across, across) <= r * r;
}
template <typename S>
bool inside(const BasicAabb<S>& x, const Vector<S>& p, S margin) {
  const Vector<S> size = sub<S>(x.max, x.min);
  const auto within = [margin](S at, S end) { return margin <= at && at <= end - margin; };
  return within(p.x(), size.x()) && within(p.y(), size.y()) && within(p.z(), size.z());
}

/// What a narrow pipe claims of a pair, in the wide format and relative to A's origin. Of a
/// triangle the point is v0 + weight[0] (v1 - v0) + weight[1] (v2 - v0).
template <typename S>
struct Proposal {
  Vector<S> n = Vector<S>::Zero();
  Vector<S> point = Vector<S>::Zero();
  S weight[2] = {S(0), S(0)};
};

template <class A, class B, typename S = typename A::Scalar>
S size_of_pair(const A& a, const B& b) {
  return (reach(a) + reach(b)) + sum_of_sizes<S>(sub<S>(origin(b), origin(a)));
}

/// What is certain of A and B whatever the proposal is.
template <class A, class B, typename S = typename A::Scalar>
Certain judge(const A& a, const B& b, const Proposal<S>& claim) {
  const S size = size_of_pair(a, b);
  const Vector<S> between = sub<S>(origin(b), origin(a)), n = claim.n;
  const S nn = dot<S>(n, n);
  const S gap = dot<S>(n, between) - (support(a, n, nn) + support(b, Vector<S>(-n), nn));
  // A normal that is far from length one would make the terms larger than S.
  if (nn <= S(1.25) && size * S(kGap<S>) < gap) return Certain::kMiss;

  const S margin = size * S(kDepth<S>);
  bool hit = false;
  if constexpr (kShapeOf<A> == Shape::kTriangle) {
    const S i = claim.weight[0], j = claim.weight[1];
    const Vector<S> p =
        add<S>(scale<S>(sub<S>(a.v1, a.v0), i), scale<S>(sub<S>(a.v2, a.v0), j));
    hit = S(0) <= i && S(0) <= j && i + j <= S(1) && inside(b, sub<S>(p, between), margin);
  } else {
    hit = inside(a, claim.point, margin) && inside(b, sub<S>(claim.point, between), margin);
  }
  return hit ? Certain::kHit : Certain::kNeither;
}

}  // namespace cde::cli::verdict
