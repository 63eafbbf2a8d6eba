// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "cde/contract/formats.hpp"

namespace cde {

/// A binary floating-point format with IEEE 754 encoding: sign, biased exponent, fraction. It has
/// subnormals, infinities and NaN. exp_bits is 3..11; man_bits (fraction, without the hidden bit)
/// is 2..52. Words are the low bits of a uint64_t.
struct FpFormat {
  int exp_bits = 8;
  int man_bits = 23;

  bool operator==(const FpFormat&) const = default;

  [[nodiscard]] int width() const { return 1 + exp_bits + man_bits; }
  /// Hexadecimal digits of a word.
  [[nodiscard]] int hex_digits() const { return (width() + 3) / 4; }
  [[nodiscard]] int bias() const { return (1 << (exp_bits - 1)) - 1; }
  /// Exponent of the smallest normal number, 2^emin.
  [[nodiscard]] int emin() const { return 1 - bias(); }
  [[nodiscard]] uint64_t sign_bit() const { return uint64_t{1} << (exp_bits + man_bits); }
  [[nodiscard]] uint64_t magnitude_mask() const { return sign_bit() - 1; }
  [[nodiscard]] uint64_t fraction_mask() const { return (uint64_t{1} << man_bits) - 1; }
  [[nodiscard]] uint64_t infinity() const { return magnitude_mask() & ~fraction_mask(); }
  [[nodiscard]] uint64_t quiet_bit() const { return uint64_t{1} << (man_bits - 1); }
  /// The one NaN that operations give: positive, quiet, no payload.
  [[nodiscard]] uint64_t canonical_nan() const { return infinity() | quiet_bit(); }

  [[nodiscard]] bool is_nan(uint64_t word) const { return (word & magnitude_mask()) > infinity(); }
  [[nodiscard]] bool is_signalling(uint64_t word) const {
    return is_nan(word) && (word & quiet_bit()) == 0;
  }

  /// Exact value of a word; a NaN of the format is a quiet NaN.
  [[nodiscard]] double decode(uint64_t word) const;
  /// Nearest word, ties to even; NaN becomes the canonical NaN.
  [[nodiscard]] uint64_t encode(double value) const;

  /// "fp32", or "eEmM" for a format without a name.
  [[nodiscard]] std::string name() const;
  /// Parses a name of kFpFormats, or "f16", "f32", "f64" as in Berkeley TestFloat, or "eEmM" such
  /// as "e6m9". Case is ignored. Error kUsage for anything else or sizes out of range.
  static FpFormat parse(std::string_view text);
};

struct NamedFpFormat {
  std::string_view name;
  FpFormat format;
};

/// The named formats, in the order of the conversions of an fp_unit simulation model.
inline constexpr auto kFpFormats = [] {
  std::array<NamedFpFormat, contract::kFormatTable.size()> formats{};
  for (std::size_t k = 0; k < formats.size(); ++k) {
    const contract::FormatRow& row = contract::kFormatTable[k];
    formats[k] = {row.name, {row.exp_bits, row.man_bits}};
  }
  return formats;
}();

}  // namespace cde
