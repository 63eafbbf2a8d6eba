// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <type_traits>

#include "cde/geometry/ops.hpp"
#include "cde/geometry/primitives.hpp"

/// @file
/// The box rule of pairs with a signed distance (BOX = 1): the signed distance of two shapes is not
/// below the distance of their boxes.
///
/// Two boxes that are apart have a distance: the norm of those axis distances that are above zero.
/// If none is, moving one box by the largest axis distance along its axis separates them. Hence
/// this is a lower bound of the signed distance, for distance and penetration alike. A pipe's s is
/// off by roundings, or by more for a triangle without area. The rule gives
///
///     s' = max(s, g - m)    g_k = max(b - A, a - B) - e, by axis
///                           g = |max(g_k, 0)| if any is above zero, else the largest g_k
///                           m = 128 u max over axes of (max(|b - A|, |a - B|) + e)
///
/// Here [a, A] and [b, B] are the boxes of triangles and AABBs, or the centre of a solid. Half the
/// size of a solid's box is e, the sum of both for two solids. The margin m is far above the
/// roundings of the pipes and the deviations of rotations from orthonormal ones. So s' = s unless s
/// is wrong. It depends on the pair alone, so that it is the same by brute force and in a BVH.
///
/// A traversal may cull a box whose bound is above the best signed distance. The nodes compute g_k
/// from the corners of the solid's box, widened by M (solid_node.hpp). That is off by less than
/// 10 u (R + e) + 2 u W. R is the largest distance along an axis from c to the root's box, and W
/// the largest |coordinate| of that box. Here roundings are below 16 u (R + e), and m is at most
/// 128 u (R + e). Nodes subtract M = 256 u (R + e) + 16 u W from each g_k. A value
/// that is subtracted from all g_k is subtracted from their norm, so nodes are below g - m by at
/// least 100 u (R + e).
///
/// Nodes compare squares (distance_key()), whose roundings are 5 u of a square, 3 u of a distance
/// of at most 2 (R + e). A triangle or an AABB has e = 0. Its R is the largest distance along an
/// axis from an end of its box to the other end of the root's box. A solid in the BVH has the box
/// of its exact half size. That differs by 3 u of it from the e of the rule, and lies within R.
namespace cde::reference {

/// Margin over u.
inline constexpr int kBoundMargin = 128;

/// Half the size of a solid's own box. Wires.
template <typename S>
[[nodiscard]] Vector<S> half_size(const BasicSphere<S>& sphere) {
  return Vector<S>::Constant(sphere.r);
}
/// Row sums |R| h: 9 mul, 6 add.
template <typename S>
[[nodiscard]] Vector<S> half_size(const BasicObb<S>& box) {
  Vector<S> size;
  for (int k = 0; k < 3; ++k) {
    const Vector<S> row(magnitude(box.rotation(k, 0)), magnitude(box.rotation(k, 1)),
                        magnitude(box.rotation(k, 2)));
    size[k] = dot<S>(box.half, row);
  }
  return size;
}

/// Triangles and AABBs have zero half size: their hull is their box.
template <typename S>
[[nodiscard]] Vector<S> half_size(const BasicTriangle<S>&) {
  return Vector<S>::Zero();
}
template <typename S>
[[nodiscard]] Vector<S> half_size(const BasicAabb<S>&) {
  return Vector<S>::Zero();
}

/// The box of a shape's reference points; half_size() extends it.
template <typename S>
struct Hull {
  Vector<S> low, high;
};
template <typename S>
[[nodiscard]] Hull<S> hull_of(const BasicSphere<S>& sphere) {
  return {sphere.c, sphere.c};
}
template <typename S>
[[nodiscard]] Hull<S> hull_of(const BasicObb<S>& box) {
  return {box.c, box.c};
}
template <typename S>
[[nodiscard]] Hull<S> hull_of(const BasicAabb<S>& box) {
  return {box.min, box.max};
}
/// 12 min/max.
template <typename S>
[[nodiscard]] Hull<S> hull_of(const BasicTriangle<S>& t) {
  Hull<S> hull;
  for (int k = 0; k < 3; ++k) {
    hull.low[k] = min_num(min_num(t.v0[k], t.v1[k]), t.v2[k]);
    hull.high[k] = max_num(max_num(t.v0[k], t.v1[k]), t.v2[k]);
  }
  return hull;
}

/// Bound of the signed distance from axis distances: its square if it is above zero, else its
/// value. 3 mul, 2 add, 1 cmp, 5 max.
template <typename S>
struct BoxDistance {
  Mask<S> apart;
  S square, widest;
};
template <typename S>
[[nodiscard]] BoxDistance<S> box_distance(const Vector<S>& distances) {
  const S zero(0);
  const Vector<S> clamped(max_num(distances[0], zero), max_num(distances[1], zero),
                          max_num(distances[2], zero));
  const S widest = max_num(max_num(distances[0], distances[1]), distances[2]);
  return {zero < widest, dot<S>(clamped, clamped), widest};
}

/// Sum of both half sizes: 3 add for two solids.
template <typename S, class A, class B>
[[nodiscard]] Vector<S> half_sizes(const A& a, const B& b) {
  constexpr auto kHull = []<class Shape>(std::type_identity<Shape>) {
    return std::is_same_v<Shape, BasicTriangle<S>> || std::is_same_v<Shape, BasicAabb<S>>;
  };
  if constexpr (kHull(std::type_identity<A>()))
    return half_size(b);
  else if constexpr (kHull(std::type_identity<B>()))
    return half_size(a);
  else
    return half_size(a) + half_size(b);
}

/// g - m: 4 mul, 5 add, 10 sub, 1 sqrt, 1 cmp, 13 max, plus half_sizes() and hull_of().
template <typename S, class A, class B>
[[nodiscard]] S distance_bound(const A& a, const B& b) {
  const Vector<S> half = half_sizes<S>(a, b);
  const Hull<S> of = hull_of(a), other = hull_of(b);
  Vector<S> distances, size;
  for (int k = 0; k < 3; ++k) {
    const S below = of.low[k] - other.high[k], above = other.low[k] - of.high[k];
    distances[k] = max_num(below, above) - half[k];
    size[k] = max_num(magnitude(below), magnitude(above)) + half[k];
  }
  const S margin = max_num(max_num(size[0], size[1]), size[2]) * S(kBoundMargin * kUnitRoundoff<S>);
  const BoxDistance<S> all = box_distance<S>(distances);
  return select(all.apart, square_root(all.square), all.widest) - margin;
}

/// A pipe's result with its signed distance raised to the bound if it is below: 1 cmp, 1 max.
template <typename S>
[[nodiscard]] Outcome<S> at_least(const Outcome<S>& pipe, S bound) {
  Outcome<S> o = pipe;
  o.f = static_cast<bool>(Mask<S>(pipe.f) && bound <= S(0));
  o.t = magnitude(max_num(pipe.f ? -pipe.t : pipe.t, bound));
  return o;
}

/// A pipe's result for a pair, with the rule applied.
template <typename S, class A, class B>
[[nodiscard]] Outcome<S> bounded(const Outcome<S>& pipe, const A& a, const B& b) {
  return pipe.bad ? pipe : at_least<S>(pipe, distance_bound<S>(a, b));
}

}  // namespace cde::reference
