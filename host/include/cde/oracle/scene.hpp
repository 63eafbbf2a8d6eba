// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <utility>
#include <vector>

#include "cde/oracle/build_shape.hpp"
#include "cde/oracle/shapes.hpp"

/// Scenes as people make them: boxes, cylinders, spheres and triangles on a floor, snapped to a
/// grid, turned by multiples of 15 and 90 degrees, at rest on the floor or on each other.
namespace cde::oracle {

inline constexpr double kGrid = 0.25;

/// To the nearest point of the grid.
[[nodiscard]] inline Vec snapped(const Vec& v) {
  return kGrid * (v / kGrid).array().round().matrix();
}

/// Multiples of the grid from 1/4 to 2.
[[nodiscard]] inline double grid_length(Random& random) {
  return kGrid * (1 + random.below(8));
}

struct Body {
  ShapeKind kind;
  Shape shape;
};
using Scene = std::vector<Body>;

/// About z by a multiple of 15 degrees, half the time of 90; now and then about another axis too.
[[nodiscard]] Frame turn_of_15_degrees(Random& random);

/// The floor z = 0, a wall or a ramp, and three to seven bodies, among them one at least of each
/// kind that is wanted (two if it is wanted twice). A body rests on the floor or on an earlier one,
/// stands beside one and touches it, or has been pushed into one by a step or two of the grid.
[[nodiscard]] Scene make_scene(Random& random, const std::vector<ShapeKind>& wanted);

/// Two bodies of these kinds, three times in four those whose centres are nearest.
[[nodiscard]] std::pair<Shape, Shape> neighbours(Random& random, const Scene& scene, ShapeKind a,
                                                 ShapeKind b);
[[nodiscard]] Shape any_of(Random& random, const Scene& scene, ShapeKind kind);

/// Half of what the shape covers along n, from its centre on.
[[nodiscard]] double half_width_along(const Shape& shape, const Vec& n);

}  // namespace cde::oracle
