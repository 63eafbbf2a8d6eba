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

/// A pair as people name it, and whether they name its shapes in the other order.
struct PairName {
  Pair pair;
  bool exchanged = false;
};
/// Takes the names of pair_named, those with the shapes exchanged ("triangle-ray"), and "box" for
/// "obb". Error kUsage for others: of shapes that no pair has together it lists the pairs of each.
[[nodiscard]] PairName pair_in_any_order(std::string_view text);
[[nodiscard]] std::optional<Algorithm> algorithm_named(std::string_view text);

[[nodiscard]] std::string_view name(Shape shape);
/// Words of a slot.
[[nodiscard]] unsigned words(Shape shape);

[[nodiscard]] Shape primary_shape(Pair pair);
[[nodiscard]] Shape secondary_shape(Pair pair);
[[nodiscard]] inline unsigned primary_words(Pair pair) {
  return words(primary_shape(pair));
}
[[nodiscard]] inline unsigned secondary_words(Pair pair) {
  return words(secondary_shape(pair));
}
/// Two solids: T is the size of a signed gap. Otherwise a ray is the primary.
[[nodiscard]] inline bool is_solid(Pair pair) {
  return primary_shape(pair) != Shape::kRay;
}

template <class P>
inline constexpr Shape kShapeOf = P::kShape;

/// How much work a pair of cylinder-cylinder, obb-cylinder or triangle-cylinder gets; the others
/// always take the same. More finds more of the gap (docs/reference/pairs_cylinder.md).
struct PairBudget {
  unsigned samples = 8;  ///< M: directions sampled on each circle (box, triangle): 4, 8 or 16
  unsigned circle = 8;   ///< K1: steps on each circle, at most 64
  unsigned free = 8;     ///< K2: steps on each free track (cylinder-cylinder), at most 64

  /// Error kUsage if a value is out of range, naming it.
  void check() const;
  bool operator==(const PairBudget&) const = default;
};

/// Whether the pair takes a budget.
[[nodiscard]] bool has_budget(Pair pair);

/// Whether the pair's pipe is made of facet units, which can take turns: obb-obb, triangle-aabb,
/// triangle-obb.
[[nodiscard]] bool has_facets(Pair pair);

/// Whether the box rule is of the pair: those of triangles (not of cylinders), sphere-obb, obb-obb.
[[nodiscard]] bool has_box_rule(Pair pair);

/// Primaries of a pair that meet secondaries in a hierarchy.
struct WayThrough {
  Shape primary, secondary;
};
/// `swap`: Query::swap, so that shape A is in the hierarchy. Nothing where the pair sweeps: those
/// of cylinders and planes do, and rays and shapes that are the same have no roles to swap. Pairs
/// that have the box rule need it.
[[nodiscard]] std::optional<WayThrough> way_through(Pair pair, bool swap);

/// Whether narrow lanes can prove misses of a pair on a card (BoardConfig::verdicts).
[[nodiscard]] bool has_verdicts(Pair pair);
/// `interval`: clocks from one row of such pairs to the next, 1 or 3. Error kUsage if it is
/// neither, or 3 where none of the pairs has facets.
void check_facet_interval(unsigned interval, std::span<const Pair> pairs);

/// Names of all pairs and of the ray-triangle algorithms, in the order of their codes.
[[nodiscard]] std::vector<std::string> pair_names();
[[nodiscard]] std::vector<std::string> algorithm_names();

}  // namespace cde
