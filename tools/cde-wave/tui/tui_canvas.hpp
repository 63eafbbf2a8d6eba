// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// What a terminal shows, without one.
namespace cde::wave::tui {

/// What a character is; the terminal has its colours.
enum class Ink : std::uint8_t {
  kPlain,
  kFaint,
  kTitle,
  kRuler,
  kName,
  kOther,  ///< of the second file
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
  bool cursor = false, second = false;  ///< a column of a cursor
  bool differs = false;                 ///< the two files differ here
  bool chosen = false;                  ///< the row that keys are about
  bool operator==(const Style&) const = default;
};

struct Glyph {
  char32_t c = U' ';  ///< 0 behind a character of two columns
  Style style;
};

/// Columns that a text takes. What has no width is not written.
[[nodiscard]] std::size_t columns_of(std::string_view text);

/// Rows and columns of characters. What is written outside is lost.
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
  /// UTF-8, at most `most` columns of it; the columns that it took.
  std::size_t put(std::size_t row, std::size_t column, std::string_view text, Style style,
                  std::size_t most = SIZE_MAX);
  void fill(std::size_t row, std::size_t column, std::size_t columns, Style style,
            char32_t c = U' ');
  /// A row as UTF-8, without spaces at its end.
  [[nodiscard]] std::string text(std::size_t row) const;

  /// Where the terminal's own cursor stands; nowhere if the column is behind the last.
  std::size_t caret_row = 0, caret_column = SIZE_MAX;

 private:
  std::size_t columns_, rows_;
  std::vector<Glyph> glyphs_;
};

/// Cut to so many columns, at the end or at the begin, where `cut` then stands.
[[nodiscard]] std::string cut_end(std::string_view text, std::size_t columns, std::string_view cut);
[[nodiscard]] std::string cut_begin(std::string_view text, std::size_t columns,
                                    std::string_view cut);

/// Characters of a valid UTF-8 text.
[[nodiscard]] std::u32string characters(std::string_view text);
[[nodiscard]] std::string utf8(std::u32string_view characters);

}  // namespace cde::wave::tui
