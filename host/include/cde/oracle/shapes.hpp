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

/// The shapes of the oracles, in binary64. They stand apart from the library's own primitives on
/// purpose: nothing here shares code with what it judges. Operands of at most 53 bits are exact.
/// World frame, one length unit throughout.
namespace cde::oracle {

using Vec = Eigen::Vector3d;
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

class Random;
struct Build;
struct Lengths;
using Frame = Eigen::Matrix3d;  ///< columns: the axes of a shape in the world
using ShapeKind = cde::Shape;   // their names and numbers; what they are is said here

/// What a field of a shape is: it says what moving, turning and scaling do to it.
enum class Field {
  kPoint,   ///< moves, turns, scales
  kCorner,  ///< of an AABB: does not turn
  kAxis,    ///< turns
  kNormal,  ///< of a plane: turns, and the level behind it moves along it
  kLevel,   ///< of a plane: scales
  kSize,    ///< one or three: scales
  kFrame,   ///< turns
  kBound    ///< of a ray: nothing
};

/// The struct of a shape and its part of shapes.cpp hold everything about it, but for the core that
/// gap.cpp makes of it. Each has `fields` in the order of the words of a slot; center, support and
/// distance as below; its extent and largest coordinate in the measures S and L; and random ones
/// about the origin: build (see build_shape), whole (lengths from about 1 to 5, along the axes) and
/// body (of a scene, of half sizes `h`). kSpread is the distance at which about half of random
/// pairs meet, as a fraction of the sum of half widths.

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

/// Two-sided; without area it is the segment or point that it covers.
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

/// Caps at c +- half_height * axis, discs of `radius` perpendicular to the axis. The axis need not
/// be exactly of unit length.
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

/// The points x with n.x = d, a surface with two sides; or, as a half-space, those with n.x <= d.
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

/// Whatever has a signed gap.
using Shape = std::variant<Triangle, Sphere, Aabb, Plane, Cylinder, Obb>;
static_assert(std::variant_size_v<Shape> + 1 == cde::kShapes, "every shape but the ray");

/// use.operator()<S>() with the struct of the kind; throws std::invalid_argument for a ray.
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

/// The shape translated; rotated about the world's origin (throws std::invalid_argument for an
/// AABB); with all lengths multiplied.
[[nodiscard]] Shape moved(const Shape& shape, const Vec& by);
[[nodiscard]] Shape turned(const Shape& shape, const Frame& by);
[[nodiscard]] Shape scaled(const Shape& shape, double by);

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
