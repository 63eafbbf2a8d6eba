// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>

#include "cde/bvh/node.hpp"
#include "cde/reference/pipes/distance_bound.hpp"
#include "cde/reference/pipes/root_bounds.hpp"

/// @file
/// A solid or a triangle as a primary, and the eight boxes of a node (cde/bvh/node.hpp). Rays are
/// in cde/reference/integer_node.hpp.
///
/// The primary's own box is widened by M = 256 u (R + e) + 16 u W (distance_bound.hpp). Its
/// distances from a child's box on the three axes give the child's key. The key is compared with
/// distance_key() of the best signed distance so far.
///
/// Two spheres have a signed distance with four roundings, 12 u (R + e) in all, without a rule. M
/// has room for that, and for underflows, since no radius is below 2^-34.
namespace cde::reference {

/// A primary as nodes use it: the corners of its box, widened by M.
template <typename S>
struct SolidFront {
  Vector<S> upper, lower;
};

/// Once per solid or triangle: 1 mul, 8 add, 12 sub, 7 max, plus half_size() and hull_of().
template <typename S, class Solid>
[[nodiscard]] SolidFront<S> solid_front(const Solid& solid, const RootBounds<S>& root) {
  const Vector<S> half = half_size(solid);
  const S most = max_num(max_num(half[0], half[1]), half[2]);
  const Hull<S> hull = hull_of(solid);
  const S margin = (reach<S>(hull, root) + most) * S(0x1p-16) + root.margin;
  SolidFront<S> front;
  for (int k = 0; k < 3; ++k) {
    front.upper[k] = (hull.high[k] + half[k]) + margin;
    front.lower[k] = (hull.low[k] - half[k]) - margin;
  }
  return front;
}

/// Corners of a node at byte 0, as seen from a primary, and the size of a byte.
template <typename S>
struct SolidNode {
  Vector<S> above, below, unit;
};

/// Once per node: 6 sub; units are wires.
template <typename S>
[[nodiscard]] SolidNode<S> solid_node(const SolidFront<S>& solid, const bvh::Node& node) {
  SolidNode<S> front;
  const Eigen::Vector3f origin = node.origin();
  for (int k = 0; k < 3; ++k) {
    front.above[k] = S(origin[k]) - solid.upper[k];
    front.below[k] = S(origin[k]) - solid.lower[k];
    front.unit[k] = S(std::ldexp(1.0f, node.exponent(k)));
  }
  return front;
}

/// The same for a child's box: how far it begins above the primary's box, and ends above its start.
template <typename S>
struct AxisDistances {
  Vector<S> above, below;
};
/// For one child: 6 add; the products are wires.
template <typename S>
[[nodiscard]] AxisDistances<S> axis_distances(const SolidNode<S>& front, const bvh::Node& node,
                                              unsigned child) {
  AxisDistances<S> axes;
  for (int k = 0; k < 3; ++k) {
    const S lower(static_cast<float>(node.lower(child, k))),
        upper(static_cast<float>(node.upper(child, k)));
    axes.above[k] = front.above[k] + lower * front.unit[k];
    axes.below[k] = front.below[k] + upper * front.unit[k];
  }
  return axes;
}

/// Key for culling a box: 3 mul, 2 add, 1 cmp, 8 max.
template <typename S>
[[nodiscard]] S distance_key(const AxisDistances<S>& axes) {
  Vector<S> distances;
  for (int k = 0; k < 3; ++k) distances[k] = max_num(axes.above[k], -axes.below[k]);
  const BoxDistance<S> all = box_distance<S>(distances);
  return select(all.apart, all.square, all.widest);
}
/// The same key for a signed distance that was found, hit or not. 1 mul.
template <typename S>
[[nodiscard]] S distance_key(const Mask<S>& meets, S distance) {
  return select(meets, distance, distance * distance);
}

}  // namespace cde::reference
