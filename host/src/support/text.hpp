// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>

/// Text scanning shared by the file readers. Private to the library.
namespace cde::text {

enum class Number { kOk, kMalformed, kOverflow };

/// Converts all of `text` to the nearest float: decimal or 0x hexfloat, with an optional sign, and
/// inf and nan in any case. Values below the smallest subnormal become a zero with their sign. A
/// finite text beyond the largest float is kOverflow.
[[nodiscard]] Number parse_float(std::string_view text, float& value);

/// Converts all of `text` to a decimal integer, unsigned or signed.
template <typename Int>
[[nodiscard]] bool parse_int(std::string_view text, Int& value);

[[nodiscard]] constexpr bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}
[[nodiscard]] std::string_view trim(std::string_view text);

[[noreturn]] void no_entry(std::string_view what, std::size_t number, std::size_t entries);

/// The text without a leading UTF-8 byte order mark.
[[nodiscard]] std::string_view without_mark(std::string_view text);
/// Error kFile if the text begins with a byte order mark of UTF-16 or UTF-32.
void require_utf8(std::string_view text, std::string_view name);

/// Takes lines off the front of a text. Lines end with LF, CRLF or CR; the last line end may be
/// missing.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}
  [[nodiscard]] std::optional<std::string_view> next();
  [[nodiscard]] std::size_t number() const { return number_; }  ///< of the last line taken, from 1
  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
};

/// Decodes a URI's name: %20 becomes a blank, and so on. A % without two following digits stays.
[[nodiscard]] std::string percent_decoded(std::string_view uri);

/// Takes the next run of non-blank characters off the front of `line`; empty at its end.
[[nodiscard]] std::string_view next_word(std::string_view& line);

/// The table's entry for an enumerator. Error kUsage for a cast number that is no enumerator.
template <typename Table, typename Enum>
[[nodiscard]] const auto& entry(const Table& table, Enum value, std::string_view what) {
  const auto number = static_cast<std::size_t>(value);
  if (number >= std::size(table)) no_entry(what, number, std::size(table));
  return table[number];
}

}  // namespace cde::text
