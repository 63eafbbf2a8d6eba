// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cde/contract/pairs.hpp"
#include "cde/geometry/primitives.hpp"

namespace cde {

/// What the plane of a pair bounds.
enum class PlaneSide : unsigned {
  kSurface,    ///< the plane itself, with two sides
  kHalfSpace,  ///< the points with n.x <= d
};

/// "ray-triangle", "obb-obb" and so on.
[[nodiscard]] std::string_view name(Pair pair);
[[nodiscard]] std::string_view name(Algorithm algorithm);
[[nodiscard]] std::optional<Pair> pair_named(std::string_view text);

/// A pair as a user names it, possibly with its shapes in the other order.
struct PairName {
  Pair pair;
  bool exchanged = false;
};
/// Parses the names of pair_named, the same with the shapes exchanged ("triangle-ray"), and "box"
/// for "obb". Error kUsage otherwise. For two shapes that form no pair it lists the pairs of each.
[[nodiscard]] PairName pair_in_any_order(std::string_view text);
[[nodiscard]] std::optional<Algorithm> algorithm_named(std::string_view text);

[[nodiscard]] std::string_view name(Shape shape);
/// Number of words of a slot.
[[nodiscard]] unsigned words(Shape shape);

[[nodiscard]] Shape primary_shape(Pair pair);
[[nodiscard]] Shape secondary_shape(Pair pair);
[[nodiscard]] inline unsigned primary_words(Pair pair) {
  return words(primary_shape(pair));
}
[[nodiscard]] inline unsigned secondary_words(Pair pair) {
  return words(secondary_shape(pair));
}
/// Whether both shapes are solids, so that T is the absolute value of a signed distance. Otherwise
/// the primary is a ray.
[[nodiscard]] inline bool is_solid(Pair pair) {
  return primary_shape(pair) != Shape::kRay;
}

template <class P>
inline constexpr Shape kShapeOf = P::kShape;

/// Iterations of the pairs cylinder-cylinder, obb-cylinder and triangle-cylinder. The work of other
/// pairs is fixed. With more iterations, T comes closer to the signed distance
/// (docs/reference/pairs_cylinder.md).
struct PairIterations {
  unsigned samples = 8;  ///< M: directions sampled on each circle (box, triangle): 4, 8 or 16
  unsigned circle = 8;   ///< K1: steps on each circle, at most 64
  unsigned free = 8;     ///< K2: steps on each free track (cylinder-cylinder), at most 64

  /// Error kUsage if a value is out of range, naming it.
  void check() const;
  bool operator==(const PairIterations&) const = default;
};

/// Whether the pair takes a number of iterations.
[[nodiscard]] bool has_iterations(Pair pair);

/// Whether the pair is tested on candidate axes (SAT), whose units can be shared: obb-obb,
/// triangle-aabb, triangle-obb.
[[nodiscard]] bool has_sat_interval(Pair pair);

/// Whether the pair can have the box rule: triangle pairs without cylinder, sphere-obb, obb-obb.
[[nodiscard]] bool has_box_rule(Pair pair);

/// Primary and secondary shape of a pair that traverses a BVH.
struct TraversalShapes {
  Shape primary, secondary;
};
/// The shapes of a pair that can traverse a BVH. `swap` is Query::swap: shape A is in the BVH.
/// Nothing for a pair that only has brute-force passes. These are pairs with a cylinder or plane,
/// and `swap` for rays and for equal shapes. A pair with an optional box rule needs that rule.
[[nodiscard]] std::optional<TraversalShapes> traversal_shapes(Pair pair, bool swap);

/// Whether the certified filter can prove misses of a pair in narrow lanes
/// (`BoardConfig::filter`).
[[nodiscard]] bool has_filter(Pair pair);
/// `interval`: cycles from one row of such pairs to the next, 1 or 3. Error kUsage for another
/// value, or for 3 if none of the pairs has candidate axes.
void check_sat_interval(unsigned interval, std::span<const Pair> pairs);

/// Names of all pairs and of the ray-triangle algorithms, in the order of their codes.
[[nodiscard]] std::vector<std::string> pair_names();
[[nodiscard]] std::vector<std::string> algorithm_names();

}  // namespace cde
