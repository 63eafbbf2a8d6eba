// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <bit>
#include <cstdint>
#include <type_traits>

#include "cde/geometry/check.hpp"
#include "cde/geometry/ops.hpp"
#include "cde/geometry/primitives.hpp"

/// @file
/// Scales a pair to about 1 by an exact power of two, and its result back
/// (rtl/pipes/length_scale.sv, length_unscale.sv). Where a pipe multiplies four lengths, the range
/// of its operands would otherwise be a quarter of the format's. k is the largest exponent of all
/// lengths of both operands. Every length is multiplied by 2^-k, and T and CP by 2^k. In hardware
/// the largest exponent takes comparators, and a multiplication is an addition to the exponent.
namespace cde::reference {

/// Whether a pair's operands are scaled (pairs_pkg::scaled): pairs that multiply four lengths, and
/// all pairs in formats of fewer than 8 exponent bits.
[[nodiscard]] constexpr bool is_scaled(Shape a, Shape b, int exponent_bits) {
  return exponent_bits < 8 || (a != Shape::kRay && a != Shape::kSphere && b != Shape::kPlane);
}
template <class A, class B>
inline constexpr bool kScaled = is_scaled(kShapeOf<A>, kShapeOf<B>,
                                          kExponentBits<typename A::Scalar>);

namespace scaling {

template <typename S>
using Bits = std::conditional_t<sizeof(S) == 8, std::uint64_t,
                                std::conditional_t<sizeof(S) == 4, std::uint32_t, std::uint16_t>>;
template <typename S>
inline constexpr int kFraction = std::numeric_limits<S>::digits - 1;
template <typename S>
inline constexpr int kBias = std::numeric_limits<S>::max_exponent - 1;

}  // namespace scaling

/// Wire: the stored exponent of a word; 0 for zeros and subnormals.
template <typename S>
[[nodiscard]] constexpr int stored_exponent(S x) {
  const auto bits = std::bit_cast<scaling::Bits<S>>(x);
  return static_cast<int>(bits >> scaling::kFraction<S>) & (2 * scaling::kBias<S> + 1);
}

/// x 2^k, exactly. An x or result below the smallest normal number becomes a zero of the same sign.
/// With `keep` a normal x becomes the smallest normal number of its sign instead. x 2^k must not
/// overflow. One addition to the exponent.
template <typename S>
[[nodiscard]] constexpr S times_power_of_two(S x, int k, bool keep = false) {
  using Bits = scaling::Bits<S>;
  const int from = stored_exponent(x), to = from + k;
  const auto bits = std::bit_cast<Bits>(x);
  constexpr Bits kSign = static_cast<Bits>(Bits{1} << (kExponentBits<S> + scaling::kFraction<S>));
  const auto moved =
      static_cast<Bits>(bits + static_cast<Bits>(static_cast<Bits>(k) << scaling::kFraction<S>));
  const auto least = static_cast<Bits>(Bits{keep && from != 0} << scaling::kFraction<S>);
  return std::bit_cast<S>(from == 0 || to <= 0 ? static_cast<Bits>((bits & kSign) | least) : moved);
}
template <typename S>
[[nodiscard]] Vector<S> times_power_of_two(const Vector<S>& v, int k) {
  return {times_power_of_two(v.x(), k), times_power_of_two(v.y(), k), times_power_of_two(v.z(), k)};
}

namespace scaling {

/// Kind of word `word` of a primitive's slot (pairs_pkg::word_kind).
template <class P>
[[nodiscard]] constexpr WordKind kind(std::size_t word) {
  return contract::word_kind(kShapeOf<P>, word);
}
[[nodiscard]] constexpr bool is_length(WordKind kind) {
  return kind == WordKind::kCoordinate || kind == WordKind::kSize;
}
[[nodiscard]] constexpr bool is_direction(WordKind kind) {
  return kind == WordKind::kDirection;
}

/// The largest stored exponent of a primitive's words of some kinds, but at least `least`.
template <class P>
[[nodiscard]] int largest_exponent(const P& primitive, bool (*of)(WordKind), int least) {
  std::size_t k = 0;
  visit_words(primitive, [&](const char*, int, const auto& word) {
    if (of(kind<P>(k++))) least = std::max(least, stored_exponent(word));
  });
  return least;
}

/// Multiplies lengths by 2^by, d by 2^direction, and tmin and tmax by `interval`.
template <class P>
[[nodiscard]] P scaled(P primitive, int by, int direction, typename P::Scalar interval) {
  std::size_t k = 0;
  visit_words(primitive, [&](const char*, int, auto& word) {
    const WordKind of = kind<P>(k++);
    if (is_length(of)) word = times_power_of_two(word, by);
    if (is_direction(of)) word = times_power_of_two(word, direction);
    if (of == WordKind::kInterval) word = word * interval;
  });
  return primitive;
}

}  // namespace scaling

/// The result of a pipe, test(a, b), for a pair of any size within the contract. A ray's tmin, tmax
/// and resulting T are rounded once if they leave the format's normal range: 3 mul. A ray whose T
/// or CP overflows misses. Solids touch, F = 1, if T at size one is below the normal numbers. No
/// other T becomes zero, so F and T agree.
template <typename S, class A, class B, class Test>
[[nodiscard]] Outcome<S> scaled_answer(const A& a, const B& b, Test test) {
  if constexpr (!kScaled<A, B>) {
    return test(a, b);
  } else {
    using namespace scaling;
    constexpr int kLeast = kBias<S> + kLengths<S>.low;
    const int k = largest_exponent(b, is_length, largest_exponent(a, is_length, kLeast)) - kBias<S>;
    if constexpr (kShapeOf<A> == Shape::kRay) {
      const int d = largest_exponent(a, is_direction, kLeast) - kBias<S>;
      Outcome<S> r = test(scaled(a, -k, -d, S(power_of_two(d - k))), scaled(b, -k, 0, S(1)));
      r.t = r.t * S(power_of_two(k - d));
      r.f = r.f && finite(r.t) && finite<S>(r.cp);
      r.t = r.f ? r.t : std::numeric_limits<S>::infinity();
      r.cp = r.f ? times_power_of_two<S>(r.cp, k) : Vector<S>(Vector<S>::Zero());
      return r;
    } else {
      Outcome<S> r = test(scaled(a, -k, 0, S(1)), scaled(b, -k, 0, S(1)));
      r.t = times_power_of_two(r.t, k, true);
      r.f = r.f || stored_exponent(r.t) == 0;
      r.cp = times_power_of_two<S>(r.cp, k);
      return r;
    }
  }
}

/// The same after the check of the contract: bad input gives bad_outcome().
template <typename S, class A, class B, class Test>
[[nodiscard]] Outcome<S> at_size_one(const A& a, const B& b, Test test) {
  if (bad(a) || bad(b)) return bad_outcome<S>();
  return scaled_answer<S>(a, b, test);
}

}  // namespace cde::reference
