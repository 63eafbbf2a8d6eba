// SPDX-License-Identifier: Apache-2.0
#include "cde/fp/fp_format.hpp"

#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <cstdio>
#include <limits>

#include "cde/fp/fp_reference.hpp"
#include "cde/fp/scalars.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"

namespace cde {

double FpFormat::decode(uint64_t word) const {
  const double sign = (word & sign_bit()) != 0 ? -1.0 : 1.0;
  const uint64_t magnitude = word & magnitude_mask();
  if (magnitude > infinity()) return std::numeric_limits<double>::quiet_NaN();
  if (magnitude == infinity()) return sign * std::numeric_limits<double>::infinity();
  const auto exponent = static_cast<int>(magnitude >> man_bits);
  const uint64_t fraction = magnitude & fraction_mask();
  const uint64_t significand = exponent == 0 ? fraction : fraction | (uint64_t{1} << man_bits);
  return sign * std::ldexp(static_cast<double>(significand),
                           (exponent == 0 ? 1 : exponent) - bias() - man_bits);
}

uint64_t FpFormat::encode(double value) const {
  constexpr FpFormat kDouble{11, 52};
  uint64_t word = 0;
  static_assert(sizeof word == sizeof value);
  __builtin_memcpy(&word, &value, sizeof word);
  return fp_convert(kDouble, *this, word).word;
}

FloatWords::FloatWords(FpFormat format) {
  const bool known = with_scalar(format, [this]<class S>() {
    encode = [](float x) { return to_word(static_cast<S>(x)); };
    decode = [](std::uint64_t word) { return static_cast<float>(from_word<S>(word)); };
  });
  if (!known)
    throw Error(ErrorCode::kUsage, fmt::format("pairs are not computed in {}", format.name()));
}

std::string FpFormat::name() const {
  for (const NamedFpFormat& f : kFpFormats)
    if (f.format == *this) return std::string(f.name);
  return fmt::format("e{}m{}", exp_bits, man_bits);
}

FpFormat FpFormat::parse(std::string_view text) {
  std::string lower;
  for (const char c : text) lower += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (lower == "f16" || lower == "f32" || lower == "f64") lower = "fp" + lower.substr(1);
  for (const NamedFpFormat& f : kFpFormats)
    if (f.name == lower) return f.format;
  FpFormat format;
  int end = 0;
  if (std::sscanf(lower.c_str(), "e%2dm%2d%n", &format.exp_bits, &format.man_bits, &end) == 2 &&
      static_cast<std::size_t>(end) == lower.size() && format.exp_bits >= 3 &&
      format.exp_bits <= 11 && format.man_bits >= 2 && format.man_bits <= 52)
    return format;
  std::string names;
  for (const NamedFpFormat& f : kFpFormats) names.append(f.name).append(" ");
  throw Error(ErrorCode::kUsage,
              fmt::format("format {}; expected one of {}or eEmM with E 3..11 and M 2..52",
                          in_quotes(text), names.insert(names.size() - 1, ",")));
}

}  // namespace cde
