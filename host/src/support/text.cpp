// SPDX-License-Identifier: Apache-2.0
#include "support/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "cde/support/error.hpp"

namespace cde::text {

void no_entry(std::string_view what, std::size_t number, std::size_t entries) {
  throw Error(ErrorCode::kUsage,
              fmt::format("there is no {} {}; expected 0 to {}", what, number, entries - 1));
}

Number parse_float(std::string_view text, float& value) {
  const std::string_view whole = text;
  bool negative = false;
  if (!text.empty() && (text.front() == '+' || text.front() == '-')) {
    negative = text.front() == '-';
    text.remove_prefix(1);
  }
  auto format = std::chars_format::general;
  if (text.size() > 2 && text[0] == '0' && (text[1] == 'x' || text[1] == 'X')) {
    format = std::chars_format::hex;
    text.remove_prefix(2);
  }
  // from_chars takes a minus sign by itself; a second one after ours is malformed.
  if (text.empty() || text.front() == '-') return Number::kMalformed;
  const char* end = text.data() + text.size();
  float magnitude = 0.0f;
  const auto [stop, error] = std::from_chars(text.data(), end, magnitude, format);
  if (stop != end || error == std::errc::invalid_argument) return Number::kMalformed;
  if (error == std::errc::result_out_of_range) {
    // too large or too small: strtof decides which
    magnitude = std::fabs(std::strtof(std::string(whole).c_str(), nullptr));
  }
  const bool literal_infinity = text.front() == 'i' || text.front() == 'I';
  if (std::isinf(magnitude) && !literal_infinity) return Number::kOverflow;
  value = negative ? -magnitude : magnitude;
  return Number::kOk;
}

template <typename Int>
bool parse_int(std::string_view text, Int& value) {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return stop == end && error == std::errc();
}
template bool parse_int(std::string_view, std::uint32_t&);
template bool parse_int(std::string_view, std::uint64_t&);
template bool parse_int(std::string_view, std::int64_t&);

std::string_view trim(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::optional<std::string_view> Lines::next() {
  if (rest_.empty()) return std::nullopt;
  ++number_;
  const auto* const end =
      std::find_if(rest_.begin(), rest_.end(), [](char c) { return c == '\n' || c == '\r'; });
  const std::string_view line(rest_.begin(), end);
  rest_.remove_prefix(line.size());
  rest_.remove_prefix(rest_.starts_with("\r\n") ? 2 : rest_.empty() ? 0 : 1);
  return line;
}

std::string_view without_mark(std::string_view text) {
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  if (text.starts_with(kMark)) text.remove_prefix(kMark.size());
  return text;
}

void require_utf8(std::string_view text, std::string_view name) {
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff") ||
      text.starts_with(std::string_view("\0\0\xfe\xff", 4)))
    throw Error(ErrorCode::kFile,
                fmt::format("{}: text in UTF-16 or UTF-32; save it as UTF-8", name));
}

std::string_view next_word(std::string_view& line) {
  while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
  std::size_t length = 0;
  while (length < line.size() && !is_blank(line[length])) ++length;
  const std::string_view word = line.substr(0, length);
  line.remove_prefix(length);
  return word;
}

std::string percent_decoded(std::string_view uri) {
  std::string name;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    unsigned char byte = 0;
    const char* digits = uri.data() + i + 1;
    if (uri[i] == '%' && i + 2 < uri.size() &&
        std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2) {
      name += static_cast<char>(byte);
      i += 2;
    } else {
      name += uri[i];
    }
  }
  return name;
}

}  // namespace cde::text
