// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <utility>
#include <vector>

#include "cde/oracle/build_shape.hpp"
#include "cde/oracle/shapes.hpp"

/// @file
/// Everyday scenes: boxes, cylinders, spheres and triangles on a floor. They are snapped to a grid,
/// turned by multiples of 15 and 90 degrees, and at rest on the floor or on each other.
namespace cde::oracle {

inline constexpr double kGrid = 0.25;

/// The nearest point of the grid.
[[nodiscard]] inline Vec snapped(const Vec& v) {
  return kGrid * (v / kGrid).array().round().matrix();
}

/// A random multiple of the grid from 1/4 to 2.
[[nodiscard]] inline double grid_length(Random& random) {
  return kGrid * (1 + random.below(8));
}

struct Body {
  ShapeKind kind;
  Shape shape;
};
using Scene = std::vector<Body>;

/// A turn about z by a multiple of 15 degrees, half the time of 90; sometimes about another axis as
/// well.
[[nodiscard]] Frame turn_of_15_degrees(Random& random);

/// The floor z = 0, a wall or a ramp, and three to seven bodies. Each wanted kind occurs at least
/// once, or twice if it is listed twice. A body rests on the floor or on an earlier body, touches
/// one from the side, or overlaps one by a step or two of the grid.
[[nodiscard]] Scene make_scene(Random& random, const std::vector<ShapeKind>& wanted);

/// Two bodies of these kinds. In three of four cases they are those with the nearest centres.
[[nodiscard]] std::pair<Shape, Shape> neighbours(Random& random, const Scene& scene, ShapeKind a,
                                                 ShapeKind b);
[[nodiscard]] Shape any_of(Random& random, const Scene& scene, ShapeKind kind);

/// Half of the shape's width along n, measured from its centre.
[[nodiscard]] double half_width_along(const Shape& shape, const Vec& n);

}  // namespace cde::oracle
