// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/format.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cde/fp/fp_format.hpp"

/// @file
/// Numbers as text, and as words of a format of the pipes.
namespace cde {

/// Names of the formats of pairs.
[[nodiscard]] std::vector<std::string> pair_formats();
/// Names of the formats of cards.
[[nodiscard]] std::vector<std::string> card_formats();

class WordText {
 public:
  /// Error kUsage for a format not in kPairFormats.
  explicit WordText(FpFormat format);

  [[nodiscard]] FpFormat format() const { return format_; }

  /// Parses a number to its word. Decimals ("1.5", "-2e-3") and hexfloats (0x with a point or a p,
  /// "0x1.8p+0") are rounded once, from the exact value, to nearest even. A word is 0x and
  /// hexadecimal digits alone ("0x3fc00000"). The texts inf and nan are also read. Nothing if the
  /// text is none of these or too large for the format; `why` says which.
  [[nodiscard]] std::optional<std::uint64_t> parse(std::string_view text, std::string& why) const;

  /// The word nearest to a number, ties to even; the canonical NaN for a NaN. Nothing if the number
  /// is too large for the format; `why` says so.
  [[nodiscard]] std::optional<std::uint64_t> word_of(double number, std::string& why) const;

  /// Appends a decimal that `parse` reads back as the same word, or the word itself as 0x and all
  /// its hexadecimal digits. The decimal form of a NaN does not keep its payload.
  void append_decimal(fmt::memory_buffer& to, std::uint64_t word) const;
  void append_bits(fmt::memory_buffer& to, std::uint64_t word) const;

  /// Both: "1.5 (0x3fc00000)".
  [[nodiscard]] std::string decimal_and_bits(std::uint64_t word) const;

  /// Exact text that `parse` reads back: a hexfloat, or the word of a NaN.
  [[nodiscard]] std::string hexfloat(std::uint64_t word) const;

 private:
  enum class Found { kNumber, kMalformed, kTooLarge };
  template <class S>
  static Found number(std::string_view text, std::uint64_t& word);

  FpFormat format_;
  Found (*number_)(std::string_view, std::uint64_t&) = nullptr;
};

}  // namespace cde
