// SPDX-License-Identifier: Apache-2.0
#include "cde/geometry/primitives.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "cde/geometry/check.hpp"
#include "cde/geometry/transform.hpp"
#include "cde/support/error.hpp"

namespace cde {
namespace {

using Defect = std::optional<std::string>;
constexpr LengthRange kLengths = reference::kLengths<float>;

/// "origin.x", "rotation[1][2]", "radius".
template <typename Field>
std::string word_name(const char* field, int k, const Field&) {
  if constexpr (std::is_same_v<Field, float>) return field;
  if constexpr (std::is_same_v<Field, Eigen::Vector3f>)
    return fmt::format("{}.{}", field, "xyz"[k]);
  if constexpr (std::is_same_v<Field, Eigen::Matrix3f>)
    return fmt::format("{}[{}][{}]", field, k / 3, k % 3);
}

/// The first word that is not finite, or a length that is too large; an interval's end may be
/// infinite.
template <typename P>
Defect bad_word(const P& primitive) {
  Defect why;
  P::visit(primitive, [&](const char* name, const auto& field) {
    const std::string_view interval[] = {"tmin", "tmax"};
    const std::string_view units[] = {"normal", "axis", "rotation"};
    const bool may_be_infinite = name == interval[0] || name == interval[1];
    const bool length =
        !may_be_infinite && std::find(std::begin(units), std::end(units), name) == std::end(units);
    const auto look = [&](int k, float word) {
      if (why || (may_be_infinite && !std::isnan(word))) return;
      const std::string which = word_name(name, k, field);
      if (!std::isfinite(word))
        why = fmt::format("{} is {}", which, word);
      else if (length)
        why = kLengths.not_coordinate(which, word);
    };
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(field)>, float>) {
      look(0, field);
    } else {
      for (int k = 0; k < field.size(); ++k) look(k, field(k / field.cols(), k % field.cols()));
    }
  });
  return why;
}

Defect not_size(std::string_view name, float value) {
  return kLengths.not_size(name, value);
}

Defect not_unit(std::string_view name, const Eigen::Vector3f& v) {
  if (reference::dot_is<float>(v, v, 1)) return std::nullopt;
  return fmt::format("{} has squared length {}, must be 1 within {:.3g}", name,
                     reference::dot<float>(v, v), reference::kUnitTolerance<float>);
}

Defect not_orthonormal(const Eigen::Matrix3f& rotation) {
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      const Eigen::Vector3f a = rotation.col(i), b = rotation.col(j);
      if (!reference::dot_is<float>(a, b, i == j))
        return fmt::format(
            "rotation is not orthonormal: the product of columns {} and {} is {}, must be {} "
            "within {:.3g}",
            i, j, reference::dot<float>(a, b), i == j ? 1 : 0, reference::kUnitTolerance<float>);
    }
  }
  return std::nullopt;
}

template <typename Primitive>
void check_any(const Primitive& primitive, std::string_view what) {
  if (const auto why = defect(primitive)) {
    throw Error(ErrorCode::kBadInput, fmt::format("{}: {}", what, *why));
  }
}

}  // namespace

Defect defect(const Ray& ray) {
  if (auto why = bad_word(ray)) return why;
  const float largest = ray.d.cwiseAbs().maxCoeff();
  if (largest == 0) return "direction is zero";
  return not_size("largest component of direction", largest);
}

Defect defect(const Triangle& triangle) {
  return bad_word(triangle);
}

Defect defect(const Sphere& sphere) {
  if (auto why = bad_word(sphere)) return why;
  return not_size("radius", sphere.r);
}

Defect defect(const Aabb& box) {
  if (auto why = bad_word(box)) return why;
  for (int k = 0; k < 3; ++k) {
    if (!(box.min[k] < box.max[k]))
      return fmt::format("max.{0} is {1}, must be > min.{0} = {2}", "xyz"[k], box.max[k],
                         box.min[k]);
  }
  return std::nullopt;
}

Defect defect(const Plane& plane) {
  if (auto why = bad_word(plane)) return why;
  return not_unit("normal", plane.n);
}

Defect defect(const Cylinder& cylinder) {
  if (auto why = bad_word(cylinder)) return why;
  if (auto why = not_unit("axis", cylinder.axis)) return why;
  if (auto why = not_size("half height", cylinder.half_height)) return why;
  return not_size("radius", cylinder.radius);
}

Defect defect(const Obb& box) {
  if (auto why = bad_word(box)) return why;
  for (int k = 0; k < 3; ++k)
    if (auto why = not_size(fmt::format("half extent.{}", "xyz"[k]), box.half[k])) return why;
  return not_orthonormal(box.rotation);
}

Defect defect(const Transform& transform) {
  if (auto why = bad_word(transform)) return why;
  return not_orthonormal(transform.rotation);
}

std::optional<std::string> LengthRange::not_coordinate(std::string_view word, double value) const {
  if (std::abs(value) <= std::ldexp(1, high)) return std::nullopt;
  return fmt::format("{} is {:.9g}, must be at most 2^{} in size", word, value, high);
}

std::optional<std::string> LengthRange::not_size(std::string_view word, double value) const {
  if (std::ldexp(1, low) <= value && value <= std::ldexp(1, high)) return std::nullopt;
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
