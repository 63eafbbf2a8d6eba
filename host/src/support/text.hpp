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

/// The float nearest to the whole of `text`: decimal or 0x hexfloat, optional sign, inf and nan in
/// any case. Values below the smallest subnormal become a zero of their sign; a finite text beyond
/// the largest float is kOverflow.
[[nodiscard]] Number parse_float(std::string_view text, float& value);

/// An unsigned or signed decimal integer that fills `text`.
template <typename Int>
[[nodiscard]] bool parse_int(std::string_view text, Int& value);

[[nodiscard]] constexpr bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}
[[nodiscard]] std::string_view trim(std::string_view text);

[[noreturn]] void no_entry(std::string_view what, std::size_t number, std::size_t entries);

/// The text without a UTF-8 byte order mark at its front.
[[nodiscard]] std::string_view without_mark(std::string_view text);
/// Error kFile if the text begins with a byte order mark of UTF-16 or UTF-32.
void require_utf8(std::string_view text, std::string_view name);

/// Takes lines off the front of a text; line ends are LF, CRLF or CR, the last may be missing.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}
  [[nodiscard]] std::optional<std::string_view> next();
  [[nodiscard]] std::size_t number() const { return number_; }  ///< of the line last taken, from 1
  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
};

/// A name as a URI has it: %20 is a blank, and so on. A % without two digits behind it stays.
[[nodiscard]] std::string percent_decoded(std::string_view uri);

/// Takes the next run of non-blank characters off the front of `line`; empty at its end.
[[nodiscard]] std::string_view next_word(std::string_view& line);

/// What a table has for an enumerator. Error kUsage if it is none: a number that was cast.
template <typename Table, typename Enum>
[[nodiscard]] const auto& entry(const Table& table, Enum value, std::string_view what) {
  const auto number = static_cast<std::size_t>(value);
  if (number >= std::size(table)) no_entry(what, number, std::size(table));
  return table[number];
}

}  // namespace cde::text
