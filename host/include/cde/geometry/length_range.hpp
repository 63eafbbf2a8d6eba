// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <bit>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace cde {

/// The lengths that the input contract allows in a number format, as exponents of two. No
/// coordinate or size is above 2^high. No size is below 2^low, nor is the largest component of a
/// ray's direction. The same as formats_pkg::length_low and length_high.
///
/// Rays and triangles multiply three lengths, and two of their differences. Formats of fewer than 8
/// exponent bits scale every pair (reference/pipes/scale.hpp). There only a size over the largest
/// coordinate has to be a normal number.
struct LengthRange {
  int low = 0, high = 0;

  /// 2^-34 to 2^40 in fp32.
  [[nodiscard]] static constexpr LengthRange of(int exponent_bits, int fraction_bits) {
    const int half = 1 << (exponent_bits - 1);  // the bias and one
    if (exponent_bits < 8) return {-((half - 2) / 2), (half - 2) / 2};
    return {-((half - 3 - fraction_bits) / 3), (half - 8) / 3};
  }

  /// Range of a solid's lengths over the largest component of a ray's direction, as exponents of
  /// two. No size is below 2^low times that component; no coordinate or size is above 2^high times
  /// it. In fp32: 2^-60 to 2^38.
  ///
  /// T is about such a ratio. Its square must be a normal number. The same holds for a cylinder's
  /// radius over the direction's part across the axis, unless that part is below the rounding. This
  /// is not checked: it depends on the pair, not on one operand. Formats of fewer than 8 exponent
  /// bits scale both to about 1 and have no such limit.
  [[nodiscard]] static constexpr LengthRange ray_ratio(int exponent_bits, int fraction_bits) {
    const int root = 1 << (exponent_bits - 2);  // of the largest number, as an exponent
    return {4 - root, root - fraction_bits - 3};
  }

  /// Whether numbers can be coordinates and sizes; if so, not_coordinate() and not_size() return
  /// nothing.
  [[nodiscard]] constexpr bool is_coordinate(double value) const {
    return -power(high) <= value && value <= power(high);
  }
  [[nodiscard]] constexpr bool is_size(double value) const {
    return power(low) <= value && value <= power(high);
  }
  /// Why a word cannot be a coordinate ("center.x is 1e+20, must be at most 2^40 in size").
  [[nodiscard]] std::optional<std::string> not_coordinate(std::string_view word,
                                                          double value) const;
  /// Why a number cannot be a size ("radius is 1e-20, must be 2^-34 to 2^40").
  [[nodiscard]] std::optional<std::string> not_size(std::string_view word, double value) const;

 private:
  [[nodiscard]] static constexpr double power(int of_two) {
    return std::bit_cast<double>(static_cast<std::uint64_t>(1023 + of_two) << 52);
  }
};

}  // namespace cde
