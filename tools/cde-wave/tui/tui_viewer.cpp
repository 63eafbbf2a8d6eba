// SPDX-License-Identifier: Apache-2.0
#include "tui/tui_viewer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"

namespace cde::wave::tui {
namespace {

using Clock = std::chrono::steady_clock;

/// A piece of work should take less than this, so that keys do not wait.
constexpr std::chrono::milliseconds kShort{12}, kLong{30};

}  // namespace

Viewer::Viewer(Trace& trace, Trace* other, Begin begin)
    : trace_(trace),
      other_trace_(other),
      tracks_(trace),
      times_(trace, std::move(begin.clock)),
      form_(begin.form),
      ascii_(begin.ascii),
      from_(begin.window.begin),
      span_(begin.window.end - begin.window.begin + 1),
      cursor_(begin.cursor) {
  if (span_ == 0) --span_;  // 2^64 times
  if (other != nullptr) {
    if (other->scale() != trace.scale())
      throw Error(ErrorCode::kUsage,
                  fmt::format("the files count time in units of 1e{} s and 1e{} s", trace.scale(),
                              other->scale()));
    other_tracks_.emplace(*other, Tracks::kMostBytes / 2);
    for (const Signal& s : other->signals()) others_.emplace(s.name, &s);
  }
  no_cycles_ = times_.clock_if_any() == nullptr || times_.clock_if_any()->width != 1;
  for (View& v : begin.views) list_.push_back(row_of(std::move(v)));
  lay_out();
}

Viewer::Row Viewer::row_of(View view) {
  Row row{Wave(tracks_, view), std::nullopt, {}};
  if (other_trace_ == nullptr) return row;
  const auto same = others_.find(view.signal.name);
  if (same == others_.end()) return row;
  const Signal& s = *same->second;
  // A signal of another width is compared as a whole, and differs.
  if (s.width != view.signal.width) {
    view.first = 0;
    view.width = s.width;
    view.form = Form{};
  }
  view.signal = s;
  row.other.emplace(*other_tracks_, std::move(view));
  return row;
}

std::size_t Viewer::wave_columns() const {
  return too_small() ? 1 : columns_ - names_ - values_ - 3;
}

void Viewer::resize(std::size_t columns, std::size_t rows) {
  columns_ = columns;
  rows_ = rows;
  lay_out();
}

/// Sets the widths of names and values, and the common begin of all names.
void Viewer::lay_out() {
  scope_ = 0;
  std::size_t name = 8, value = 6;
  if (!list_.empty()) {
    std::string_view common = list_.front().wave.view().label;
    common = common.substr(0, common.rfind('.') + 1);
    for (const Row& r : list_)
      while (!std::string_view(r.wave.view().label).starts_with(common)) {
        common.remove_suffix(1);
        common = common.substr(0, common.rfind('.') + 1);
      }
    scope_ = common.size();
  }
  for (const Row& r : list_) {
    const View& v = r.wave.view();
    name = std::max(name, columns_of(printable_name(v.label.substr(scope_))));
    value = std::max(value, widest(v));
  }
  names_ = std::min(name, columns_ * 3 / 10);
  values_ = std::min(value, columns_ / 5);
  choose(chosen_);
}

std::size_t Viewer::rows_shown() const {
  const std::size_t room = too_small() ? 1 : rows_ - 4;
  std::size_t lines = 0, shown = 0;
  for (std::size_t i = top_; i < list_.size(); ++i, ++shown) {
    lines += lines_of(list_[i]);
    if (lines > room) break;
  }
  return std::max<std::size_t>(shown, 1);
}

void Viewer::choose(std::size_t row) {
  chosen_ = list_.empty() ? 0 : std::min(row, list_.size() - 1);
  top_ = std::min(top_, chosen_);
  while (chosen_ >= top_ + rows_shown()) ++top_;
}

void Viewer::show_message(std::string text, bool error) {
  message_ = printable_name(text.substr(0, text.find('\n')));
  is_error_ = error;
}

/// Sets the window, kept within the file.
void Viewer::set_window(std::uint64_t from, std::uint64_t span) {
  const std::uint64_t all = trace_.end() - trace_.start();
  span_ = all != UINT64_MAX ? std::clamp<std::uint64_t>(span, 1, all + 1)
                            : std::max<std::uint64_t>(span, 1);
  from_ = std::clamp(from, trace_.start(), trace_.end() - (span_ - 1));
}

/// Sets the cursor. If it is outside the window, the window moves, with the cursor in its middle.
void Viewer::move_to(std::uint64_t time) {
  cursor_ = std::clamp(time, trace_.start(), trace_.end());
  if (cursor_ < from_ || cursor_ - from_ >= span_)
    set_window(cursor_ - std::min(cursor_, span_ / 2), span_);
}

void Viewer::zoom(bool in) {
  before_ = Stretch{from_, span_};
  if (cursor_ < from_ || cursor_ - from_ >= span_)
    set_window(cursor_ - std::min(cursor_, span_ / 2), span_);
  // Zooms in until a unit of time has eight columns.
  const std::uint64_t least = std::max<std::uint64_t>(1, wave_columns() / 8);
  std::uint64_t span = in                       ? std::max(span_ / 2, least)
                       : span_ > UINT64_MAX / 2 ? UINT64_MAX
                                                : span_ * 2;
  if (in && span > span_) span = span_;
  const std::uint64_t all = trace_.end() - trace_.start();
  span = all == UINT64_MAX ? span : std::min(span, all + 1);
  // The cursor stays in its column.
  const auto part = static_cast<std::uint64_t>(static_cast<long double>(cursor_ - from_) / span_ *
                                               static_cast<long double>(span));
  set_window(cursor_ - std::min(cursor_, part), span);
}

/// Moves the window together with the cursor.
void Viewer::scroll(bool forward, std::size_t columns) {
  const std::uint64_t from = from_;
  const Scale now = scale();
  const std::uint64_t by = std::max<std::uint64_t>(
      1,
      static_cast<std::uint64_t>(static_cast<long double>(now.span()) * columns / now.columns()));
  if (forward)
    set_window(by > trace_.end() - from_ ? trace_.end() : from_ + by, span_);
  else
    set_window(from_ - std::min(from_, by), span_);
  if (from == from_)
    move_to(forward ? trace_.end() : trace_.start());
  else if (forward)
    move_to(cursor_ + (from_ - from));
  else
    move_to(cursor_ - std::min(cursor_, from - from_));
}

std::optional<std::uint64_t> Viewer::cycle(std::uint64_t time) {
  return cycles_known_ ? times_.cycle(time) : std::nullopt;
}

/// Reads some of the signals, few enough to be quick.
bool Viewer::load(Tracks& tracks, std::size_t block, const std::vector<std::uint32_t>& handles) {
  std::vector<std::uint32_t> some;
  for (const std::uint32_t h : handles)
    if (some.size() < batch_ && tracks.find(h, block) == nullptr) some.push_back(h);
  if (some.empty()) return false;
  const auto begin = Clock::now();
  tracks.load(block, some);
  const auto took = Clock::now() - begin;
  if (took < kShort && some.size() == batch_) batch_ = std::min<std::size_t>(batch_ * 2, 256);
  if (took > kLong) batch_ = std::max<std::size_t>(batch_ / 2, 1);
  return true;
}

const std::vector<Stretch>& Viewer::differences_of(Row& row, std::size_t block) {
  const auto [found, is_new] = row.differ.try_emplace(block);
  if (is_new) found->second = differences(row.wave, *row.other, block);
  return found->second;
}

/// Reads differences in the window. Returns true if there was something to do.
bool Viewer::read_differences() {
  const std::size_t stop = std::min(list_.size(), top_ + rows_shown());
  for (std::size_t i = top_; i < stop; ++i) {
    if (!list_[i].other) continue;
    for (std::size_t k = tracks_.block_of(from_); k <= tracks_.block_of(scale().to()); ++k) {
      if (list_[i].differ.contains(k)) continue;
      (void)differences_of(list_[i], k);
      return true;
    }
  }
  return false;
}

/// Reads a block for some of the signals on the screen, first the block under the cursor.
bool Viewer::read_piece() {
  const std::size_t stop = std::min(list_.size(), top_ + rows_shown());
  const Scale now = scale();
  for (const bool other : {false, true}) {
    std::vector<std::uint32_t> at_cursor;
    std::map<std::size_t, std::vector<std::uint32_t>> of_block;
    Tracks* tracks = nullptr;
    for (std::size_t i = top_; i < stop; ++i) {
      if (other && !list_[i].other) continue;
      Wave& wave = other ? *list_[i].other : list_[i].wave;
      tracks = &wave.tracks();
      if (!wave.value(cursor_)) at_cursor.push_back(wave.view().signal.handle);
      if (const auto block = wave.missing(now))
        of_block[*block].push_back(wave.view().signal.handle);
    }
    if (!at_cursor.empty() && load(*tracks, tracks->block_of(cursor_), at_cursor)) return true;
    for (const auto& [block, handles] : of_block)
      if (load(*tracks, block, handles)) return true;
  }
  return read_differences();
}

bool Viewer::work() {
  if (search_) {
    try {
      if (search_()) search_ = nullptr;
    } catch (const Error& e) {
      search_ = nullptr;
      show_message(e.what(), true);
    }
    if (!search_)
      while (!waiting_.empty() && !search_) {
        const Key k = waiting_.front();
        waiting_.pop_front();
        (void)press(k);
      }
    return true;
  }
  if (!too_small() && read_piece()) return true;
  if (!cycles_known_ && !no_cycles_) {
    (void)times_.edges();
    cycles_known_ = true;
    return true;
  }
  return false;
}

}  // namespace cde::wave::tui
