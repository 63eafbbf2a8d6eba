// SPDX-License-Identifier: Apache-2.0
#include "cde/geometry/primitives.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <type_traits>

#include "cde/fp/scalars.hpp"
#include "cde/geometry/check.hpp"
#include "cde/geometry/transform.hpp"
#include "cde/support/error.hpp"

namespace cde {
namespace {

using Defect = std::optional<std::string>;

/// "origin.x", "rotation[1][2]", "radius".
std::string word_name(const char* field, int k, Eigen::Index words) {
  if (words == 1) return field;
  if (words == 3) return fmt::format("{}.{}", field, "xyz"[k]);
  return fmt::format("{}[{}][{}]", field, k / 3, k % 3);
}

template <class S, class Field>
constexpr Eigen::Index kWordsOf = [] {
  if constexpr (std::is_same_v<Field, S>)
    return 1;
  else
    return Field::SizeAtCompileTime;
}();

bool is_interval(std::string_view name) {
  return name == "tmin" || name == "tmax";
}

/// The first word that is not finite, or a length that is too large; an interval's end may be
/// infinite.
template <class P>
Defect bad_word(const P& primitive) {
  using S = typename P::Scalar;
  Defect why;
  P::visit(primitive, [&](const char* name, const auto& field) {
    using Field = std::remove_cvref_t<decltype(field)>;
    const std::string_view units[] = {"normal", "axis", "rotation"};
    const bool may_be_infinite = is_interval(name);
    const bool length =
        !may_be_infinite && std::find(std::begin(units), std::end(units), name) == std::end(units);
    const auto look = [&](int k, S word) {
      using std::isnan;
      if (why || (may_be_infinite && !isnan(word))) return;
      const auto value = static_cast<float>(word);
      const bool finite = reference::finite(word);
      // Names are made of words that are bad alone: every upload looks at all of them.
      if (finite && (!length || reference::kLengths<S>.is_coordinate(value))) return;
      const std::string which = word_name(name, k, kWordsOf<S, Field>);
      why = finite ? reference::kLengths<S>.not_coordinate(which, value)
                   : fmt::format("{} is {}", which, value);
    };
    if constexpr (std::is_same_v<Field, S>) {
      look(0, field);
    } else {
      for (int k = 0; k < field.size(); ++k) look(k, field(k / field.cols(), k % field.cols()));
    }
  });
  return why;
}

template <class S>
Defect not_size(std::string_view name, S value) {
  return reference::kLengths<S>.not_size(name, static_cast<float>(value));
}

template <class S>
Defect not_unit(std::string_view name, const Vector3<S>& v) {
  if (reference::dot_is<S>(v, v, 1)) return std::nullopt;
  return fmt::format("{} has squared length {}, must be 1 within {:.3g}", name,
                     static_cast<float>(reference::dot<S>(v, v)), reference::kUnitTolerance<S>);
}

template <class S>
Defect not_orthonormal(const Matrix3<S>& rotation) {
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      const Vector3<S> a = rotation.col(i), b = rotation.col(j);
      if (!reference::dot_is<S>(a, b, i == j))
        return fmt::format(
            "rotation is not orthonormal: the product of columns {} and {} is {}, must be {} "
            "within {:.3g}",
            i, j, static_cast<float>(reference::dot<S>(a, b)), i == j ? 1 : 0,
            reference::kUnitTolerance<S>);
    }
  }
  return std::nullopt;
}

template <class S>
Defect bad_whole(const BasicRay<S>& ray) {
  const float largest =
      std::max({std::abs(static_cast<float>(ray.d.x())), std::abs(static_cast<float>(ray.d.y())),
                std::abs(static_cast<float>(ray.d.z()))});
  if (largest == 0) return "direction is zero";
  return not_size("largest component of direction", S(largest));
}

template <class S>
Defect bad_whole(const BasicTriangle<S>&) {
  return std::nullopt;
}

template <class S>
Defect bad_whole(const BasicSphere<S>& sphere) {
  return not_size("radius", sphere.r);
}

template <class S>
Defect bad_whole(const BasicAabb<S>& box) {
  for (int k = 0; k < 3; ++k) {
    if (!(box.min[k] < box.max[k]))
      return fmt::format("max.{0} is {1}, must be > min.{0} = {2}", "xyz"[k],
                         static_cast<float>(box.max[k]), static_cast<float>(box.min[k]));
  }
  return std::nullopt;
}

template <class S>
Defect bad_whole(const BasicPlane<S>& plane) {
  return not_unit<S>("normal", plane.n);
}

template <class S>
Defect bad_whole(const BasicCylinder<S>& cylinder) {
  if (auto why = not_unit<S>("axis", cylinder.axis)) return why;
  if (auto why = not_size("half height", cylinder.half_height)) return why;
  return not_size("radius", cylinder.radius);
}

template <class S>
Defect bad_whole(const BasicObb<S>& box) {
  for (int k = 0; k < 3; ++k)
    if (!reference::kLengths<S>.is_size(static_cast<float>(box.half[k])))
      return not_size(fmt::format("half extent.{}", "xyz"[k]), box.half[k]);
  return not_orthonormal<S>(box.rotation);
}

template <class S>
Defect bad_whole(const BasicTransform<S>& transform) {
  return not_orthonormal<S>(transform.rotation);
}

template <class P>
Defect why_bad(const P& primitive) {
  if (auto why = bad_word(primitive)) return why;
  return bad_whole(primitive);
}

/// The first finite word whose nearest number of the format is infinite.
template <class S, class P>
Defect overflow(const P& primitive) {
  Defect why;
  P::visit(primitive, [&](const char* name, const auto& field) {
    using Field = std::remove_cvref_t<decltype(field)>;
    const auto look = [&](int k, float word) {
      using std::isinf;
      if (!why && std::isfinite(word) && isinf(S(word)))
        why = fmt::format("{} is {}, beyond the largest number, {}",
                          word_name(name, k, kWordsOf<float, Field>), word,
                          static_cast<float>(std::numeric_limits<S>::max()));
    };
    if constexpr (std::is_same_v<Field, float>) {
      look(0, field);
    } else {
      for (int k = 0; k < field.size(); ++k) look(k, field(k / field.cols(), k % field.cols()));
    }
  });
  return why;
}

template <class P>
Defect why_bad_in(FpFormat format, const P& primitive) {
  if (format == FpFormat{}) return why_bad(primitive);
  Defect why;
  const bool known = with_scalar(format, [&]<class S>() {
    why = overflow<S>(primitive);
    if (!why) why = why_bad(primitive_cast<S>(primitive));
  });
  if (!known)
    throw Error(ErrorCode::kUsage, fmt::format("there are no primitives in {}", format.name()));
  if (why) *why += " in " + format.name();
  return why;
}

template <class P>
void check_any(const P& primitive, std::string_view what) {
  if (const auto why = defect(primitive)) {
    throw Error(ErrorCode::kBadInput, fmt::format("{}: {}", what, *why));
  }
}

}  // namespace

Defect defect(const Ray& ray, FpFormat format) {
  return why_bad_in(format, ray);
}
Defect defect(const Triangle& triangle, FpFormat format) {
  return why_bad_in(format, triangle);
}
Defect defect(const Sphere& sphere, FpFormat format) {
  return why_bad_in(format, sphere);
}
Defect defect(const Aabb& box, FpFormat format) {
  return why_bad_in(format, box);
}
Defect defect(const Plane& plane, FpFormat format) {
  return why_bad_in(format, plane);
}
Defect defect(const Cylinder& cylinder, FpFormat format) {
  return why_bad_in(format, cylinder);
}
Defect defect(const Obb& box, FpFormat format) {
  return why_bad_in(format, box);
}
Defect defect(const Transform& transform, FpFormat format) {
  return why_bad_in(format, transform);
}

std::optional<std::string> LengthRange::not_coordinate(std::string_view word, double value) const {
  if (is_coordinate(value)) return std::nullopt;
  return fmt::format("{} is {:.9g}, must be at most 2^{} in size", word, value, high);
}

std::optional<std::string> LengthRange::not_size(std::string_view word, double value) const {
  if (is_size(value)) return std::nullopt;
  if (!(value > 0)) return fmt::format("{} is {:.9g}, must be > 0", word, value);
  return fmt::format("{} is {:.9g}, must be 2^{} to 2^{}", word, value, low, high);
}

void check(const Ray& ray, std::string_view what) {
  check_any(ray, what);
}
void check(const Triangle& triangle, std::string_view what) {
  check_any(triangle, what);
}
void check(const Sphere& sphere, std::string_view what) {
  check_any(sphere, what);
}
void check(const Aabb& box, std::string_view what) {
  check_any(box, what);
}
void check(const Plane& plane, std::string_view what) {
  check_any(plane, what);
}
void check(const Cylinder& cylinder, std::string_view what) {
  check_any(cylinder, what);
}
void check(const Obb& box, std::string_view what) {
  check_any(box, what);
}

}  // namespace cde
