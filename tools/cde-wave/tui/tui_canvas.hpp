// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// The content of a terminal's screen, without a terminal.
namespace cde::wave::tui {

/// The role of a character. The terminal chooses its colours.
enum class Ink : std::uint8_t {
  kPlain,
  kFaint,
  kTitle,
  kRuler,
  kName,
  kOther,  ///< belongs to the second file
  kValue,
  kWave,
  kBus,
  kUnknown,
  kBusy,
  kStatus,
  kError,
  kHeading,
};

struct Style {
  Ink ink = Ink::kPlain;
  bool cursor = false, second = false;  ///< in the column of a cursor
  bool differs = false;                 ///< the two files differ here
  bool chosen = false;                  ///< in the row that keys act on
  bool operator==(const Style&) const = default;
};

struct Glyph {
  char32_t c = U' ';  ///< 0 after a character of two columns
  Style style;
};

/// Columns that a text takes. Characters without width are not written.
[[nodiscard]] std::size_t columns_of(std::string_view text);

/// Rows and columns of characters. Text outside is dropped.
class Canvas {
 public:
  Canvas(std::size_t columns, std::size_t rows)
      : columns_(columns), rows_(rows), glyphs_(columns * rows) {}

  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] const Glyph& at(std::size_t row, std::size_t column) const {
    return glyphs_[row * columns_ + column];
  }
  [[nodiscard]] Glyph& at(std::size_t row, std::size_t column) {
    return glyphs_[row * columns_ + column];
  }
  /// Writes UTF-8 text, at most `most` columns of it. Returns the columns that it took.
  std::size_t put(std::size_t row, std::size_t column, std::string_view text, Style style,
                  std::size_t most = SIZE_MAX);
  void fill(std::size_t row, std::size_t column, std::size_t columns, Style style,
            char32_t c = U' ');
  /// A row as UTF-8, without spaces at its end.
  [[nodiscard]] std::string text(std::size_t row) const;

  /// The place of the terminal's own cursor; hidden if the column is after the last one.
  std::size_t caret_row = 0, caret_column = SIZE_MAX;

 private:
  std::size_t columns_, rows_;
  std::vector<Glyph> glyphs_;
};

/// A text cut to so many columns at its end or begin. `cut` replaces the removed part.
[[nodiscard]] std::string cut_end(std::string_view text, std::size_t columns, std::string_view cut);
[[nodiscard]] std::string cut_begin(std::string_view text, std::size_t columns,
                                    std::string_view cut);

/// The characters of a valid UTF-8 text.
[[nodiscard]] std::u32string characters(std::string_view text);
[[nodiscard]] std::string utf8(std::u32string_view characters);

}  // namespace cde::wave::tui
