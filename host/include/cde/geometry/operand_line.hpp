// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "cde/fp/number_text.hpp"
#include "cde/geometry/pair.hpp"

/// @file
/// Pairs as text, one per line (`docs/reference/pairs.md#as-text`).
namespace cde {

enum class OperandLine { kNothing, kMalformed, kPair };

/// Parses the lines of a text one by one: an optional header, comments, pairs.
class OperandText {
 public:
  OperandText(PairName named, const WordText& text);
  OperandText(OperandText&&) noexcept;
  OperandText& operator=(OperandText&&) noexcept;
  ~OperandText();

  /// Parses the line if it is a header, which names the columns. Returns whether it is one. The
  /// header must precede all pairs. Error kFile for a header with unknown, doubled or missing
  /// columns; `where` names the line.
  bool take_header(std::string_view line, const std::string& where);
  /// Treats no later line as a header.
  void no_header();
  /// Counts pairs that were read elsewhere, so that a column of row numbers continues after them.
  void skip(std::uint64_t pairs);

  /// Appends the words of A and of B in slot order if the line has them. The text has the words of
  /// B first if the pair is named in exchanged order. kNothing is an empty line, a comment (#) or a
  /// header. `why` explains a malformed line. Error kFile for a malformed header.
  [[nodiscard]] OperandLine read(std::string_view line, const std::string& where,
                                 std::vector<std::uint64_t>& a, std::vector<std::uint64_t>& b,
                                 std::string& why);

  /// Whether a line that is not a header has a pair or is malformed.
  [[nodiscard]] static bool has_pair(std::string_view line);
  /// The first line of a text without its UTF-8 byte order mark. Error kFile if the text is UTF-16
  /// or UTF-32; `name` names the text.
  [[nodiscard]] static std::string_view first_line(std::string_view line, std::string_view name);

 private:
  struct Table;
  std::unique_ptr<Table> table_;
};

/// OperandText::read for a single line that is not a header.
[[nodiscard]] OperandLine read_operands(PairName named, const WordText& text,
                                        const std::string& where, std::string_view line,
                                        std::vector<std::uint64_t>& a,
                                        std::vector<std::uint64_t>& b, std::string& why);

/// Whether A is a ray.
[[nodiscard]] bool has_ray(Pair pair);

}  // namespace cde
