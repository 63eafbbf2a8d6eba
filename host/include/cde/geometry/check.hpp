// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "cde/geometry/length_range.hpp"
#include "cde/geometry/ops.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/geometry/primitives.hpp"

/// @file
/// The input contract, `bad(primitive)`: a primitive that breaks it is flagged, and its pairs
/// return bad_outcome(). The check stands beside the pipe, not in it. Tests of one word (finite,
/// NaN, in range) look at its bits and are wires in hardware. The operator counts below cover all
/// other tests.
namespace cde::reference {

/// Tolerance for |a|^2 of a unit vector, and for every entry of R^T R - 1 of a rotation. It is
/// 2^-20, which accepts whatever was normalised in fp32, or 16 u in formats too coarse for that.
template <typename S>
inline constexpr double kUnitTolerance = std::max(0x1p-20, 16 * kUnitRoundoff<S>);

/// Exponent bits of a format.
template <typename S>
inline constexpr int kExponentBits =
    std::bit_width(static_cast<unsigned>(std::numeric_limits<S>::max_exponent));

/// The lengths that the contract allows.
template <typename S>
inline constexpr LengthRange kLengths = LengthRange::of(kExponentBits<S>,
                                                        std::numeric_limits<S>::digits - 1);

/// 2^e as a double, -1022 <= e <= 1023.
[[nodiscard]] constexpr double power_of_two(int e) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(e + 1023) << 52);
}

template <typename S>
[[nodiscard]] bool finite(S x) {
  using std::isfinite;
  return isfinite(x);
}
template <typename S>
[[nodiscard]] bool finite(const Vector<S>& v) {
  return finite(v.x()) && finite(v.y()) && finite(v.z());
}

/// A coordinate: |x| <= 2^high.
template <typename S>
[[nodiscard]] bool is_coordinate(S x) {
  return static_cast<bool>(magnitude(x) <= S(power_of_two(kLengths<S>.high)));
}
template <typename S>
[[nodiscard]] bool is_coordinate(const Vector<S>& v) {
  return is_coordinate(v.x()) && is_coordinate(v.y()) && is_coordinate(v.z());
}

/// A size: 2^low <= x <= 2^high.
template <typename S>
[[nodiscard]] bool is_size(S x) {
  return static_cast<bool>(S(power_of_two(kLengths<S>.low)) <= x) && is_coordinate(x);
}
template <typename S>
[[nodiscard]] bool is_size(const Vector<S>& v) {
  return is_size(v.x()) && is_size(v.y()) && is_size(v.z());
}

/// |a.b - expected| <= kUnitTolerance, false for NaN. 3 mul, 3 add, 1 cmp.
template <typename S>
[[nodiscard]] bool dot_is(const Vector<S>& a, const Vector<S>& b, int expected) {
  return static_cast<bool>(magnitude(dot<S>(a, b) - S(expected)) <= S(kUnitTolerance<S>));
}

/// Whether a one-word field is within the contract. No operators.
template <typename S>
[[nodiscard]] bool is_legal(WordKind kind, S x) {
  using std::isnan;
  if (kind == WordKind::kInterval) return !isnan(x);
  return kind == WordKind::kSize ? is_size(x) : is_coordinate(x);
}

/// A unit vector: 3 mul, 3 add, 1 cmp. Points, extents and directions: no operators.
template <typename S>
[[nodiscard]] bool is_legal(WordKind kind, const Vector<S>& v) {
  if (kind == WordKind::kPure) return finite<S>(v) && dot_is<S>(v, v, 1);
  if (kind == WordKind::kSize) return is_size<S>(v);
  const bool moves =
      is_size(magnitude(v.x())) || is_size(magnitude(v.y())) || is_size(magnitude(v.z()));
  return is_coordinate<S>(v) && (moves || kind != WordKind::kDirection);
}

/// A rotation: the upper triangle of R^T R. 18 mul, 18 add, 6 cmp.
template <typename S>
[[nodiscard]] bool is_legal(WordKind, const Matrix3<S>& rotation) {
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j)
      if (!dot_is<S>(rotation.col(i), rotation.col(j), i == j)) return false;
  }
  return true;  // an entry that is not finite makes its column's product infinite or NaN
}

/// Operators: the operators of all fields; 3 cmp for an AABB.
template <typename P>
[[nodiscard]] bool bad(const P& primitive) {
  using S = typename P::Scalar;
  bool legal = true;
  visit_fields(primitive, [&legal](const char*, WordKind kind, const auto& field) {
    legal = legal && is_legal<S>(kind, field);
  });
  if constexpr (requires { primitive.first_disordered_axis(); })
    legal = legal && !primitive.first_disordered_axis();
  return !legal;
}

}  // namespace cde::reference
