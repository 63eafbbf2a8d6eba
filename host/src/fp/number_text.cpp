// SPDX-License-Identifier: Apache-2.0
#include "cde/fp/number_text.hpp"

#include <bit>
#include <cctype>
#include <cfenv>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <type_traits>

#include "cde/fp/scalars.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"

namespace cde {
namespace {

/// std::strtod honours the rounding direction (glibc does; the manual page says so).
double rounded(const std::string& text, int direction) {
  const int before = std::fegetround();
  std::fesetround(direction);
  const double value = std::strtod(text.c_str(), nullptr);
  std::fesetround(before);
  return value;
}

/// The value of an unsigned text in binary64, rounded to odd: an inexact value gets its last bit
/// set. It thus lies on no boundary of a shorter format, and rounding it again equals rounding the
/// text.
double rounded_to_odd(const std::string& text) {
  const double down = rounded(text, FE_TOWARDZERO);
  if (rounded(text, FE_UPWARD) == down) return down;
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(down) | 1);
}

/// `nearest` is the binary64 number nearest to the text. If its neighbours round to the same word,
/// no boundary is near. Otherwise the text decides.
template <class S>
S narrow(double nearest, const std::string_view text) {
  const S word(nearest);
  constexpr double kFar = std::numeric_limits<double>::infinity();
  const S below(std::nextafter(nearest, -kFar)), above(std::nextafter(nearest, kFar));
  if (below.bits() == above.bits() || nearest == 0) return word;
  return S(rounded_to_odd(std::string(text)));
}

bool is_word(std::string_view digits) {
  for (const char c : digits)
    if (std::isxdigit(static_cast<unsigned char>(c)) == 0) return false;
  return !digits.empty();
}

bool has_hex_prefix(std::string_view text) {
  return text.size() > 2 && text[0] == '0' && (text[1] == 'x' || text[1] == 'X');
}

}  // namespace

template <class S>
WordText::Found WordText::number(std::string_view text, std::uint64_t& word) {
  using Read = std::conditional_t<std::is_same_v<S, float>, float, double>;
  bool negative = false;
  if (!text.empty() && (text.front() == '+' || text.front() == '-')) {
    negative = text.front() == '-';
    text.remove_prefix(1);
  }
  const bool hex = has_hex_prefix(text);
  // 0x followed by digits alone is a word, which includes the sign bit.
  if (negative && hex && is_word(text.substr(2))) return Found::kMalformed;
  const std::string_view digits = hex ? text.substr(2) : text;
  // from_chars takes a minus sign by itself; a second one after ours is malformed.
  if (digits.empty() || digits.front() == '-') return Found::kMalformed;
  Read read = 0;
  const char* const end = digits.data() + digits.size();
  const auto [stop, error] = std::from_chars(
      digits.data(), end, read, hex ? std::chars_format::hex : std::chars_format::general);
  if (stop != end || error == std::errc::invalid_argument) return Found::kMalformed;
  if (error == std::errc::result_out_of_range) {  // too large or too small: strtod decides which
    const std::string copy(text);
    if constexpr (std::is_same_v<S, float>)
      read = std::strtof(copy.c_str(), nullptr);
    else
      read = std::strtod(copy.c_str(), nullptr);
  }
  using std::isinf, std::isnan;
  S value{};
  if (isnan(read))
    value = std::numeric_limits<S>::quiet_NaN();
  else if constexpr (std::is_same_v<S, Read>)
    value = read;
  else
    value = narrow<S>(read, text);
  if (isinf(value) && std::isalpha(static_cast<unsigned char>(digits.front())) == 0)
    return Found::kTooLarge;
  if (negative && !isnan(value)) value = -value;
  word = to_word(value);
  return Found::kNumber;
}

std::vector<std::string> pair_formats() {
  std::vector<std::string> names;
  for (const FpFormat format : kPairFormats) names.push_back(format.name());
  return names;
}

std::vector<std::string> card_formats() {
  std::vector<std::string> names;
  for (const FpFormat format : kPairFormats)
    if (is_card_format(format)) names.push_back(format.name());
  return names;
}

WordText::WordText(FpFormat format) : format_(format) {
  if (with_scalar(format, [this]<class S>() { number_ = number<S>; })) return;
  throw Error(ErrorCode::kUsage, fmt::format("--format is {}; it must be one of {}", format.name(),
                                             fmt::join(pair_formats(), ", ")));
}

std::optional<std::uint64_t> WordText::parse(std::string_view text, std::string& why) const {
  std::uint64_t word = 0;
  if (has_hex_prefix(text) && is_word(text.substr(2))) {
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data() + 2, end, word, 16);
    const std::uint64_t mask = format_.sign_bit() | format_.magnitude_mask();
    if (error == std::errc() && stop == end && word <= mask) return word;
    why = fmt::format("{} has more than the {} bits of {}", in_quotes(text), format_.width(),
                      format_.name());
    return std::nullopt;
  }
  switch (number_(text, word)) {
    case Found::kNumber:
      return word;
    case Found::kTooLarge:
      why = fmt::format("{} is beyond the largest {} number, {:.8g}", in_quotes(text),
                        format_.name(), format_.decode(format_.infinity() - 1));
      break;
    case Found::kMalformed:
      why = fmt::format("{} is not a number", in_quotes(text));
      if (text.size() > 1 && text.front() == '-' && has_hex_prefix(text.substr(1)) &&
          is_word(text.substr(3)))
        why += ": 0x and digits are the bits of a word, including its sign; a hexfloat has a 'p'";
      break;
  }
  return std::nullopt;
}

std::optional<std::uint64_t> WordText::word_of(double number, std::string& why) const {
  const std::uint64_t word = format_.encode(number);
  if (!std::isfinite(number) || (word & format_.magnitude_mask()) != format_.infinity())
    return word;
  why = fmt::format("{} is beyond the largest {} number, {:.8g}", number, format_.name(),
                    format_.decode(format_.infinity() - 1));
  return std::nullopt;
}

void WordText::append_decimal(fmt::memory_buffer& to, std::uint64_t word) const {
  const auto out = std::back_inserter(to);
  if (format_.is_nan(word)) {
    fmt::format_to(out, "nan");
  } else if (format_ == FpFormat{11, 52}) {
    fmt::format_to(out, "{}", std::bit_cast<double>(word));
  } else {
    // Every word of the other formats is a float, whose shortest decimal lies nearer to it than to
    // any boundary of the format.
    const float value = format_ == FpFormat{8, 23}
                            ? std::bit_cast<float>(static_cast<std::uint32_t>(word))
                            : static_cast<float>(format_.decode(word));
    fmt::format_to(out, "{}", value);
  }
}

void WordText::append_bits(fmt::memory_buffer& to, std::uint64_t word) const {
  fmt::format_to(std::back_inserter(to), "0x{:0{}x}", word, format_.hex_digits());
}

std::string WordText::decimal_and_bits(std::uint64_t word) const {
  fmt::memory_buffer b;
  append_decimal(b, word);
  b.append(std::string_view(" ("));
  append_bits(b, word);
  b.push_back(')');
  return fmt::to_string(b);
}

std::string WordText::hexfloat(std::uint64_t word) const {
  if (format_.is_nan(word)) return fmt::format("0x{:0{}x}", word, format_.hex_digits());
  return fmt::format("{:a}", format_.decode(word));
}

}  // namespace cde
