// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cde/wave/value.hpp"
#include "tui/tui_canvas.hpp"
#include "tui/tui_tracks.hpp"

namespace cde::wave::tui {

/// The part of a file that is on the screen, and its columns.
class Scale {
 public:
  Scale(std::uint64_t from, std::uint64_t span, std::size_t columns)
      : from_(from), span_(span), columns_(columns) {}

  [[nodiscard]] std::uint64_t from() const { return from_; }
  [[nodiscard]] std::uint64_t to() const { return from_ + (span_ - 1); }
  [[nodiscard]] std::uint64_t span() const { return span_; }
  [[nodiscard]] std::size_t columns() const { return columns_; }
  /// The column of a time that is on the screen.
  [[nodiscard]] std::size_t column(std::uint64_t time) const;
  /// The first time that is in a column or behind it; `columns()` has the one behind the screen.
  [[nodiscard]] std::uint64_t first(std::size_t column) const;
  /// The time that a column stands for: its first, or the one that several columns share.
  [[nodiscard]] std::uint64_t time(std::size_t column) const;
  bool operator==(const Scale&) const = default;

 private:
  std::uint64_t from_, span_;
  std::size_t columns_;
};

/// What a signal does in a column.
struct Cell {
  std::string bits;      ///< at its end; empty: not read yet
  unsigned changes = 0;  ///< in it; at most 2 are told apart
};

/// The waves of a view, as far as they are read.
class Wave {
 public:
  Wave(Tracks& tracks, View view) : tracks_(&tracks), view_(std::move(view)) {}

  [[nodiscard]] const View& view() const { return view_; }
  void set_form(const Form& form) {
    view_.form = form;
    time_.reset();
  }
  /// Takes what is there; the first block that must be read, if one must.
  [[nodiscard]] std::optional<std::size_t> missing(const Scale& scale);
  [[nodiscard]] const std::vector<Cell>& cells() const { return cells_; }
  /// Cells without a value are outside of the file, and not unread.
  [[nodiscard]] bool complete() const { return complete_; }
  /// The value at a time as text, if the block is there; it is kept.
  [[nodiscard]] const std::optional<std::string>& value(std::uint64_t time);
  [[nodiscard]] Tracks& tracks() const { return *tracks_; }

 private:
  void fill(const Track& track, const Stretch& block);

  Tracks* tracks_;
  View view_;
  std::optional<Scale> scale_;
  std::vector<Cell> cells_;
  std::size_t next_ = 0;  ///< block
  std::optional<std::uint64_t> time_;
  std::optional<std::string> bits_, text_;
  bool complete_ = false;
};

/// Where two views differ in a block of the first one's file, in order, apart from each other.
/// Nothing behind the end of the shorter file.
[[nodiscard]] std::vector<Stretch> differences(Wave& a, Wave& b, std::size_t block);

/// How waves are drawn.
struct Glyphs {
  const char *high, *low, *rise, *fall, *change, *busy, *unknown, *unread, *cut, *tick;
};
[[nodiscard]] const Glyphs& glyphs(bool ascii);

/// Draws a wave into a row of a canvas.
void draw_wave(Canvas& canvas, std::size_t row, std::size_t column, const Wave& wave,
               const Glyphs& glyphs, Ink ink);

/// Columns that values of a view may take.
[[nodiscard]] std::size_t widest(const View& view);

}  // namespace cde::wave::tui
