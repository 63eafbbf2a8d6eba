// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>
#include <limits>

#include "cde/bvh/node.hpp"
#include "cde/contract/pairs.hpp"
#include "cde/geometry/ops.hpp"
#include "cde/reference/pipes/distance_bound.hpp"

/// @file
/// A ray and the eight boxes of a node (cde/bvh/node.hpp).
///
/// The box rule (ray_box.hpp) bounds where a hit can be. For its T, exactly as the pipe returns it,
/// o + T d is within m' of the triangle's box on every axis, and
///
///     m' < 192 u (R + m') (1 + 4 u) + 12 u W        u = 2^-24
///
/// Here R is the largest distance along an axis from o to the root's box, and W the largest
/// |coordinate| of that box. The boxes are widened by M = 256 u R + 16 u W. Without roundings, T is
/// in the interval of every box around the triangle by at least 63 u R + 3 u W. Roundings take a
/// quarter of it:
///
/// - o +- M is off by u (|o| + M), and |o| <= R + W.
/// - A corner less that: by u 2 (R + M). Its product with the inverse: 2 u of as much. Byte times
///   unit times inverse: 2 u of 2 R, and the sum of both u R. The total is less than 16 u R + u W.
/// - A component of d below 2^-80 is replaced by that: T times it is below 2^-46 |T d|, as the
///   largest component is at least 2^-34.
///
/// So near <= T <= far holds as computed, for every hit in a box. A box is culled if near is above
/// the best T, or far is below tmin; it then has no hit that counts. With lengths up to 2^40 all
/// values are finite and normal.
///
/// For rays that hit spheres, T is exact for a sphere larger or smaller by 13 u (|o - c| + r)
/// (ray_sphere.hpp), which is at most 36 u R. So o + T d is that near the sphere, and hence in its
/// box. This holds if no square of T leaves the normal numbers. Rays for which R is not between
/// 2^-42 and 2^37 times the largest component of d therefore have an infinite M, and hit all boxes.
///
/// Two spheres have a signed distance with four roundings, 12 u (R + e) in all, without a rule. M
/// has room for that, and for underflows, since no radius is below 2^-34.
///
/// A solid is treated in the same way, with 1 / d = 1 and the corners of its own box, widened by M,
/// as o +- M. Then near and -far of an axis are axis distances. The distance_key() of the larger
/// ones is compared with the signed distance of everything in the box (distance_bound.hpp).
namespace cde::reference {

/// What a card knows about the root of its BVH.
template <typename S>
struct RootBounds {
  Vector<S> lower, upper;  ///< its box
  S margin;                ///< 16 u W
};

/// Computed exactly.
template <typename S>
[[nodiscard]] RootBounds<S> root_bounds(const Vector<S>& lower, const Vector<S>& upper) {
  S most(0);
  for (int k = 0; k < 3; ++k)
    most = max_num(most, max_num(magnitude(lower[k]), magnitude(upper[k])));
  return {lower, upper, most * S(0x1p-20)};
}

/// A ray as nodes use it.
template <typename S>
struct RayFront {
  Vector<S> above, below;  ///< o + M, o - M
  Vector<S> inverse;       ///< 1 / d
  Mask<S> negative[3];     ///< signs of d, also for zeros
};

/// Largest distance along an axis from a point or a box to the root's box: 6 sub, 5 max.
template <typename S>
[[nodiscard]] S reach(const Hull<S>& of, const RootBounds<S>& root) {
  Vector<S> far;
  for (int k = 0; k < 3; ++k)
    far[k] = max_num(magnitude(root.lower[k] - of.high[k]), magnitude(root.upper[k] - of.low[k]));
  return max_num(max_num(far.x(), far.y()), far.z());
}

/// Once per ray: 1 mul, 3 div, 4 add, 9 sub, 8 min/max. For spheres 2 mul, 2 cmp, 2 max more.
template <typename S>
[[nodiscard]] RayFront<S> ray_front(const Vector<S>& o, const Vector<S>& d,
                                    const RootBounds<S>& root, Shape leaf = Shape::kTriangle) {
  const S reach_of_root = reach<S>({o, o}, root);
  S margin = reach_of_root * S(0x1p-16) + root.margin;
  if (leaf == Shape::kSphere) {
    const S most = max_num(max_num(magnitude(d[0]), magnitude(d[1])), magnitude(d[2]));
    const auto known = most * S(0x1p-42) <= reach_of_root && reach_of_root <= most * S(0x1p37);
    margin = select(known, margin, S(std::numeric_limits<float>::infinity()));
  }
  RayFront<S> front;
  for (int k = 0; k < 3; ++k) {
    front.above[k] = o[k] + margin;
    front.below[k] = o[k] - margin;
    front.negative[k] = is_negative(d[k]);
    const S size = max_num(magnitude(d[k]), S(0x1p-80));
    front.inverse[k] = S(1) / select(front.negative[k], -size, size);
  }
  return front;
}

/// Once per solid or triangle: 1 mul, 8 add, 12 sub, 7 max, plus half_size() and hull_of().
template <typename S, class Solid>
[[nodiscard]] RayFront<S> solid_front(const Solid& solid, const RootBounds<S>& root) {
  const Vector<S> half = half_size(solid);
  const S most = max_num(max_num(half[0], half[1]), half[2]);
  const Hull<S> hull = hull_of(solid);
  const S margin = (reach<S>(hull, root) + most) * S(0x1p-16) + root.margin;
  RayFront<S> front;
  for (int k = 0; k < 3; ++k) {
    front.above[k] = (hull.high[k] + half[k]) + margin;
    front.below[k] = (hull.low[k] - half[k]) - margin;
    front.negative[k] = Mask<S>(false);
    front.inverse[k] = S(1);
  }
  return front;
}

/// Planes of a node at byte 0, for a ray, and the size of a byte.
template <typename S>
struct NodeFront {
  Vector<S> near, far, unit;
};

/// Once per node: 6 sub, 6 mul; units are wires.
template <typename S>
[[nodiscard]] NodeFront<S> node_front(const RayFront<S>& ray, const bvh::Node& node) {
  NodeFront<S> front;
  const Eigen::Vector3f origin = node.origin();
  for (int k = 0; k < 3; ++k) {
    const S at(origin[k]), above = at - ray.above[k], below = at - ray.below[k];
    front.near[k] = select(ray.negative[k], below, above) * ray.inverse[k];
    front.far[k] = select(ray.negative[k], above, below) * ray.inverse[k];
    front.unit[k] = ray.inverse[k] * S(std::ldexp(1.0f, node.exponent(k)));
  }
  return front;
}

/// Interval of T in which a ray is in a box.
template <typename S>
struct Stretch {
  S near, far;
};

/// The same, by axis.
template <typename S>
struct AxisStretch {
  Vector<S> near, far;
};
/// For one child: 6 mul, 6 add.
template <typename S>
[[nodiscard]] AxisStretch<S> axis_stretch(const NodeFront<S>& front, const RayFront<S>& ray,
                                          const bvh::Node& node, unsigned child) {
  AxisStretch<S> axes;
  for (int k = 0; k < 3; ++k) {
    const S lower(static_cast<float>(node.lower(child, k))),
        upper(static_cast<float>(node.upper(child, k)));
    axes.near[k] = front.near[k] + select(ray.negative[k], upper, lower) * front.unit[k];
    axes.far[k] = front.far[k] + select(ray.negative[k], lower, upper) * front.unit[k];
  }
  return axes;
}

/// Intersection of the three axes: 4 min/max.
template <typename S>
[[nodiscard]] Stretch<S> stretch(const AxisStretch<S>& axes) {
  return {max_num(max_num(axes.near[0], axes.near[1]), axes.near[2]),
          min_num(min_num(axes.far[0], axes.far[1]), axes.far[2])};
}

/// Key for culling a box, for a solid: 3 mul, 2 add, 1 cmp, 8 max.
template <typename S>
[[nodiscard]] S distance_key(const AxisStretch<S>& axes) {
  Vector<S> distances;
  for (int k = 0; k < 3; ++k) distances[k] = max_num(axes.near[k], -axes.far[k]);
  const BoxDistance<S> all = box_distance<S>(distances);
  return select(all.apart, all.square, all.widest);
}
/// The same key for a signed distance that was found, hit or not. 1 mul.
template <typename S>
[[nodiscard]] S distance_key(const Mask<S>& meets, S distance) {
  return select(meets, distance, distance * distance);
}

}  // namespace cde::reference
