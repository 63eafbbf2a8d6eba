// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <tuple>
#include <type_traits>
#include <utility>

#include "cde/fp/fp.hpp"
#include "cde/fp/fp_format.hpp"

/// @file
/// The formats of pairs, and the scalars of their references. A format of kFormatTable becomes a
/// format of pairs by an entry here.
namespace cde {

using PairScalars = std::tuple<Fp16, Bf16, Tf32, Fp24, float, double>;

template <class S>
inline constexpr FpFormat kFormatOf{
    std::bit_width(static_cast<unsigned>(std::numeric_limits<S>::max_exponent)),
    std::numeric_limits<S>::digits - 1};

inline constexpr auto kPairFormats = []<std::size_t... k>(std::index_sequence<k...>) {
  return std::array{kFormatOf<std::tuple_element_t<k, PairScalars>>...};
}
(std::make_index_sequence<std::tuple_size_v<PairScalars>>());

/// Formats of cards: words of a card's buses, memories and records have 32 bits.
inline constexpr unsigned kCardWord = 32;
[[nodiscard]] constexpr bool is_card_format(FpFormat format) {
  for (const FpFormat f : kPairFormats)
    if (f == format) return 1 + f.exp_bits + f.man_bits <= static_cast<int>(kCardWord);
  return false;
}

template <class S>
S from_word(std::uint64_t word) {
  if constexpr (std::is_same_v<S, float>)
    return std::bit_cast<float>(static_cast<std::uint32_t>(word));
  else if constexpr (std::is_same_v<S, double>)
    return std::bit_cast<double>(word);
  else
    return S::from_bits(static_cast<typename S::Bits>(word));
}

/// A NaN keeps its bits.
template <class S>
std::uint64_t to_word(S x) {
  if constexpr (std::is_same_v<S, float>)
    return std::bit_cast<std::uint32_t>(x);
  else if constexpr (std::is_same_v<S, double>)
    return std::bit_cast<std::uint64_t>(x);
  else
    return x.bits();
}

/// Calls `use.operator()<S>()` with the scalar of the format. False if the format is not in
/// kPairFormats.
template <class Use>
bool with_scalar(FpFormat format, Use use) {
  return [&]<std::size_t... k>(std::index_sequence<k...>) {
    return ((kPairFormats[k] == format &&
             (use.template operator()<std::tuple_element_t<k, PairScalars>>(), true)) ||
            ...);
  }
  (std::make_index_sequence<std::tuple_size_v<PairScalars>>());
}

/// Floats as words of a format of kPairFormats, and back.
struct FloatWords {
  /// Error kUsage for a format not in kPairFormats.
  explicit FloatWords(FpFormat format);

  /// The nearest word; a NaN becomes the canonical one except in fp32.
  std::uint64_t (*encode)(float);
  float (*decode)(std::uint64_t);  ///< exact for formats no wider than fp32; a NaN keeps its sign
                                   ///< and as much of its payload as fits
};

}  // namespace cde
