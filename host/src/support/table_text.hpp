// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "support/table_form.hpp"

/// Tables of numbers as text: the lines of rays and of pairs. Private to the library.
namespace cde::text {

/// What separates the fields of a line.
enum class Separator { kBlank, kTab, kComma, kSemicolon };

/// A field without the blanks around it and without its quotes.
struct Field {
  std::string_view text;
  std::size_t column;  ///< of its first character in the line, from 1
  bool quoted;
};

/// What is wrong with a line, and where.
struct Problem {
  std::size_t column;  ///< from 1
  std::string why;
};

inline constexpr std::size_t kNoBar = static_cast<std::size_t>(-1);

/// A line as fields. A line with a semicolon outside of quotes is separated by semicolons, else one
/// with a comma by commas, else one with a tab by tabs, else it is separated by runs of blanks.
/// Between two semicolons, commas or tabs is an empty field.
struct SplitLine {
  Separator separator = Separator::kBlank;
  std::vector<Field> fields;
  std::size_t bar = kNoBar;  ///< fields before the |
  /// What no line has need not be looked for.
  bool may_have_quotes = true, may_have_semicolons = true;
};
[[nodiscard]] std::optional<Problem> split(std::string_view line, bool bars, SplitLine& to);

/// "'5 1' is not a number", with what separates the fields of the line if that may be the cause.
[[nodiscard]] std::string not_a_number(const Field& field, Separator separator);

/// Takes the lines of a table: comments, a header if there is one, rows.
class TableText {
 public:
  enum class Kind { kNothing, kHeader, kRow };

  /// The form must outlive it.
  explicit TableText(const TableForm& form) : form_(form) {}

  /// Says what a line is; fields and the like are then those of a row. A line is
  /// - nothing if it is empty or a comment (#);
  /// - a header if no row or header came before and its first field begins with a letter and is no
  ///   number. It names the columns. So does a comment ahead of the first row that is made of names
  ///   of columns alone, as numpy.savetxt writes one. A first name that is empty, or "Unnamed: 0",
  ///   is that of row numbers, as pandas writes them: whole numbers counted from 0 or 1;
  /// - a row.
  [[nodiscard]] std::optional<Problem> read(std::string_view line, Kind& kind);
  /// The same for a line that is a row.
  [[nodiscard]] std::optional<Problem> read_row(std::string_view line);
  /// The same for a line ahead of the first row, which is taken only if it is a header.
  [[nodiscard]] std::optional<Problem> read_header(std::string_view line, bool& is_header);
  /// Rows that were taken elsewhere: row numbers go on from there.
  void skip_rows(std::uint64_t rows) { rows_ = rows; }

  /// No line that follows is a header.
  void no_header() { begun_ = true; }
  /// All of the lines: what none of them has is not looked for in each.
  void look_at(std::string_view all);

  /// Fields of the row, without its row number.
  [[nodiscard]] std::span<const Field> fields() const { return fields_; }
  [[nodiscard]] Separator separator() const { return line_.separator; }
  [[nodiscard]] std::size_t bar() const { return line_.bar; }
  [[nodiscard]] bool named() const { return named_; }  ///< by a header
  /// Columns that the header names, or all that there may be.
  [[nodiscard]] std::size_t columns() const { return named_ ? names_.size() : form_.names.size(); }
  /// Which name of the form a field of the row has.
  [[nodiscard]] std::size_t name_of(std::size_t field) const {
    return named_ ? names_[field] : field;
  }

 private:
  [[nodiscard]] bool looks_like_header() const;
  [[nodiscard]] std::optional<Problem> take_names(std::string_view line);
  void take_comment(std::string_view line, Kind& kind);
  [[nodiscard]] std::optional<Problem> take_row_number(std::uint64_t row);
  [[nodiscard]] std::optional<Problem> take_decimal_commas(std::string_view line);

  const TableForm& form_;
  SplitLine line_;
  std::span<Field> fields_;
  std::vector<std::size_t> names_;
  bool begun_ = false, named_ = false;
  bool numbered_ = false, may_be_numbered_ = false;  ///< a column of row numbers
  std::uint64_t rows_ = 0;
  std::optional<std::uint64_t> first_number_;
  char mark_ = 0;       ///< of decimals, where semicolons separate
  std::string points_;  ///< the line with decimal points
};

}  // namespace cde::text
