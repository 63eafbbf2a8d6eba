// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

#include "cde/fp/fp_format.hpp"

/// Geometric primitives as the card takes them: coordinates in one right-handed world frame, in
/// whatever length unit the scene uses. Every primitive is a plain value, a template over its
/// scalar (float, double, Fp<E, M>); the aliases without "Basic" are binary32. `defect` says
/// whether the card would refuse a primitive.
///
/// A primitive is also a sequence of kWords words, in the order in which a slot of the card and a
/// command line hold it: `visit` names the fields in that order, vectors x y z, matrices row by
/// row.
namespace cde {

template <class S>
using Vector3 = Eigen::Matrix<S, 3, 1>;
template <class S>
using Matrix3 = Eigen::Matrix<S, 3, 3>;

/// P(t) = o + t d for tmin <= t <= tmax.
template <class S>
struct BasicRay {
  using Scalar = S;
  static constexpr std::size_t kWords = 8;
  Vector3<S> o;   ///< origin, finite
  Vector3<S> d;   ///< direction, finite and not zero; need not be of unit length, so t counts
                  ///< in units of |d|
  S tmin = S{0};  ///< start of the interval; may be negative or infinite, never NaN
  S tmax = std::numeric_limits<S>::infinity();  ///< end, likewise; tmin > tmax is legal: an empty
                                                ///< interval that meets nothing

  template <class Self, class Visit>
  static void visit(Self& self, Visit&& field) {
    field("origin", self.o), field("direction", self.d);
    field("tmin", self.tmin), field("tmax", self.tmax);
  }
};

/// Two-sided triangle; front and back hit alike. Any finite corners are legal: to a ray a triangle
/// without area is never hit, to the other primitives it is the segment or point that it covers.
template <class S>
struct BasicTriangle {
  using Scalar = S;
  static constexpr std::size_t kWords = 9;
  Vector3<S> v0;
  Vector3<S> v1;
  Vector3<S> v2;

  template <class Self, class Visit>
  static void visit(Self& self, Visit&& field) {
    field("v0", self.v0), field("v1", self.v1), field("v2", self.v2);
  }
};

/// The ball |x - c| <= r.
template <class S>
struct BasicSphere {
  using Scalar = S;
  static constexpr std::size_t kWords = 4;
  Vector3<S> c;  ///< centre, finite
  S r;           ///< radius, finite and > 0

  template <class Self, class Visit>
  static void visit(Self& self, Visit&& field) {
    field("center", self.c), field("radius", self.r);
  }
};

/// Axis-aligned box min <= x <= max.
template <class S>
struct BasicAabb {
  using Scalar = S;
  static constexpr std::size_t kWords = 6;
  Vector3<S> min;  ///< lower corner, finite
  Vector3<S> max;  ///< upper corner, finite, > min on every axis

  template <class Self, class Visit>
  static void visit(Self& self, Visit&& field) {
    field("min", self.min), field("max", self.max);
  }
};

/// The points x with n.x = d.
template <class S>
struct BasicPlane {
  using Scalar = S;
  static constexpr std::size_t kWords = 4;
  Vector3<S> n;  ///< unit normal
  S d;           ///< signed distance of the plane from the world's origin along n, finite

  template <class Self, class Visit>
  static void visit(Self& self, Visit&& field) {
    field("normal", self.n), field("d", self.d);
  }
};

/// Solid cylinder with flat caps: |a.(x - c)| <= half_height and within `radius` of the axis.
template <class S>
struct BasicCylinder {
  using Scalar = S;
  static constexpr std::size_t kWords = 8;
  Vector3<S> c;     ///< centre, finite
  Vector3<S> axis;  ///< unit vector a
  S half_height;    ///< finite and > 0
  S radius;         ///< finite and > 0

  template <class Self, class Visit>
  static void visit(Self& self, Visit&& field) {
    field("center", self.c), field("axis", self.axis);
    field("half height", self.half_height), field("radius", self.radius);
  }
};

/// Oriented box: x_world = c + R x_local with |x_local| <= half on every axis. The columns of R are
/// the box axes; the words are row by row, so that axis i is words 6+i, 9+i, 12+i.
template <class S>
struct BasicObb {
  using Scalar = S;
  static constexpr std::size_t kWords = 15;
  Vector3<S> c;         ///< centre, finite
  Vector3<S> half;      ///< half extents along the box axes, finite and > 0
  Matrix3<S> rotation;  ///< orthonormal; a reflection (determinant -1) is the same box, and legal

  template <class Self, class Visit>
  static void visit(Self& self, Visit&& field) {
    field("center", self.c), field("half extent", self.half), field("rotation", self.rotation);
  }
};

using Ray = BasicRay<float>;
using Triangle = BasicTriangle<float>;
using Sphere = BasicSphere<float>;
using Aabb = BasicAabb<float>;
using Plane = BasicPlane<float>;
using Cylinder = BasicCylinder<float>;
using Obb = BasicObb<float>;

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

/// The primitive of words in slot order; nothing is checked.
template <class P>
[[nodiscard]] P from_words(std::span<const typename P::Scalar, P::kWords> words) {
  P primitive;
  std::size_t i = 0;
  visit_words(primitive, [&](const char*, int, auto& word) { word = words[i++]; });
  return primitive;
}

/// The primitive in another scalar, every word rounded once.
template <class T, template <class> class P, class S>
[[nodiscard]] P<T> primitive_cast(const P<S>& primitive) {
  std::array<T, P<S>::kWords> words;
  std::size_t i = 0;
  visit_words(primitive,
              [&](const char*, int, const S& word) { words[i++] = static_cast<T>(word); });
  return from_words<P<T>>(words);
}

/// Why a card would flag this primitive as bad input ("direction is zero"), or nothing if it is
/// valid. Says the same as reference::bad (geometry/check.hpp), in words. Cards of another number
/// format get the nearest numbers of it: what is looked at are those, and a finite number that the
/// format has none for is a defect, too ("tmax is 70000, beyond the largest number, 65504 in
/// fp16"). Error kUsage for a format that is none of kPairFormats (fp/scalars.hpp).
[[nodiscard]] std::optional<std::string> defect(const Ray& ray, FpFormat format = {});
[[nodiscard]] std::optional<std::string> defect(const Triangle& triangle, FpFormat format = {});
[[nodiscard]] std::optional<std::string> defect(const Sphere& sphere, FpFormat format = {});
[[nodiscard]] std::optional<std::string> defect(const Aabb& box, FpFormat format = {});
[[nodiscard]] std::optional<std::string> defect(const Plane& plane, FpFormat format = {});
[[nodiscard]] std::optional<std::string> defect(const Cylinder& cylinder, FpFormat format = {});
[[nodiscard]] std::optional<std::string> defect(const Obb& box, FpFormat format = {});

/// Throws Error(kBadInput, "WHAT: reason") if the primitive has a defect.
void check(const Ray& ray, std::string_view what);
void check(const Triangle& triangle, std::string_view what);
void check(const Sphere& sphere, std::string_view what);
void check(const Aabb& box, std::string_view what);
void check(const Plane& plane, std::string_view what);
void check(const Cylinder& cylinder, std::string_view what);
void check(const Obb& box, std::string_view what);

}  // namespace cde
