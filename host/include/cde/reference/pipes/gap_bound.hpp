// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <type_traits>

#include "cde/geometry/ops.hpp"
#include "cde/geometry/primitives.hpp"

/// The box rule of pairs that have a signed gap (BOX = 1): it is not below that of their boxes.
///
/// Two boxes that are apart have a distance, the norm of their gaps of axes where these are above
/// zero; and where none is, moving one of them by the largest gap along its axis parts them. So
/// that is a lower bound of the signed gap, of distance and penetration alike. A pipe's s is off by
/// roundings, or by more where a triangle has no area; the rule gives
///
///     s' = max(s, g - m)    g_k = max(b - A, a - B) - e, by axis
///                           g = |max(g_k, 0)| if any is above zero, else the largest g_k
///                           m = 128 u max over axes of (max(|b - A|, |a - B|) + e)
///
/// with [a, A] and [b, B] the boxes of triangles and AABBs, or the centre of a solid, and e half
/// the size of its box, the sum of both where both are solids. m is far above what the pipes'
/// roundings are, and what rotations are off orthonormal ones: s' is s unless s is wrong. It is the
/// pair's own, so that it is the same in a sweep and through a hierarchy.
///
/// A hierarchy may leave out a box whose bound is above the best gap: g_k as its nodes compute them
/// (ray_node.hpp, with 1 / d = 1 and o +- M the corners of the solid's box, widened by M) are off
/// by less than 10 u (R + e) + 2 u W, R the largest distance along an axis from c to the root's
/// box, W the largest |coordinate| of that; here roundings take less than 16 u (R + e), and m is
/// 128 u (R + e) at most. M = 256 u (R + e) + 16 u W is taken off each g_k, and what is taken off
/// all of them is taken off their norm: nodes are below g - m by 100 u (R + e) and more. They
/// compare squares (gap_key()), whose roundings are 5 u of a square, 3 u of a gap of 2 (R + e) at
/// most. Of a triangle or an AABB R is the largest distance along an axis from an end of its box
/// to the other end of the root's, and e is 0. A solid in the tree has the box of its exact half
/// size, which is off by 3 u of it from the e that the rule has, and lies within R.
namespace cde::reference {

/// Margin over u.
inline constexpr int kBoundMargin = 128;

/// Half the size of a solid's own box. Wires.
template <typename S>
[[nodiscard]] Vector<S> half_size(const BasicSphere<S>& sphere) {
  return Vector<S>::Constant(sphere.r);
}
/// |R| h: 9 mul, 6 add.
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

/// Triangles and AABBs are taken from end to end: their hull is their box.
template <typename S>
[[nodiscard]] Vector<S> half_size(const BasicTriangle<S>&) {
  return Vector<S>::Zero();
}
template <typename S>
[[nodiscard]] Vector<S> half_size(const BasicAabb<S>&) {
  return Vector<S>::Zero();
}

/// Between which points a shape lies, from where half_size() goes on.
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

/// What gaps of axes say of the gap: its square where it is above zero, else itself. 3 mul, 2 add,
/// 1 cmp, 5 max.
template <typename S>
struct AxisGaps {
  Mask<S> apart;
  S square, widest;
};
template <typename S>
[[nodiscard]] AxisGaps<S> axis_gaps(const Vector<S>& gap) {
  const S zero(0);
  const Vector<S> way(max_num(gap[0], zero), max_num(gap[1], zero), max_num(gap[2], zero));
  const S widest = max_num(max_num(gap[0], gap[1]), gap[2]);
  return {zero < widest, dot<S>(way, way), widest};
}

/// Half the sizes of both: 3 add of two solids.
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

/// g - m: 4 mul, 5 add, 10 sub, 1 sqrt, 1 cmp, 13 max, and what half_sizes() and hull_of() take.
template <typename S, class A, class B>
[[nodiscard]] S gap_bound(const A& a, const B& b) {
  const Vector<S> half = half_sizes<S>(a, b);
  const Hull<S> of = hull_of(a), other = hull_of(b);
  Vector<S> gap, size;
  for (int k = 0; k < 3; ++k) {
    const S below = of.low[k] - other.high[k], above = other.low[k] - of.high[k];
    gap[k] = max_num(below, above) - half[k];
    size[k] = max_num(magnitude(below), magnitude(above)) + half[k];
  }
  const S margin = max_num(max_num(size[0], size[1]), size[2]) * S(kBoundMargin * kUnitRoundoff<S>);
  const AxisGaps<S> all = axis_gaps<S>(gap);
  return select(all.apart, square_root(all.square), all.widest) - margin;
}

/// A pipe's answer with a gap that is the bound where it is less: 1 cmp, 1 max.
template <typename S>
[[nodiscard]] Outcome<S> at_least(const Outcome<S>& pipe, S bound) {
  Outcome<S> o = pipe;
  o.f = static_cast<bool>(Mask<S>(pipe.f) && bound <= S(0));
  o.t = magnitude(max_num(pipe.f ? -pipe.t : pipe.t, bound));
  return o;
}

/// What a pipe answers of a pair, by the rule.
template <typename S, class A, class B>
[[nodiscard]] Outcome<S> bounded(const Outcome<S>& pipe, const A& a, const B& b) {
  return pipe.bad ? pipe : at_least<S>(pipe, gap_bound<S>(a, b));
}

}  // namespace cde::reference
