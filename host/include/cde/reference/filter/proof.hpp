// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "cde/geometry/check.hpp"
#include "cde/geometry/ops.hpp"
#include "cde/geometry/primitives.hpp"
#include "cde/reference/pipes/convex/candidate_axes.hpp"
#include "cde/reference/pipes/convex/frame.hpp"
#include "cde/reference/pipes/scale.hpp"

/// @file
/// The certified filter: certain hit, certain miss, or uncertain
/// (docs/background/certified_filters.md). A pipe of a narrow format proposes a normal and a point.
/// A short sum in the wide format decides; its rounding is bounded without any knowledge of the
/// pipe. A plane that separates the bodies proves a miss, and a point inside both proves a hit,
/// whatever proposed them. `rtl/filter/` implements the proof of a miss (`BoardConfig::filter`).
namespace cde::reference::filter {

enum class Certain : std::uint8_t { kNeither, kMiss, kHit };

/// Rounding bounds of the signed distance along a normal, and of the depth of a point inside a
/// body, as a share of S. The sums below have at most 9.2 u S and 30 u S. Axes may deviate from
/// unit length and right angles by kUnitTolerance = 16 u each.
template <typename S>
inline constexpr double kDistance = 2 * kUnitTolerance<S>;
template <typename S>
inline constexpr double kDepth = 4 * kUnitTolerance<S>;

/// A shape relative to its origin, which is its centre or a corner. Corners of a triangle or AABB
/// are stored relative to the origin, in the places of their words.
template <class P>
struct Body {
  using S = typename P::Scalar;
  Vector<S> origin;
  P shape;

  explicit Body(const P& x) : shape(x) {
    if constexpr (kShapeOf<P> == Shape::kTriangle) {
      origin = x.v0;
      shape.v1 = sub<S>(x.v1, x.v0);
      shape.v2 = sub<S>(x.v2, x.v0);
    } else if constexpr (kShapeOf<P> == Shape::kAabb) {
      origin = x.min;
      shape.max = sub<S>(x.max, x.min);
    } else {
      origin = x.c;
    }
  }
};

/// |x| + |y| + |z|
template <typename S>
S sum_of_sizes(const Vector<S>& v) {
  return (magnitude(v.x()) + magnitude(v.y())) + magnitude(v.z());
}

/// A bound of |x - origin| over the body: its part of S. The functions below take the shape of a
/// Body.
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
  return sum_of_sizes<S>(x.v1) + sum_of_sizes<S>(x.v2);
}
template <typename S>
S reach(const BasicAabb<S>& x) {
  return sum_of_sizes<S>(x.max);
}

/// max n.(x - origin) over the body; `nn` is n.n, and |n| <= (1 + nn) / 2.
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
  return max_num(max_num(dot<S>(n, x.v1), dot<S>(n, x.v2)), S(0));
}
template <typename S>
S support(const BasicAabb<S>& x, const Vector<S>& n, S) {
  return dot<S>(x.max, Vector<S>(max_num(n.x(), S(0)), max_num(n.y(), S(0)), max_num(n.z(), S(0))));
}

/// Whether p, relative to the origin, is inside by `margin` or more.
template <typename S>
Mask<S> inside(const BasicSphere<S>& x, const Vector<S>& p, S margin) {
  const S r = x.r - margin;
  return S(0) < r && dot<S>(p, p) <= r * r;
}
template <typename S>
Mask<S> inside(const BasicObb<S>& x, const Vector<S>& p, S margin) {
  const Vector<S> q = convex::to_local<S>(x.rotation, p);
  return magnitude(q.x()) <= x.half.x() - margin && magnitude(q.y()) <= x.half.y() - margin &&
         magnitude(q.z()) <= x.half.z() - margin;
}
template <typename S>
Mask<S> inside(const BasicCylinder<S>& x, const Vector<S>& p, S margin) {
  const S r = x.radius - margin;
  const Vector<S> across = cross<S>(x.axis, p);
  return magnitude(dot<S>(x.axis, p)) <= x.half_height - margin && S(0) < r &&
         dot<S>(across, across) <= r * r;
}
template <typename S>
Mask<S> inside(const BasicAabb<S>& x, const Vector<S>& p, S margin) {
  const auto within = [margin](S at, S end) { return margin <= at && at <= end - margin; };
  return within(p.x(), x.max.x()) && within(p.y(), x.max.y()) && within(p.z(), x.max.z());
}

/// Claim of a narrow pipe about a pair, in the wide format and relative to A's origin. A triangle
/// has no inside; its point v0 + weight[0] (v1 - v0) + weight[1] (v2 - v0) lies on it.
template <typename S>
struct Proposal {
  Vector<S> n = Vector<S>::Zero();
  Vector<S> point = Vector<S>::Zero();
  std::array<S, 2> weight{S(0), S(0)};
};

template <class A, class B, typename S = typename A::Scalar>
S size_of_pair(const Body<A>& a, const Body<B>& b) {
  return (reach(a.shape) + reach(b.shape)) + sum_of_sizes<S>(sub<S>(b.origin, a.origin));
}

/// n.(oB - oA) - h_A(n) - h_B(-n)
template <class A, class B, typename S = typename A::Scalar>
S distance_along(const Body<A>& a, const Body<B>& b, const Vector<S>& n, S nn) {
  return dot<S>(n, sub<S>(b.origin, a.origin)) -
         (support(a.shape, n, nn) + support(b.shape, Vector<S>(-n), nn));
}

/// Proof that the proposed point is in both bodies.
template <class A, class B, typename S = typename A::Scalar>
Mask<S> both_have(const Body<A>& a, const Body<B>& b, const Proposal<S>& claim, S margin) {
  const Vector<S> between = sub<S>(b.origin, a.origin);
  if constexpr (kShapeOf<A> == Shape::kTriangle) {
    const auto [i, j] = claim.weight;
    const Vector<S> p = add<S>(scale<S>(a.shape.v1, i), scale<S>(a.shape.v2, j));
    return S(0) <= i && S(0) <= j && i + j <= S(1) && inside(b.shape, sub<S>(p, between), margin);
  } else {
    return inside(a.shape, claim.point, margin) &&
           inside(b.shape, sub<S>(claim.point, between), margin);
  }
}

/// Proof that the plane with normal n separates the bodies; `size` is S of the pair. RTL:
/// `rtl/filter/filter_proof.sv`.
template <class A, class B, typename S = typename A::Scalar>
Mask<S> separates(const Body<A>& a, const Body<B>& b, const Vector<S>& n, S size) {
  const S nn = dot<S>(n, n);
  // A normal much longer than one would make the terms larger than S. For pairs below the sizes of
  // kLengths even a wide pipe's own F need not be right.
  const S smallest(power_of_two(kLengths<S>.low));
  return smallest <= size && nn <= S(1.25) && size * S(kDistance<S>) < distance_along(a, b, n, nn);
}

/// The certain result of A and B, whatever the proposal is.
template <class A, class B, typename S = typename A::Scalar>
Certain certify(const A& shape_a, const B& shape_b, const Proposal<S>& claim) {
  const Body<A> a(shape_a);
  const Body<B> b(shape_b);
  const S size = size_of_pair(a, b);
  const Mask<S> apart = separates(a, b, claim.n, size);
  const Mask<S> meet = both_have(a, b, claim, size * S(kDepth<S>));
  return apart ? Certain::kMiss : meet ? Certain::kHit : Certain::kNeither;
}

}  // namespace cde::reference::filter
