// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace cde {

/// A bit field of a 64-bit word: a field of a packed structure of rtl/contract.
struct Field {
  unsigned low = 0, bits = 1;

  [[nodiscard]] constexpr std::uint64_t mask() const {
    return (bits < 64 ? (std::uint64_t{1} << bits) - 1 : ~std::uint64_t{0}) << low;
  }
  /// The field's value in a word.
  [[nodiscard]] constexpr std::uint64_t of(std::uint64_t word) const {
    return (word & mask()) >> low;
  }
  /// A word with this value in the field and zeros elsewhere.
  template <typename T>
  [[nodiscard]] constexpr std::uint64_t operator()(T value) const {
    return static_cast<std::uint64_t>(value) << low & mask();
  }
  bool operator==(const Field&) const = default;
};

}  // namespace cde
