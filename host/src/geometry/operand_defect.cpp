// SPDX-License-Identifier: Apache-2.0
#include "cde/geometry/operand_defect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <type_traits>

#include "cde/fp/scalars.hpp"
#include "cde/geometry/check.hpp"
#include "cde/support/error.hpp"

// reference::bad decides; what stands here finds the words for it.
namespace cde {
namespace {

using Why = std::optional<std::string>;

/// "radius", "center.x", "rotation[1][2]".
template <class Field>
std::string word_name(std::string_view field, int k) {
  if constexpr (std::is_class_v<Field>) {
    if constexpr (requires { Field::ColsAtCompileTime; }) {
      if constexpr (Field::ColsAtCompileTime == 3)
        return fmt::format("{}[{}][{}]", field, k / 3, k % 3);
      else
        return fmt::format("{}.{}", field, "xyz"[k]);
    }
  }
  return std::string(field);
}

/// The first word that must be another by itself. `primitive` is exact in double, whatever its
/// format, which has these lengths.
template <class P>
Why bad_word(const P& primitive, const LengthRange& lengths) {
  Why why;
  P::visit(primitive, [&](std::string_view name, const auto& field) {
    using Field = std::remove_cvref_t<decltype(field)>;
    const bool interval = name == "tmin" || name == "tmax";
    const bool pure = name == "normal" || name == "axis" || name == "rotation";
    const bool size = name == "radius" || name == "half height" || name == "half extent";
    const auto look = [&](int k, double word) {
      if (why) return;
      const std::string which = word_name<Field>(name, k);
      const char* must = nullptr;
      if (interval && std::isnan(word)) must = "must be a number or infinite";
      if (!interval && !std::isfinite(word)) must = "must be finite";
      if (must != nullptr)
        why = fmt::format("{} is {}, {}", which, word, must);
      else if (size)
        why = lengths.not_size(which, word);
      else if (!interval && !pure)
        why = lengths.not_coordinate(which, word);
    };
    if constexpr (std::is_same_v<Field, double>) {
      look(0, field);
    } else {
      for (int k = 0; k < static_cast<int>(field.size()); ++k)
        look(k, field(k / field.cols(), k % field.cols()));
    }
  });
  return why;
}

/// a.b, unless it is 0 or 1 as it must be.
template <class S>
Why bad_product(std::string_view what, const Vector3<S>& a, const Vector3<S>& b, int expected) {
  if (reference::dot_is<S>(a, b, expected)) return std::nullopt;
  return fmt::format("{} is {}, must be {} within {:.3g}", what, double(reference::dot<S>(a, b)),
                     expected, reference::kUnitTolerance<S>);
}

template <class S>
Why bad_whole(const BasicRay<S>& ray) {
  const double largest = std::max(
      {std::abs(double(ray.d.x())), std::abs(double(ray.d.y())), std::abs(double(ray.d.z()))});
  if (largest == 0) return "direction is zero, must have a length";
  return reference::kLengths<S>.not_size("largest component of direction", largest);
}
template <class S>
Why bad_whole(const BasicAabb<S>& box) {
  for (int k = 0; k < 3; ++k)
    if (!(box.min[k] < box.max[k]))
      return fmt::format("max.{0} is {1}, must be > min.{0} = {2}", "xyz"[k], double(box.max[k]),
                         double(box.min[k]));
  return std::nullopt;
}
template <class S>
Why bad_whole(const BasicPlane<S>& plane) {
  return bad_product<S>("squared length of normal", plane.n, plane.n, 1);
}
template <class S>
Why bad_whole(const BasicCylinder<S>& cylinder) {
  return bad_product<S>("squared length of axis", cylinder.axis, cylinder.axis, 1);
}
template <class S>
Why bad_whole(const BasicObb<S>& box) {
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j)
      if (auto why = bad_product<S>(
              fmt::format("rotation must be orthonormal: product of columns {} and {}", i, j),
              box.rotation.col(i), box.rotation.col(j), i == j))
        return why;
  return std::nullopt;
}
template <class P>
Why bad_whole(const P&) {
  return std::nullopt;
}

template <class P>
Why defect_of(std::span<const std::uint64_t> words) {
  P primitive;
  std::size_t i = 0;
  visit_words(primitive, [&](const char*, int, auto& word) {
    word = from_word<typename P::Scalar>(words[i++]);
  });
  if (!reference::bad(primitive)) return std::nullopt;
  using S = typename P::Scalar;
  if (auto why = bad_word(primitive_cast<double>(primitive), reference::kLengths<S>)) return why;
  return bad_whole(primitive);
}

template <class S>
Why defect_of_shape(std::string_view shape, std::span<const std::uint64_t> words) {
  if (shape == "ray") return defect_of<BasicRay<S>>(words);
  if (shape == "triangle") return defect_of<BasicTriangle<S>>(words);
  if (shape == "sphere") return defect_of<BasicSphere<S>>(words);
  if (shape == "aabb") return defect_of<BasicAabb<S>>(words);
  if (shape == "plane") return defect_of<BasicPlane<S>>(words);
  if (shape == "cylinder") return defect_of<BasicCylinder<S>>(words);
  return defect_of<BasicObb<S>>(words);
}

Why defect_in(FpFormat format, std::string_view shape, std::span<const std::uint64_t> words) {
  Why why;
  if (with_scalar(format, [&]<class S>() { why = defect_of_shape<S>(shape, words); })) return why;
  throw Error(ErrorCode::kUsage, fmt::format("no primitives in {}", format.name()));
}

}  // namespace

std::string operand_defect(Pair pair, FpFormat format, std::span<const std::uint64_t> a,
                           std::span<const std::uint64_t> b) {
  const std::string_view both = name(pair);
  const std::size_t dash = both.find('-');
  const std::string_view shape_a = both.substr(0, dash), shape_b = both.substr(dash + 1);
  if (const auto why = defect_in(format, shape_a, a)) return fmt::format("{} A: {}", shape_a, *why);
  if (const auto why = defect_in(format, shape_b, b)) return fmt::format("{} B: {}", shape_b, *why);
  return {};
}

}  // namespace cde
