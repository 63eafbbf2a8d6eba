// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "cde/contract/pairs.hpp"
#include "cde/fp/fp_format.hpp"

/// @file
/// Geometric primitives as the card takes them: coordinates in one right-handed world frame, in the
/// length unit of the scene. Each primitive is a plain value, a template over its scalar (float,
/// double, Fp<E, M>). The aliases without "Basic" are binary32. `defect` tells whether the card
/// would refuse a primitive.
///
/// A primitive is also a sequence of kWords words, in the order of a card slot and of the command
/// line. `visit` names the fields in that order: vectors x y z, matrices row by row. All words of a
/// field have the same kind, given by the contract's table.
///
/// The struct of a shape holds everything about it, and ShapeList lists the structs. Beside its
/// fields a shape has these members:
/// `kShape` is its code. `middle()` is the point about which it turns when it moves by itself.
/// `random()` is a random shape, made from calls of `draws` in a fixed order (point, around(c),
/// direction, size, rotation). `kReach` says how far a random shape reaches from its middle, in the
/// mean over directions; shapes without a size lack it. `kDrawn` says how a picture draws it, with
/// placed() or triangles().
namespace cde {

template <class S>
using Vector3 = Eigen::Matrix<S, 3, 1>;
template <class S>
using Matrix3 = Eigen::Matrix<S, 3, 3>;

/// How a picture draws a shape. Solids are a placed unit solid. That is a ball of radius 1, a cube
/// from -1 to 1, or a cylinder of radius 1 from z = -1 to 1. A square from -1 to 1 in z = 0
/// represents a whole plane.
enum class Drawn : unsigned { kRays, kSurface, kBall, kBox, kPlane, kCylinder };

/// Placement x -> m x + t of a unit solid.
struct Placement {
  Eigen::Matrix3f m = Eigen::Matrix3f::Identity();
  Eigen::Vector3f t = Eigen::Vector3f::Zero();
};

/// An orthonormal frame whose third column is `axis`.
template <class S>
[[nodiscard]] Matrix3<S> frame_around(const Vector3<S>& axis) {
  const Vector3<S> z = axis.normalized(), x = z.unitOrthogonal();
  Matrix3<S> frame;
  frame << x, z.cross(x), z;
  return frame;
}

/// P(t) = o + t d for tmin <= t <= tmax.
template <class S>
struct BasicRay {
  using Scalar = S;
  static constexpr Shape kShape = Shape::kRay;
  static constexpr std::size_t kWords = contract::words(kShape);
  static constexpr Drawn kDrawn = Drawn::kRays;
  Vector3<S> o;  ///< origin, finite
  /// Direction, finite and not zero; its length is free, and t counts in units of |d|.
  Vector3<S> d;
  S tmin = S{0};  ///< start of the interval; may be negative or infinite, never NaN
  S tmax = std::numeric_limits<S>::infinity();  ///< end, likewise. tmin > tmax is legal: an empty
                                                ///< interval that never hits

  template <class Self, class Visit>
  static void visit(Self& self, Visit&& field) {
    field("origin", self.o), field("direction", self.d);
    field("tmin", self.tmin), field("tmax", self.tmax);
  }

  [[nodiscard]] Vector3<S> middle() const { return o; }
  template <class Draws>
  static BasicRay random(Draws& draws) {
    return {draws.point(), draws.direction()};
  }
};

/// Two-sided triangle: front and back hit alike. Any finite corners are legal. A ray never hits a
/// triangle without area. To the other primitives it is the segment or point that it covers.
template <class S>
struct BasicTriangle {
  using Scalar = S;
  static constexpr Shape kShape = Shape::kTriangle;
  static constexpr std::size_t kWords = contract::words(kShape);
  static constexpr float kReach = 0.5f;
  static constexpr Drawn kDrawn = Drawn::kSurface;
  Vector3<S> v0;
  Vector3<S> v1;
  Vector3<S> v2;

  template <class Self, class Visit>
  static void visit(Self& self, Visit&& field) {
    field("v0", self.v0), field("v1", self.v1), field("v2", self.v2);
  }

  [[nodiscard]] Vector3<S> middle() const { return (v0 + v1 + v2) / S{3}; }
  template <class Draws>
  static BasicTriangle random(Draws& draws) {
    const Vector3<S> c = draws.point();
    return {draws.around(c), draws.around(c), draws.around(c)};
  }
  [[nodiscard]] std::array<BasicTriangle, 1> triangles() const { return {*this}; }
};

/// The ball |x - c| <= r.
template <class S>
struct BasicSphere {
  using Scalar = S;
  static constexpr Shape kShape = Shape::kSphere;
  static constexpr std::size_t kWords = contract::words(kShape);
  static constexpr float kReach = 1.0f;
  static constexpr Drawn kDrawn = Drawn::kBall;
  Vector3<S> c;  ///< centre, finite
  S r;           ///< radius, finite and > 0

  template <class Self, class Visit>
  static void visit(Self& self, Visit&& field) {
    field("center", self.c), field("radius", self.r);
  }

  [[nodiscard]] Vector3<S> middle() const { return c; }
  template <class Draws>
  static BasicSphere random(Draws& draws) {
    return {draws.point(), draws.size()};
  }
  [[nodiscard]] Placement placed() const { return {r * Matrix3<S>::Identity(), c}; }
};

/// Axis-aligned box min <= x <= max.
template <class S>
struct BasicAabb {
  using Scalar = S;
  static constexpr Shape kShape = Shape::kAabb;
  static constexpr std::size_t kWords = contract::words(kShape);
  static constexpr float kReach = 1.3f;
  static constexpr Drawn kDrawn = Drawn::kBox;
  Vector3<S> min;  ///< lower corner, finite
  Vector3<S> max;  ///< upper corner, finite, > min on every axis

  template <class Self, class Visit>
  static void visit(Self& self, Visit&& field) {
    field("min", self.min), field("max", self.max);
  }

  /// The first axis for which max is not above min.
  [[nodiscard]] std::optional<int> first_disordered_axis() const {
    for (int k = 0; k < 3; ++k)
      if (!static_cast<bool>(min[k] < max[k])) return k;
    return std::nullopt;
  }
  [[nodiscard]] Vector3<S> middle() const { return (min + max) / S{2}; }
  template <class Draws>
  static BasicAabb random(Draws& draws) {
    const Vector3<S> c = draws.point(), half{draws.size(), draws.size(), draws.size()};
    return {c - half, c + half};
  }
  [[nodiscard]] Placement placed() const {
    return {(S{0.5} * (max - min)).asDiagonal(), S{0.5} * (min + max)};
  }
};

/// The points x with n.x = d.
template <class S>
struct BasicPlane {
  using Scalar = S;
  static constexpr Shape kShape = Shape::kPlane;
  static constexpr std::size_t kWords = contract::words(kShape);
  static constexpr Drawn kDrawn = Drawn::kPlane;
  Vector3<S> n;  ///< unit normal
  S d;           ///< signed distance of the plane from the world's origin along n, finite

  template <class Self, class Visit>
  static void visit(Self& self, Visit&& field) {
    field("normal", self.n), field("d", self.d);
  }

  [[nodiscard]] Vector3<S> middle() const { return n * d; }
  template <class Draws>
  static BasicPlane random(Draws& draws) {
    const Vector3<S> normal = draws.direction();
    return {normal, normal.dot(draws.point())};
  }
  [[nodiscard]] Placement placed() const { return {frame_around(n), d * n}; }
};

/// Solid cylinder with flat caps: |a.(x - c)| <= half_height and within `radius` of the axis.
template <class S>
struct BasicCylinder {
  using Scalar = S;
  static constexpr Shape kShape = Shape::kCylinder;
  static constexpr std::size_t kWords = contract::words(kShape);
  static constexpr float kReach = 1.3f;
  static constexpr Drawn kDrawn = Drawn::kCylinder;
  Vector3<S> c;     ///< centre, finite
  Vector3<S> axis;  ///< unit vector a
  S half_height;    ///< finite and > 0
  S radius;         ///< finite and > 0

  template <class Self, class Visit>
  static void visit(Self& self, Visit&& field) {
    field("center", self.c), field("axis", self.axis);
    field("half height", self.half_height), field("radius", self.radius);
  }

  [[nodiscard]] Vector3<S> middle() const { return c; }
  template <class Draws>
  static BasicCylinder random(Draws& draws) {
    return {draws.point(), draws.direction(), draws.size(), draws.size()};
  }
  [[nodiscard]] Placement placed() const {
    return {frame_around(axis) * Vector3<S>(radius, radius, half_height).asDiagonal(), c};
  }
};

/// Oriented box: x_world = c + R x_local with |x_local| <= half on every axis. The columns of R are
/// the box axes. The words of R are row by row, so axis i is words 6+i, 9+i, 12+i.
template <class S>
struct BasicObb {
  using Scalar = S;
  static constexpr Shape kShape = Shape::kObb;
  static constexpr std::size_t kWords = contract::words(kShape);
  static constexpr float kReach = 1.3f;
  static constexpr Drawn kDrawn = Drawn::kBox;
  Vector3<S> c;         ///< centre, finite
  Vector3<S> half;      ///< half extents along the box axes, finite and > 0
  Matrix3<S> rotation;  ///< orthonormal; a reflection (determinant -1) is the same box, and legal

  template <class Self, class Visit>
  static void visit(Self& self, Visit&& field) {
    field("center", self.c), field("half extent", self.half), field("rotation", self.rotation);
  }

  [[nodiscard]] Vector3<S> middle() const { return c; }
  template <class Draws>
  static BasicObb random(Draws& draws) {
    return {draws.point(), {draws.size(), draws.size(), draws.size()}, draws.rotation()};
  }
  [[nodiscard]] Placement placed() const { return {rotation * half.asDiagonal(), c}; }
};

/// Templates of shapes.
template <template <class> class... P>
struct ShapeTemplates {
  static constexpr std::size_t kCount = sizeof...(P);
  template <class S>
  using In = std::tuple<P<S>...>;  ///< the shapes in a scalar
  template <class S>
  using Lists = std::variant<std::vector<P<S>>...>;
};

/// All shapes, in the order of their codes.
using ShapeList = ShapeTemplates<BasicRay, BasicTriangle, BasicSphere, BasicAabb, BasicPlane,
                                 BasicCylinder, BasicObb>;
static_assert(ShapeList::kCount == kShapes, "every shape of the contract has its struct");
static_assert(
    []<std::size_t... k>(std::index_sequence<k...>) {
      return ((std::tuple_element_t<k, ShapeList::In<float>>::kShape == static_cast<Shape>(k)) &&
              ...);
    }(std::make_index_sequence<kShapes>()),
    "in the order of the codes");

/// Calls `use.operator()<P>()` with the shape of the code in the scalar S.
template <class S, std::size_t I = 0, class Use>
decltype(auto) with_shape(Shape shape, const Use& use) {
  using P = std::tuple_element_t<I, ShapeList::In<S>>;
  if constexpr (I + 1 == kShapes)
    return use.template operator()<P>();
  else
    return shape == P::kShape ? use.template operator()<P>() : with_shape<S, I + 1>(shape, use);
}

using Ray = BasicRay<float>;
using Triangle = BasicTriangle<float>;
using Sphere = BasicSphere<float>;
using Aabb = BasicAabb<float>;
using Plane = BasicPlane<float>;
using Cylinder = BasicCylinder<float>;
using Obb = BasicObb<float>;

/// Kinds of the words of a primitive or transform, one letter per word as in contract::kShapeTable.
template <class P>
inline constexpr std::string_view kKindsOf = [] {
  if constexpr (requires { P::kKinds; })
    return P::kKinds;
  else
    return contract::kShapeTable[static_cast<std::size_t>(P::kShape)].kinds;
}();

/// Calls look(name, kind, reference to the field) for every field in slot order.
template <class P, class Look>
void visit_fields(P& primitive, Look&& look) {
  using Plain = std::remove_const_t<P>;
  std::size_t first = 0;
  Plain::visit(primitive, [&](const char* name, auto& field) {
    look(name, contract::word_kind(kKindsOf<Plain>, first), field);
    if constexpr (requires { field.size(); })
      first += static_cast<std::size_t>(field.size());
    else
      ++first;
  });
}

/// Calls word(field name, number of the word in its field, reference to the word) for every word in
/// slot order.
template <class P, class Word>
void visit_words(P& primitive, Word&& word) {
  std::remove_const_t<P>::visit(primitive, [&](const char* name, auto& field) {
    using Field = std::remove_cvref_t<decltype(field)>;
    if constexpr (std::is_same_v<Field, typename P::Scalar>) {
      word(name, 0, field);
    } else {
      for (int row = 0, k = 0; row < field.rows(); ++row)
        for (int column = 0; column < field.cols(); ++column) word(name, k++, field(row, column));
    }
  });
}

/// Writes the words of a primitive in slot order.
template <class P>
void to_words(const P& primitive, std::span<typename P::Scalar, P::kWords> words) {
  std::size_t i = 0;
  visit_words(primitive, [&](const char*, int, const auto& word) { words[i++] = word; });
}

/// The words of a primitive in slot order.
template <class P>
[[nodiscard]] std::array<typename P::Scalar, P::kWords> to_words(const P& primitive) {
  std::array<typename P::Scalar, P::kWords> words;
  to_words(primitive, std::span{words});
  return words;
}

/// The primitive with these words in slot order. Nothing is checked.
template <class P>
[[nodiscard]] P from_words(std::span<const typename P::Scalar, P::kWords> words) {
  P primitive;
  std::size_t i = 0;
  visit_words(primitive, [&](const char*, int, auto& word) { word = words[i++]; });
  return primitive;
}

/// The primitive in another scalar, each word rounded once.
template <class T, template <class> class P, class S>
[[nodiscard]] P<T> primitive_cast(const P<S>& primitive) {
  std::array<T, P<S>::kWords> words;
  std::size_t i = 0;
  visit_words(primitive,
              [&](const char*, int, const S& word) { words[i++] = static_cast<T>(word); });
  return from_words<P<T>>(words);
}

/// Why a card would flag this primitive as bad input ("direction is zero"), or nothing if it is
/// valid. It agrees with reference::bad (geometry/check.hpp). For another number format the words
/// are first rounded to nearest. A finite number that is too large for the format is also a defect:
/// "tmax is 70000, above the largest number, 65504 in fp16". Error kUsage for a format not in
/// kPairFormats (fp/scalars.hpp).
[[nodiscard]] std::optional<std::string> defect(Shape shape, std::span<const float> words,
                                                FpFormat format = {});
template <class P>
requires requires {
  P::kShape;
}
[[nodiscard]] std::optional<std::string> defect(const P& primitive, FpFormat format = {}) {
  return defect(P::kShape, to_words(primitive), format);
}

/// Error kBadInput "WHAT: reason" if the primitive has a defect.
void check(Shape shape, std::span<const float> words, std::string_view what);
template <class P>
requires requires {
  P::kShape;
}
void check(const P& primitive, std::string_view what) {
  check(P::kShape, to_words(primitive), what);
}

}  // namespace cde
