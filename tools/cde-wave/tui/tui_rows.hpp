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

/// The part of a file on the screen, and its columns.
class Scale {
 public:
  Scale(std::uint64_t from, std::uint64_t span, std::size_t columns)
      : from_(from), span_(span), columns_(columns) {}

  [[nodiscard]] std::uint64_t from() const { return from_; }
  [[nodiscard]] std::uint64_t to() const { return from_ + (span_ - 1); }
  [[nodiscard]] std::uint64_t span() const { return span_; }
  [[nodiscard]] std::size_t columns() const { return columns_; }
  /// The column of a time on the screen.
  [[nodiscard]] std::size_t column(std::uint64_t time) const;
  /// The first time in a column or after it. For column `columns()`, the first time after the
  /// screen.
  [[nodiscard]] std::uint64_t first(std::size_t column) const;
  /// The time of a column: its first time, or the time that several columns share.
  [[nodiscard]] std::uint64_t time(std::size_t column) const;
  bool operator==(const Scale&) const = default;

 private:
  std::uint64_t from_, span_;
  std::size_t columns_;
};

/// The activity of a signal in a column.
struct Cell {
  std::string bits;      ///< value at the end of the column; empty: not read yet
  unsigned changes = 0;  ///< changes in the column, counted up to 2
};

/// The waves of a view, as far as they have been read.
class Wave {
 public:
  Wave(Tracks& tracks, View view) : tracks_(&tracks), view_(std::move(view)) {}

  [[nodiscard]] const View& view() const { return view_; }
  void set_form(const Form& form) {
    view_.form = form;
    time_.reset();
  }
  /// Takes the blocks that are loaded. Returns the first block that must be read, if any.
  [[nodiscard]] std::optional<std::size_t> missing(const Scale& scale);
  [[nodiscard]] const std::vector<Cell>& cells() const { return cells_; }
  /// Whether everything is read: cells without a value are outside the file.
  [[nodiscard]] bool complete() const { return complete_; }
  /// The value at a time as text, if its block is loaded. The text is cached.
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

/// The stretches where two views differ in a block of the first one's file, in order and disjoint.
/// There are none after the end of the shorter file.
[[nodiscard]] std::vector<Stretch> differences(Wave& a, Wave& b, std::size_t block);

/// Characters for drawing waves.
struct Glyphs {
  const char *high, *low, *rise, *fall, *change, *busy, *unknown, *unread, *cut, *tick;
};
[[nodiscard]] const Glyphs& glyphs(bool ascii);

/// Draws a wave into a row of a canvas.
void draw_wave(Canvas& canvas, std::size_t row, std::size_t column, const Wave& wave,
               const Glyphs& glyphs, Ink ink);

/// The most columns that a value of a view can take.
[[nodiscard]] std::size_t widest(const View& view);

}  // namespace cde::wave::tui
