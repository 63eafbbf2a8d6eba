// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "support/table_form.hpp"

/// Tables of numbers as text: lines of rays and of pairs. Private to the library.
namespace cde::text {

/// The separator of a line's fields.
enum class Separator { kBlank, kTab, kComma, kSemicolon };

/// A field without surrounding blanks and quotes.
struct Field {
  std::string_view text;
  std::size_t column;  ///< of its first character in the line, from 1
  bool quoted;
};

/// A problem in a line, and its place.
struct Problem {
  std::size_t column;  ///< from 1
  std::string why;
};

inline constexpr std::size_t kNoBar = static_cast<std::size_t>(-1);

/// A line split into fields. Outside of quotes, a semicolon makes semicolons the separator.
/// Otherwise a comma makes it commas, and otherwise a tab makes it tabs. Lines without any of them
/// are separated by runs of blanks. Two adjacent semicolons, commas or tabs enclose an empty field.
struct SplitLine {
  Separator separator = Separator::kBlank;
  std::vector<Field> fields;
  std::size_t bar = kNoBar;  ///< number of fields before the |
  /// False skips the search, if no line has the character.
  bool may_have_quotes = true, may_have_semicolons = true;
};
[[nodiscard]] std::optional<Problem> split(std::string_view line, bool bars, SplitLine& to);

/// "'5 1' is not a number". Adds the line's separator if that may be the cause.
[[nodiscard]] std::string not_a_number(const Field& field, Separator separator);

/// Reads the lines of a table: comments, an optional header, and rows.
class TableText {
 public:
  enum class Kind { kNothing, kHeader, kRow };

  /// The form must outlive this object.
  explicit TableText(const TableForm& form) : form_(form) {}

  /// Classifies a line. After a row, fields() and related getters describe it.
  /// - Nothing: an empty line or a comment (#).
  /// - A header: the first line of the table, if its first field begins with a letter and is not a
  ///   number. It names the columns. A comment before the first row is also a header if it consists
  ///   of column names, as numpy.savetxt writes it. A first name that is empty or "Unnamed: 0"
  ///   marks row numbers, as pandas writes them: whole numbers that count from 0 or 1.
  /// - A row: any other line.
  [[nodiscard]] std::optional<Problem> read(std::string_view line, Kind& kind);
  /// Reads a line that must be a row.
  [[nodiscard]] std::optional<Problem> read_row(std::string_view line);
  /// Reads a line before the first row, and takes it only if it is a header.
  [[nodiscard]] std::optional<Problem> read_header(std::string_view line, bool& is_header);
  /// Counts rows that were read elsewhere: row numbers continue after them.
  void skip_rows(std::uint64_t rows) { rows_ = rows; }

  /// Declares that no later line is a header.
  void no_header() { begun_ = true; }
  /// Looks at all lines at once: later calls skip the search for characters that none has.
  void look_at(std::string_view all);

  /// Fields of the row, without its row number.
  [[nodiscard]] std::span<const Field> fields() const { return fields_; }
  [[nodiscard]] Separator separator() const { return line_.separator; }
  [[nodiscard]] std::size_t bar() const { return line_.bar; }
  [[nodiscard]] bool named() const { return named_; }  ///< whether a header named the columns
  /// Number of columns in the header, or else the most that the form allows.
  [[nodiscard]] std::size_t columns() const { return named_ ? names_.size() : form_.names.size(); }
  /// The form's number for a field of the row.
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
  bool numbered_ = false, may_be_numbered_ = false;  ///< whether there is a column of row numbers
  std::uint64_t rows_ = 0;
  std::optional<std::uint64_t> first_number_;
  char mark_ = 0;       ///< decimal mark, with semicolon separators
  std::string points_;  ///< the line with decimal points
};

}  // namespace cde::text
