// SPDX-License-Identifier: Apache-2.0
#include "cde/support/message.hpp"

#include "cde/support/progress.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>

namespace cde {
namespace {

struct Character {
  std::size_t length = 1;
  std::uint32_t code = 0;
  bool valid = false;
};

/// The first character of a nonempty text, by the table of well-formed UTF-8 (Unicode table 3-7).
/// For a malformed one, the length covers the longest prefix that could begin a character.
Character first(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const std::uint32_t lead = byte(0);
  if (lead < 0x80) return {1, lead, true};
  const std::size_t length = lead >= 0xc2 && lead <= 0xdf   ? 2
                             : lead >= 0xe0 && lead <= 0xef ? 3
                             : lead >= 0xf0 && lead <= 0xf4 ? 4
                                                            : 1;
  if (length == 1) return {};
  std::uint32_t code = lead & (0x7fu >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if (i == text.size()) return {i, 0, false};
    std::uint32_t low = 0x80, high = 0xbf;
    if (i == 1) {
      if (lead == 0xe0) low = 0xa0;
      if (lead == 0xed) high = 0x9f;
      if (lead == 0xf0) low = 0x90;
      if (lead == 0xf4) high = 0x8f;
    }
    if (byte(i) < low || byte(i) > high) return {i, 0, false};
    code = code << 6 | (byte(i) & 0x3fu);
  }
  return {length, code, true};
}

bool controls(std::uint32_t code) {
  return code < 0x20 || (code >= 0x7f && code <= 0x9f) || code == 0x061c || code == 0x200e ||
         code == 0x200f || (code >= 0x2028 && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
}

enum class Style { kText, kJson };

std::string escaped(std::string_view text, std::string_view allowed, Style style = Style::kText) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const Character c = first(text);
    const std::string_view bytes = text.substr(0, c.length);
    if (!c.valid)
      for (const char b : bytes) out += fmt::format("\\x{:02x}", static_cast<unsigned char>(b));
    else if (!controls(c.code) || allowed.find(bytes) != std::string_view::npos)
      out += bytes;
    else if (c.code <= 0xff && style == Style::kText)
      out += fmt::format("\\x{:02x}", c.code);
    else
      out += fmt::format("\\u{:04x}", c.code);
    text.remove_prefix(c.length);
  }
  return out;
}

std::size_t count_characters(std::string_view text) {
  std::size_t count = 0;
  for (; !text.empty(); ++count) text.remove_prefix(first(text).length);
  return count;
}

/// The text without its first characters.
std::string_view after(std::string_view text, std::size_t characters) {
  for (; characters > 0; --characters) text.remove_prefix(first(text).length);
  return text;
}

/// The first and last characters of a text of more than `most` characters, with their number.
std::string without_middle(std::string_view text, std::size_t most, std::size_t at_front,
                           std::size_t at_end) {
  if (text.size() <= most) return std::string(text);
  const std::size_t count = count_characters(text);
  if (count <= most) return std::string(text);
  const std::string_view front = text.substr(0, text.size() - after(text, at_front).size());
  return fmt::format("{}...{} ({} characters)", front, after(text, count - at_end), count);
}

}  // namespace

std::string printable(std::string_view text) {
  return escaped(text, "\n\t");
}

std::string printable_name(std::string_view name) {
  return escaped(name, "");
}

std::string shortened(std::string_view message) {
  constexpr std::size_t kLongestWord = 1000, kLongest = 6000;
  if (message.size() <= kLongestWord) return std::string(message);
  // The marks around a name belong to the message.
  constexpr std::string_view kBlanks = " \t\r\n", kBefore = "'\"`(", kBehind = "'\"`),;:.";
  std::string out;
  while (!message.empty()) {
    const std::size_t end = std::min(message.find_first_of(kBlanks), message.size());
    const std::string_view word = message.substr(0, end);
    const std::size_t begins = std::min(word.find_first_not_of(kBefore), end);
    const std::size_t ends = std::max(word.find_last_not_of(kBehind) + 1, begins);
    out += word.substr(0, begins);
    out += without_middle(word.substr(begins, ends - begins), kLongestWord, 100, 50);
    out += word.substr(ends);
    message.remove_prefix(end);
    if (message.empty()) break;
    out += message.front();
    message.remove_prefix(1);
  }
  return without_middle(out, kLongest, 4000, 1000);
}

std::string printable_json(std::string_view json) {
  return escaped(json, "\n", Style::kJson);
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kLongest = 48;  // characters
  std::string_view rest = text;
  for (std::size_t n = 0; n < kLongest && !rest.empty(); ++n)
    rest.remove_prefix(first(rest).length);
  return fmt::format("'{}{}'", printable_name(text.substr(0, text.size() - rest.size())),
                     rest.empty() ? "" : "...");
}

std::string valid_utf8(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const Character c = first(text);
    out += c.valid ? text.substr(0, c.length) : "\xef\xbf\xbd";
    text.remove_prefix(c.length);
  }
  return out;
}

void log(std::string_view text) {
  clear_progress();
  const std::string shown = printable(text);
  (void)std::fwrite(shown.data(), 1, shown.size(), stderr);
}

}  // namespace cde
