// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/format.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cde/fp/fp_format.hpp"

/// Numbers as text, and as words of a format that the pipes compute in.
namespace cde {

/// Names of the formats that pairs are computed in.
[[nodiscard]] std::vector<std::string> pair_formats();
/// Of cards.
[[nodiscard]] std::vector<std::string> card_formats();

class WordText {
 public:
  /// Error kUsage for a format that pairs are not computed in (kPairFormats).
  explicit WordText(FpFormat format);

  [[nodiscard]] FpFormat format() const { return format_; }

  /// The word of a number: decimal ("1.5", "-2e-3"), hexfloat (0x with a point or a p, "0x1.8p+0"),
  /// the word itself (0x and hexadecimal digits alone, "0x3fc00000"), inf or nan. Decimals and
  /// hexfloats are rounded once, from the exact value, to nearest even. Nothing if it is none of
  /// these or too large for the format; `why` says which.
  [[nodiscard]] std::optional<std::uint64_t> parse(std::string_view text, std::string& why) const;

  /// The word nearest to a number, ties to even, and the canonical NaN. Nothing if the number is
  /// too large for the format; `why` says so.
  [[nodiscard]] std::optional<std::uint64_t> word_of(double number, std::string& why) const;

  /// Appends a decimal that `parse` reads back as the same word, or the word itself as 0x and all
  /// its hexadecimal digits. Of a NaN, the decimal form says only that it is one.
  void append_decimal(fmt::memory_buffer& to, std::uint64_t word) const;
  void append_bits(fmt::memory_buffer& to, std::uint64_t word) const;

  /// Both: "1.5 (0x3fc00000)".
  [[nodiscard]] std::string decimal_and_bits(std::uint64_t word) const;

  /// Exact, and `parse` reads it back: a hexfloat, or the word if it is a NaN.
  [[nodiscard]] std::string hexfloat(std::uint64_t word) const;

 private:
  enum class Found { kNumber, kMalformed, kTooLarge };
  template <class S>
  static Found number(std::string_view text, std::uint64_t& word);

  FpFormat format_;
  Found (*number_)(std::string_view, std::uint64_t&) = nullptr;
};

}  // namespace cde
