// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <span>
#include <variant>

#include "cde/contract/pairs.hpp"

/// The shapes of the oracles, in binary64. They stand apart from the library's own primitives on
/// purpose: nothing here shares code with what it judges. Operands of at most 53 bits are exact.
/// World frame, one length unit throughout.
namespace cde::oracle {

using Vec = Eigen::Vector3d;

/// The ball |x - c| <= r.
struct Sphere {
  Vec c;
  double r;
};

/// min <= x <= max.
struct Aabb {
  Vec min, max;
};

/// x = c + R l with |l_i| <= half_i. The columns of R need not be exactly orthonormal (binary32
/// columns never are): the shape is that parallelepiped, exactly.
struct Obb {
  Vec c, half;
  Eigen::Matrix3d rotation;
};

/// Two-sided; without area it is the segment or point that it covers.
struct Triangle {
  Vec v0, v1, v2;
};

/// Caps at c +- half_height * axis, discs of `radius` perpendicular to the axis. The axis need not
/// be exactly of unit length.
struct Cylinder {
  Vec c, axis;
  double half_height, radius;
};

/// The points x with n.x = d, a surface with two sides; or, as a half-space, those with n.x <= d.
struct Plane {
  Vec n;
  double d;
  bool half_space = false;
};

/// o + t d for tmin <= t <= tmax.
struct Ray {
  Vec o, d;
  double tmin, tmax;
};

/// Whatever has a signed gap.
using Shape = std::variant<Triangle, Sphere, Aabb, Plane, Cylinder, Obb>;

using ShapeKind = cde::Shape;  // their names and numbers; what they are is said above

/// Words of a slot: ray 8, triangle 9, sphere 4, AABB 6, plane 4, cylinder 8, OBB 15.
[[nodiscard]] std::size_t word_count(ShapeKind kind);

/// A shape from the words of a slot, in slot order (an OBB's rotation row by row). Throws
/// std::invalid_argument if the count is wrong or the kind is a ray.
[[nodiscard]] Shape shape_from_words(ShapeKind kind, std::span<const double> words);
[[nodiscard]] Ray ray_from_words(std::span<const double> words);

/// Where the shape is: the centre of a box, sphere or cylinder, the centroid of a triangle, the
/// point of a plane nearest the world's origin.
[[nodiscard]] Vec center(const Shape& shape);

/// h(n) = max n.x over the shape; infinite for a plane unless n is its normal or, for a surface,
/// the opposite of it.
[[nodiscard]] double support(const Shape& shape, const Vec& n);

/// Distance from p to the shape, 0 inside; at worst one part in 1e12 above the truth.
[[nodiscard]] double distance(const Vec& p, const Shape& shape);

/// S: |cB - cA|_1 + the extents of both (sphere r, box sum of half extents, cylinder h + r,
/// triangle the largest |v - centroid|_1). With a plane |cB - cA|_1 is |c|_1 + |d|, since n.c - d
/// can cancel no sooner.
[[nodiscard]] double scene_size(const Shape& a, const Shape& b);

/// L: the largest |coordinate| of centres, corners and vertices.
[[nodiscard]] double largest_coordinate(const Shape& a, const Shape& b);

}  // namespace cde::oracle
