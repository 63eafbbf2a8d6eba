// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <bit>
#include <limits>
#include <tuple>
#include <utility>

#include "cde/fp/fp.hpp"
#include "cde/fp/fp_format.hpp"

/// The formats that pairs are computed in, and the scalars of their references. A format of
/// kFormatTable becomes one by its scalar here.
namespace cde {

using PairScalars = std::tuple<Fp16, Bf16, Fp24, float, double>;

template <class S>
inline constexpr FpFormat kFormatOf{
    std::bit_width(static_cast<unsigned>(std::numeric_limits<S>::max_exponent)),
    std::numeric_limits<S>::digits - 1};

inline constexpr auto kPairFormats = []<std::size_t... k>(std::index_sequence<k...>) {
  return std::array{kFormatOf<std::tuple_element_t<k, PairScalars>>...};
}
(std::make_index_sequence<std::tuple_size_v<PairScalars>>());

/// Calls use.operator()<S>() with the scalar of the format; false if pairs are not computed in it.
template <class Use>
bool with_scalar(FpFormat format, Use use) {
  return [&]<std::size_t... k>(std::index_sequence<k...>) {
    return ((kPairFormats[k] == format &&
             (use.template operator()<std::tuple_element_t<k, PairScalars>>(), true)) ||
            ...);
  }
  (std::make_index_sequence<std::tuple_size_v<PairScalars>>());
}

}  // namespace cde
