// SPDX-License-Identifier: Apache-2.0
// reference::bad() decides. This file finds the words for the message.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "cde/fp/scalars.hpp"
#include "cde/geometry/check.hpp"
#include "cde/geometry/operand_defect.hpp"
#include "cde/geometry/primitives.hpp"
#include "cde/geometry/transform.hpp"
#include "cde/support/error.hpp"

namespace cde {
namespace {

using Defect = std::optional<std::string>;

/// Names of a primitive of a scene or file. An operand of a pipe has other names for the same
/// defects.
struct OfPrimitive {
  using Number = float;
  static constexpr bool kOperand = false;
};
struct OfOperand {
  using Number = double;
  static constexpr bool kOperand = true;
};

/// The name of a word: "origin.x", "rotation[1][2]", "radius".
std::string word_name(std::string_view field, Eigen::Index words, Eigen::Index k) {
  if (words == 1) return std::string(field);
  if (words == 3) return fmt::format("{}.{}", field, "xyz"[k]);
  return fmt::format("{}[{}][{}]", field, k / 3, k % 3);
}

/// Calls look(number of the word in its field, word) for the words of a field, until one has a
/// defect.
template <class Field, class Look>
Defect first_of(const Field& field, Look look) {
  if constexpr (requires { field.size(); }) {
    for (Eigen::Index k = 0; k < field.size(); ++k)
      if (auto why = look(k, field(k / field.cols(), k % field.cols()))) return why;
    return std::nullopt;
  } else {
    return look(0, field);
  }
}
template <class Field>
constexpr Eigen::Index words_of(const Field& field) {
  if constexpr (requires { field.size(); })
    return field.size();
  else
    return 1;
}

/// Calls look(name, kind, field) for the fields in slot order, until one has a defect.
template <class P, class Look>
Defect first_field(const P& primitive, Look look) {
  Defect why;
  visit_fields(primitive, [&](const char* name, WordKind kind, const auto& field) {
    if (!why) why = look(name, kind, field);
  });
  return why;
}

/// The defect of a single word.
template <class Wording, class S>
Defect bad_word(const std::string& name, WordKind kind, S word) {
  using std::isnan;
  const auto value = static_cast<typename Wording::Number>(word);
  const bool interval = kind == WordKind::kInterval;
  if (interval ? isnan(word) : !reference::finite(word))
    return fmt::format("{} is {}{}", name, value,
                       !Wording::kOperand ? ""
                       : interval         ? ", must be a number or infinite"
                                          : ", must be finite");
  if (interval || kind == WordKind::kPure) return std::nullopt;
  if (kind == WordKind::kSize && Wording::kOperand)
    return reference::kLengths<S>.not_size(name, value);
  return reference::kLengths<S>.not_coordinate(name, value);
}

/// The defect if a.b is not the required 0 or 1.
template <class Wording, class S>
Defect bad_product(const std::string& what, const Vector3<S>& a, const Vector3<S>& b,
                   int expected) {
  if (reference::dot_is<S>(a, b, expected)) return std::nullopt;
  return fmt::format("{} {}, must be {} within {:.3g}", what,
                     static_cast<typename Wording::Number>(reference::dot<S>(a, b)), expected,
                     reference::kUnitTolerance<S>);
}

/// The defect of a direction or unit vector as a whole; other fields have defects of words only.
template <class Wording, class S>
Defect bad_whole(std::string_view name, WordKind kind, const Vector3<S>& v) {
  if (kind == WordKind::kPure)
    return bad_product<Wording, S>(Wording::kOperand ? fmt::format("squared length of {} is", name)
                                                     : fmt::format("{} has squared length", name),
                                   v, v, 1);
  if (kind != WordKind::kDirection) return std::nullopt;
  using Number = typename Wording::Number;
  const Number largest =
      std::max({std::abs(static_cast<Number>(v.x())), std::abs(static_cast<Number>(v.y())),
                std::abs(static_cast<Number>(v.z()))});
  if (largest == 0)
    return fmt::format("{} is zero{}", name, Wording::kOperand ? ", must have a length" : "");
  return reference::kLengths<S>.not_size(fmt::format("largest component of {}", name), largest);
}

template <class Wording, class S>
Defect bad_whole(std::string_view name, WordKind, const Matrix3<S>& rotation) {
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j)
      if (auto why = bad_product<Wording, S>(
              fmt::format("{} {}product of columns {} and {} is", name,
                          Wording::kOperand ? "must be orthonormal: " : "is not orthonormal: the ",
                          i, j),
              rotation.col(i), rotation.col(j), i == j))
        return why;
  return std::nullopt;
}

template <class Wording, class P>
Defect why_bad(const P& primitive) {
  using S = typename P::Scalar;
  if (!reference::bad(primitive)) return std::nullopt;
  auto why = first_field(primitive, [](const char* name, WordKind kind, const auto& field) {
    return first_of(field, [&](Eigen::Index k, S word) {
      return bad_word<Wording>(word_name(name, words_of(field), k), kind, word);
    });
  });
  if (why) return why;
  why = first_field(primitive, [](const char* name, WordKind kind, const auto& field) -> Defect {
    if (kind == WordKind::kSize)
      return first_of(field, [&](Eigen::Index k, S word) {
        return reference::kLengths<S>.not_size(word_name(name, words_of(field), k),
                                               static_cast<typename Wording::Number>(word));
      });
    if constexpr (requires { field.size(); })
      return bad_whole<Wording, S>(name, kind, field);
    else
      return std::nullopt;
  });
  if (why) return why;
  if constexpr (requires { primitive.first_disordered_axis(); }) {
    const int k = primitive.first_disordered_axis().value();
    return fmt::format("max.{0} is {1}, must be > min.{0} = {2}", "xyz"[k],
                       static_cast<typename Wording::Number>(primitive.max[k]),
                       static_cast<typename Wording::Number>(primitive.min[k]));
  }
  return std::nullopt;
}

/// The first finite word whose nearest number of the format is infinite.
template <class S, class P>
Defect overflow(const P& primitive) {
  return first_field(primitive, [](const char* name, WordKind, const auto& field) {
    return first_of(field, [&](Eigen::Index k, float word) -> Defect {
      using std::isinf;
      if (!std::isfinite(word) || !isinf(S(word))) return std::nullopt;
      return fmt::format("{} is {}, above the largest number, {}",
                         word_name(name, words_of(field), k), word,
                         static_cast<float>(std::numeric_limits<S>::max()));
    });
  });
}

template <class P>
Defect why_bad_in(FpFormat format, const P& primitive) {
  if (format == FpFormat{}) return why_bad<OfPrimitive>(primitive);
  Defect why;
  const bool known = with_scalar(format, [&]<class S>() {
    why = overflow<S>(primitive);
    if (!why) why = why_bad<OfPrimitive>(primitive_cast<S>(primitive));
  });
  if (!known)
    throw Error(ErrorCode::kUsage, fmt::format("there are no primitives in {}", format.name()));
  if (why) *why += " in " + format.name();
  return why;
}

Defect operand_in(FpFormat format, Shape shape, std::span<const std::uint64_t> words) {
  Defect why;
  const bool known = with_scalar(format, [&]<class S>() {
    why = with_shape<S>(shape, [&]<class P>() {
      P primitive;
      std::size_t i = 0;
      visit_words(primitive,
                  [&](const char*, int, auto& word) { word = from_word<S>(words[i++]); });
      return why_bad<OfOperand>(primitive);
    });
  });
  if (known) return why;
  throw Error(ErrorCode::kUsage, fmt::format("no primitives in {}", format.name()));
}

}  // namespace

Defect defect(Shape shape, std::span<const float> words, FpFormat format) {
  return with_shape<float>(shape, [&]<class P>() {
    return why_bad_in(format, from_words<P>(words.template first<P::kWords>()));
  });
}
Defect defect(const Transform& transform, FpFormat format) {
  return why_bad_in(format, transform);
}

void check(Shape shape, std::span<const float> words, std::string_view what) {
  if (const auto why = defect(shape, words))
    throw Error(ErrorCode::kBadInput, fmt::format("{}: {}", what, *why));
}

std::string operand_defect(Pair pair, FpFormat format, std::span<const std::uint64_t> a,
                           std::span<const std::uint64_t> b) {
  const Shape shape_a = primary_shape(pair), shape_b = secondary_shape(pair);
  if (const auto why = operand_in(format, shape_a, a))
    return fmt::format("{} A: {}", name(shape_a), *why);
  if (const auto why = operand_in(format, shape_b, b))
    return fmt::format("{} B: {}", name(shape_b), *why);
  return {};
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

}  // namespace cde
