// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <limits>
#include <span>
#include <stdexcept>
#include <variant>
#include <vector>

#include "cde/contract/pairs.hpp"
#include "cde/oracle/format.hpp"

/// @file
/// The shapes of the oracles, in binary64. They share no code with the library's own primitives,
/// which they judge. Operands of at most 53 bits are exact. World frame, one length unit
/// throughout.
namespace cde::oracle {

using Vec = Eigen::Vector3d;
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

class Random;
struct Build;
struct Lengths;
using Frame = Eigen::Matrix3d;  ///< columns: the axes of a shape in the world
using ShapeKind = cde::Shape;   // names and numbers of the contract; their meaning is defined here

/// Type of a shape's field: how moving, turning and scaling affect it.
enum class Field {
  kPoint,   ///< moves, turns, scales
  kCorner,  ///< of an AABB: moves and scales, does not turn
  kAxis,    ///< turns
  kNormal,  ///< of a plane: turns; moving changes the level after it
  kLevel,   ///< of a plane: scales
  kSize,    ///< one or three: scales
  kFrame,   ///< turns
  kBound    ///< of a ray: never changes
};

/// The struct of a shape and its part of shapes.cpp hold everything about it, except for the core
/// that signed_distance.cpp derives. `fields` lists the words of a slot in order. `center`,
/// `support` and `distance` match the functions below. `extent` and `largest` are its part of the
/// measures S and L. Three functions make random shapes about the origin. `build` serves
/// build_shape(). `whole` has lengths from about 1 to 5, along the axes. `body` has half sizes `h`
/// and is for scenes. `kSpread` is the distance at which about half of random pairs meet, as a
/// fraction of the sum of half widths.

/// The ball |x - c| <= r.
struct Sphere {
  static constexpr ShapeKind kKind = ShapeKind::kSphere;
  static constexpr double kSpread = 0.75;  // it fills half of the box about it
  Vec c;
  double r;

  template <class Self, class F>
  static void fields(Self& s, F&& f) {
    f(Field::kPoint, s.c), f(Field::kSize, s.r);
  }
  [[nodiscard]] Vec center() const;
  [[nodiscard]] double support(const Vec& n) const;
  [[nodiscard]] double distance(const Vec& p) const;
  [[nodiscard]] double extent() const;
  [[nodiscard]] double largest() const;
  static Sphere build(Random& random, const Frame& frame, const Build& build);
  static Sphere whole(Lengths& lengths);
  static Sphere body(Random& random, const Frame& frame, const Vec& h);
};

/// min <= x <= max.
struct Aabb {
  static constexpr ShapeKind kKind = ShapeKind::kAabb;
  static constexpr double kSpread = 1;
  Vec min, max;

  template <class Self, class F>
  static void fields(Self& s, F&& f) {
    f(Field::kCorner, s.min), f(Field::kCorner, s.max);
  }
  [[nodiscard]] Vec center() const;
  [[nodiscard]] double support(const Vec& n) const;
  [[nodiscard]] double distance(const Vec& p) const;
  [[nodiscard]] double extent() const;
  [[nodiscard]] double largest() const;
  static Aabb build(Random& random, const Frame& frame, const Build& build);
  static Aabb whole(Lengths& lengths);
  static Aabb body(Random& random, const Frame& frame, const Vec& h);
};

/// x = c + R l with |l_i| <= half_i. The columns of R need not be exactly orthonormal (binary32
/// columns never are): the shape is that parallelepiped, exactly.
struct Obb {
  static constexpr ShapeKind kKind = ShapeKind::kObb;
  static constexpr double kSpread = 1;
  Vec c, half;
  Frame rotation;

  template <class Self, class F>
  static void fields(Self& s, F&& f) {
    f(Field::kPoint, s.c), f(Field::kSize, s.half), f(Field::kFrame, s.rotation);
  }
  [[nodiscard]] Vec center() const;
  [[nodiscard]] double support(const Vec& n) const;
  [[nodiscard]] double distance(const Vec& p) const;
  [[nodiscard]] double extent() const;
  [[nodiscard]] double largest() const;
  static Obb build(Random& random, const Frame& frame, const Build& build);
  static Obb whole(Lengths& lengths);
  static Obb body(Random& random, const Frame& frame, const Vec& h);
  void flatten(Random& random, double thin, double u);
};

/// Two-sided. Without area it is the segment or point that it covers.
struct Triangle {
  static constexpr ShapeKind kKind = ShapeKind::kTriangle;
  static constexpr double kSpread = 0.4;  // it fills nothing of the box about it
  Vec v0, v1, v2;

  template <class Self, class F>
  static void fields(Self& s, F&& f) {
    f(Field::kPoint, s.v0), f(Field::kPoint, s.v1), f(Field::kPoint, s.v2);
  }
  [[nodiscard]] Vec center() const;
  [[nodiscard]] double support(const Vec& n) const;
  [[nodiscard]] double distance(const Vec& p) const;
  [[nodiscard]] double extent() const;
  [[nodiscard]] double largest() const;
  static Triangle build(Random& random, const Frame& frame, const Build& build);
  static Triangle whole(Lengths& lengths);
  static Triangle body(Random& random, const Frame& frame, const Vec& h);
  void flatten(Random& random, double thin, double u);
};

/// Caps at c +- half_height * axis: discs of `radius` perpendicular to the axis. The axis need not
/// have exactly unit length.
struct Cylinder {
  static constexpr ShapeKind kKind = ShapeKind::kCylinder;
  static constexpr double kSpread = 1;
  Vec c, axis;
  double half_height, radius;

  template <class Self, class F>
  static void fields(Self& s, F&& f) {
    f(Field::kPoint, s.c), f(Field::kAxis, s.axis);
    f(Field::kSize, s.half_height), f(Field::kSize, s.radius);
  }
  [[nodiscard]] Vec center() const;
  [[nodiscard]] double support(const Vec& n) const;
  [[nodiscard]] double distance(const Vec& p) const;
  [[nodiscard]] double extent() const;
  [[nodiscard]] double largest() const;
  static Cylinder build(Random& random, const Frame& frame, const Build& build);
  static Cylinder whole(Lengths& lengths);
  static Cylinder body(Random& random, const Frame& frame, const Vec& h);
  void flatten(Random& random, double thin, double u);
};

/// The points x with n.x = d, a two-sided surface; as a half-space the points with n.x <= d.
struct Plane {
  static constexpr ShapeKind kKind = ShapeKind::kPlane;
  static constexpr double kSpread = 1;
  Vec n;
  double d;
  bool half_space = false;

  template <class Self, class F>
  static void fields(Self& s, F&& f) {
    f(Field::kNormal, s.n), f(Field::kLevel, s.d);
  }
  [[nodiscard]] Vec center() const;
  [[nodiscard]] double support(const Vec& n) const;
  [[nodiscard]] double distance(const Vec& p) const;
  [[nodiscard]] double extent() const;
  [[nodiscard]] double largest() const;
  static Plane build(Random& random, const Frame& frame, const Build& build);
  static Plane whole(Lengths& lengths);
};

/// o + t d for tmin <= t <= tmax.
struct Ray {
  Vec o, d;
  double tmin, tmax;

  template <class Self, class F>
  static void fields(Self& s, F&& f) {
    f(Field::kPoint, s.o), f(Field::kAxis, s.d);
    f(Field::kBound, s.tmin), f(Field::kBound, s.tmax);
  }
};

/// A shape that has a signed distance.
using Shape = std::variant<Triangle, Sphere, Aabb, Plane, Cylinder, Obb>;
static_assert(std::variant_size_v<Shape> + 1 == cde::kShapes, "every shape but the ray");

/// Calls `use.operator()<S>()` with the struct of the kind. Throws std::invalid_argument for a ray.
template <std::size_t I = 0, class Use>
decltype(auto) with_kind(ShapeKind kind, const Use& use) {
  using S = std::variant_alternative_t<I, Shape>;
  if (kind == S::kKind) return use.template operator()<S>();
  if constexpr (I + 1 < std::variant_size_v<Shape>)
    return with_kind<I + 1>(kind, use);
  else
    throw std::invalid_argument("a ray is not a convex operand");
}

/// Words of a slot: ray 8, triangle 9, sphere 4, AABB 6, plane 4, cylinder 8, OBB 15.
[[nodiscard]] std::size_t word_count(ShapeKind kind);

/// A shape from the words of a slot, in slot order (an OBB's rotation row by row). Throws
/// std::invalid_argument if the count is wrong or the kind is a ray.
[[nodiscard]] Shape shape_from_words(ShapeKind kind, std::span<const double> words);
[[nodiscard]] Ray ray_from_words(std::span<const double> words);

/// The words of a slot, each rounded to the format.
[[nodiscard]] std::vector<double> to_words(const Shape& shape, const Format& format = {});
[[nodiscard]] std::vector<double> to_words(const Ray& ray, const Format& format = {});

/// The shape translated; rotated about the world's origin; or scaled. Rotation throws
/// std::invalid_argument for an AABB.
[[nodiscard]] Shape moved(const Shape& shape, const Vec& by);
[[nodiscard]] Shape turned(const Shape& shape, const Frame& by);
[[nodiscard]] Shape scaled(const Shape& shape, double by);

/// Centre of the shape: of a box, sphere or cylinder its centre, of a triangle its centroid, of a
/// plane its point nearest the world's origin.
[[nodiscard]] Vec center(const Shape& shape);

/// h(n) = max n.x over the shape; infinite for a plane unless n is its normal or, for a surface,
/// the opposite of it.
[[nodiscard]] double support(const Shape& shape, const Vec& n);

/// Distance from p to the shape, 0 inside. It is at most one part in 1e12 above the truth.
[[nodiscard]] double distance(const Vec& p, const Shape& shape);

/// S = |cB - cA|_1 + the extents of both shapes. The extent is r for a sphere, the sum of half
/// extents for a box, h + r for a cylinder, the largest |v - centroid|_1 for a triangle. With a
/// plane |cB - cA|_1 is |c|_1 + |d|, since n.c - d can cancel no earlier.
[[nodiscard]] double scene_size(const Shape& a, const Shape& b);

/// L: the largest |coordinate| of centres, corners and vertices.
[[nodiscard]] double largest_coordinate(const Shape& a, const Shape& b);

}  // namespace cde::oracle
