// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "cde/fp/number_text.hpp"
#include "cde/geometry/pair.hpp"

/// Pairs as text, a line each (docs/reference/pairs.md#as-text).
namespace cde {

enum class OperandLine { kNothing, kMalformed, kPair };

/// Takes the lines of a text, one by one: a header if there is one, comments, pairs.
class OperandText {
 public:
  OperandText(PairName named, const WordText& text);
  OperandText(OperandText&&) noexcept;
  OperandText& operator=(OperandText&&) noexcept;
  ~OperandText();

  /// Takes the line if it is a header, which names the columns, and says whether it is. It must
  /// come before all pairs. Error kFile for a header that names other columns, one of them twice or
  /// not all; `where` names the line.
  bool take_header(std::string_view line, const std::string& where);
  /// No line that follows is a header.
  void no_header();
  /// Pairs that were read elsewhere: a column of row numbers goes on from there.
  void skip(std::uint64_t pairs);

  /// Appends the words of A and of B, in slot order, if the line has them, those of B first where
  /// the pair is named so. Nothing is an empty line, a comment (#) and a header. `why` says what is
  /// wrong with a malformed line. Error kFile for a malformed header.
  [[nodiscard]] OperandLine read(std::string_view line, const std::string& where,
                                 std::vector<std::uint64_t>& a, std::vector<std::uint64_t>& b,
                                 std::string& why);

  /// Whether a line has a pair, or is malformed, where it is no header.
  [[nodiscard]] static bool has_pair(std::string_view line);
  /// The first line of a text without a UTF-8 byte order mark. Error kFile if it is UTF-16 or
  /// UTF-32; `name` is that of the text.
  [[nodiscard]] static std::string_view first_line(std::string_view line, std::string_view name);

 private:
  struct Table;
  std::unique_ptr<Table> table_;
};

/// A line that is no header: OperandText::read of a single line.
[[nodiscard]] OperandLine read_operands(PairName named, const WordText& text,
                                        const std::string& where, std::string_view line,
                                        std::vector<std::uint64_t>& a,
                                        std::vector<std::uint64_t>& b, std::string& why);

/// Whether A is a ray.
[[nodiscard]] bool has_ray(Pair pair);

}  // namespace cde
