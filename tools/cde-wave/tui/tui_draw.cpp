// SPDX-License-Identifier: Apache-2.0
// Draws the viewer's screen.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "cde/support/message.hpp"
#include "cde/wave/blackouts.hpp"
#include "tui/tui_viewer.hpp"

namespace cde::wave::tui {
namespace {

constexpr std::array<std::pair<const char*, const char*>, 38> kHelp = {{
    {"", "Time"},
    {"h l  left right", "move the cursor by one column"},
    {"H L  shift-left, -right", "scroll by half a screen"},
    {"w b", "next or previous change of the signal"},
    {"g :", "go to a time (75ns, cyc:7, fail-40cyc, end) or a window"},
    {"0 $  home end", "begin or end of the file"},
    {"+ -  i o", "zoom in or out around the cursor"},
    {"=", "show the whole file"},
    {"u", "go back to the last window"},
    {"c", "centre the cursor"},
    {"m", "set the second cursor here, or remove it"},
    {"'", "exchange the cursors"},
    {"z", "show the window between the cursors"},
    {"", "Signals"},
    {"j k  down up", "next or previous signal"},
    {"page down, page up", "scroll by a screen of signals"},
    {"^ G", "first or last signal"},
    {"a", "list all signals of the file, to add or remove some"},
    {"x  delete", "remove the signal"},
    {"J K", "move the signal down or up"},
    {"v", "next form of its values"},
    {"V", "set its form: hex, dec, signed, bin, fp32, eEmM, FORM/32"},
    {"", "Search"},
    {"/", "find a signal of the list by a part of its name, or *"},
    {"f", "find an expression as in cde wave find: count > 4 && valid"},
    {"", "at edges only: valid && ready @posedge clk"},
    {"n N", "next or previous match"},
    {"t T", "next or previous transaction"},
    {"y", "choose a kind of transactions: pci, bus, pass, ...; empty: all"},
    {"d D", "next or previous difference from --diff"},
    {"B", "show or hide the second file"},
    {"escape", "stop a search"},
    {"", "In a list of signals"},
    {"up down, enter", "add or remove the marked one"},
    {"tab, delete", "add or remove all matches; NAME[3]:fp32 is a lane"},
    {"", ""},
    {"? F1", "this help; any other key closes it"},
    {"q  control-C", "quit"},
}};

/// The least 1, 2 or 5 times a power of ten that is not below `least`.
std::uint64_t round_step(std::uint64_t least) {
  std::uint64_t power = 1;
  for (; power <= UINT64_MAX / 10; power *= 10)
    for (const std::uint64_t m : {1u, 2u, 5u})
      if (power * m >= least) return power * m;
  return power;
}

}  // namespace

/// A time with its cycle.
std::string Viewer::when(std::uint64_t time) {
  const auto number = cycle(time);
  return times_.text(time) + (number ? fmt::format(" cyc:{}", *number) : "");
}

Canvas Viewer::draw() {
  Canvas canvas(columns_, rows_);
  if (too_small()) {
    const std::array<std::string, 3> lines = {
        "too small", fmt::format("{}x{} are", kLeastColumns, kLeastRows), "needed; q quits"};
    for (std::size_t i = 0; i < lines.size(); ++i) canvas.put(i, 0, lines[i], {});
    return canvas;
  }
  draw_title(canvas);
  if (show_ == Show::kHelp) {
    draw_help(canvas);
  } else if (ask_ == Ask::kList) {
    draw_list(canvas);
  } else {
    draw_ruler(canvas, 1);
    draw_rows(canvas);
    draw_cursors(canvas);
  }
  draw_status(canvas, rows_ - 2);
  if (show_ == Show::kHelp) return canvas;
  if (ask_ != Ask::kNothing)
    draw_prompt(canvas, rows_ - 1);
  else
    draw_message(canvas, rows_ - 1);
  return canvas;
}

void Viewer::draw_title(Canvas& canvas) {
  const Style style{Ink::kTitle};
  canvas.fill(0, 0, columns_, style);
  std::string text = fmt::format(" {}", printable_name(trace_.file().filename().string()));
  if (other_trace_ != nullptr)
    text += " | " + printable_name(other_trace_->file().filename().string());
  if (scope_ != 0)
    text += "  " + printable_name(list_.front().wave.view().label.substr(0, scope_ - 1));
  const Scale now = scale();
  const std::string window =
      fmt::format("{} to {} ", times_.text(now.from()), times_.text(now.to()));
  const std::size_t room = columns_ - std::min(columns_, columns_of(window));
  canvas.put(0, 0, cut_end(text, room - std::min<std::size_t>(room, 1), glyphs(ascii_).cut), style);
  canvas.put(0, room, window, style);
}

/// Draws ticks at round times.
void Viewer::draw_ruler(Canvas& canvas, std::size_t row) {
  const Scale now = scale();
  const std::size_t left = names_ + values_ + 2;
  canvas.put(row, 0, cut_end("signal", names_, ""), {Ink::kFaint});
  canvas.put(row, names_ + 1, cut_end("value", values_, ""), {Ink::kFaint});
  const std::size_t label = columns_of(times_.text(now.to())) + 3;
  const auto apart =
      static_cast<std::uint64_t>(static_cast<long double>(now.span()) *
                                 static_cast<long double>(std::max(label, std::size_t{10})) /
                                 static_cast<long double>(now.columns()));
  const std::uint64_t step = round_step(std::max<std::uint64_t>(apart, 1));
  std::uint64_t time = now.from() / step * step;
  if (time < now.from()) time += step;
  const std::string_view not_dumped = ascii_ ? "/" : "░";
  for (const Blackout& b : blackouts_in(trace_, now.from(), now.to()))
    for (std::size_t c = now.column(b.from); c <= now.column(b.to); ++c)
      canvas.put(row, left + c, not_dumped, {Ink::kFaint});
  for (; time >= now.from() && time <= now.to(); time += step) {
    const std::size_t column = now.column(time);
    const std::string text = glyphs(ascii_).tick + times_.text(time);
    if (column + columns_of(text) <= now.columns())
      canvas.put(row, left + column, text, {Ink::kRuler});
    if (time > UINT64_MAX - step) break;
  }
}

void Viewer::draw_line(Canvas& canvas, std::size_t line, Row& row, bool other, bool chosen) {
  Wave& wave = other ? *row.other : row.wave;
  const Glyphs& g = glyphs(ascii_);
  const Scale now = scale();
  (void)wave.missing(now);
  const std::size_t left = names_ + values_ + 2;
  const Style name{other ? Ink::kOther : Ink::kName, false, false, false, chosen && !other};
  const std::string label =
      other ? (ascii_ ? "` other" : "└ other") : printable_name(wave.view().label.substr(scope_));
  canvas.fill(line, 0, names_, name);
  canvas.put(line, 0, cut_begin(label, names_, g.cut), name);
  const auto& value = wave.value(cursor_);
  Style style{other ? Ink::kOther : Ink::kValue};
  if (row.other) {
    const auto& theirs = row.other->value(cursor_);
    const auto& ours = row.wave.value(cursor_);
    style.differs = ours && theirs && !theirs->empty() && *ours != *theirs;
  }
  canvas.put(line, names_ + 1, cut_end(value ? *value : g.unread, values_, g.cut), style);
  draw_wave(canvas, line, left, wave, g, other ? Ink::kOther : Ink::kWave);
  if (row.other) mark_differences(canvas, line, row);
}

void Viewer::mark_differences(Canvas& canvas, std::size_t line, const Row& row) {
  const Scale now = scale();
  const std::size_t left = names_ + values_ + 2;
  for (std::size_t k = tracks_.block_of(now.from()); k <= tracks_.block_of(now.to()); ++k) {
    const auto found = row.differ.find(k);
    if (found == row.differ.end()) continue;
    auto s = std::partition_point(found->second.begin(), found->second.end(),
                                  [&](const Stretch& d) { return d.end < now.from(); });
    for (; s != found->second.end() && s->begin <= now.to(); ++s) {
      // Several columns may show one time.
      const std::size_t stop = s->end >= now.to()
                                   ? now.columns()
                                   : std::max(now.column(s->end) + 1, now.column(s->end + 1));
      const std::size_t first = now.column(std::max(s->begin, now.from()));
      for (std::size_t c = first; c < stop; ++c) canvas.at(line, left + c).style.differs = true;
    }
  }
}

void Viewer::draw_rows(Canvas& canvas) {
  if (list_.empty()) {
    canvas.put(3, 2, "No signals. Press a to add some, ? for all keys.", {});
    return;
  }
  std::size_t line = 2;
  for (std::size_t i = top_; i < list_.size() && line < rows_ - 2; ++i) {
    draw_line(canvas, line++, list_[i], false, i == chosen_);
    if (lines_of(list_[i]) == 2 && line < rows_ - 2)
      draw_line(canvas, line++, list_[i], true, i == chosen_);
  }
}

void Viewer::draw_cursors(Canvas& canvas) {
  const Scale now = scale();
  const std::size_t left = names_ + values_ + 2;
  const auto mark = [&](std::uint64_t time, bool second) {
    if (time < now.from() || time > now.to()) return;
    const std::size_t column = left + now.column(time);
    for (std::size_t row = 1; row < rows_ - 2; ++row) {
      Style& style = canvas.at(row, column).style;
      (second ? style.second : style.cursor) = true;
    }
  };
  if (second_) mark(*second_, true);
  mark(cursor_, false);
}

void Viewer::draw_status(Canvas& canvas, std::size_t row) {
  const Style style{Ink::kStatus};
  canvas.fill(row, 0, columns_, style);
  std::string text = fmt::format(" A {}", when(cursor_));
  if (second_) {
    const bool behind = cursor_ >= *second_;
    const std::uint64_t apart = behind ? cursor_ - *second_ : *second_ - cursor_;
    text += fmt::format("   B {}   A-B {}{}", when(*second_), behind || apart == 0 ? "" : "-",
                        times_.text(apart));
    if (cycles_known_) {
      const auto a = times_.cycle(cursor_), b = times_.cycle(*second_);
      if (a && b)
        text += fmt::format(" {}{} cycle{}", *a < *b ? "-" : "", *a < *b ? *b - *a : *a - *b,
                            *a == *b + 1 || *b == *a + 1 ? "" : "s");
    }
  }
  const std::string right =
      list_.empty() ? "" : fmt::format("signal {} of {} ", chosen_ + 1, list_.size());
  if (columns_of(text) + columns_of(right) + 2 <= columns_)
    canvas.put(row, columns_ - columns_of(right), right, style);
  canvas.put(row, 0, cut_end(text, columns_, glyphs(ascii_).cut), style);
}

void Viewer::draw_message(Canvas& canvas, std::size_t row) {
  std::string text = message_;
  Style style{is_error_ ? Ink::kError : Ink::kPlain};
  if (search_) {
    text = fmt::format("searching {} at {} (escape stops it)", printable_name(searched_),
                       times_.text(progress_));
    style.ink = Ink::kPlain;
  } else if (text.empty()) {
    text = "? keys  q quit  + - zoom  w b changes  m mark  a signals  / name  f expression";
    if (other_trace_ != nullptr) text = "d difference  " + text;
    style.ink = Ink::kFaint;
  }
  canvas.put(row, 1, cut_end(text, columns_ - 1, glyphs(ascii_).cut), style);
}

void Viewer::draw_prompt(Canvas& canvas, std::size_t row) {
  std::string before;
  switch (ask_) {
    case Ask::kTime:
      before = "go to: ";
      break;
    case Ask::kName:
      before = "signal: ";
      break;
    case Ask::kExpression:
      before = "find: ";
      break;
    case Ask::kForm:
      before = "form: ";
      break;
    case Ask::kKind:
      before = "kind of transactions: ";
      break;
    case Ask::kList:
      before = "signals: ";
      break;
    case Ask::kNothing:
      return;
  }
  const std::size_t begin = 1 + canvas.put(row, 1, before, {Ink::kHeading});
  const std::string shown =
      cut_begin(printable_name(utf8(typed_)), columns_ - begin - 1, glyphs(ascii_).cut);
  canvas.caret_row = row;
  canvas.caret_column = begin + canvas.put(row, begin, shown, {});
}

void Viewer::draw_list(Canvas& canvas) {
  const std::size_t room = rows_ - 5;
  canvas.put(1, 1,
             cut_end(fmt::format("{} of {} signals.  enter: add or remove  tab: add all  delete: "
                                 "remove all  escape: back",
                                 listed_.size(), trace_.signals().size()),
                     columns_ - 1, glyphs(ascii_).cut),
             {Ink::kFaint});
  std::vector<std::string_view> here;
  for (const Row& r : list_) here.push_back(r.wave.view().signal.name);
  std::sort(here.begin(), here.end());
  const std::size_t top = list_at_ < room ? 0 : list_at_ - room + 1;
  for (std::size_t i = top; i < std::min(listed_.size(), top + room); ++i) {
    const Signal& s = trace_.signals()[listed_[i]];
    const bool shown = std::binary_search(here.begin(), here.end(), s.name);
    Style style{shown ? Ink::kHeading : Ink::kName};
    style.chosen = i == list_at_;
    const std::string range = s.ranged ? fmt::format(" [{}:{}]", s.left, s.right) : "";
    const std::size_t line = 2 + i - top;
    if (style.chosen) canvas.fill(line, 0, columns_, style);
    canvas.put(line, 1, shown ? "*" : " ", style);
    canvas.put(line, 3,
               cut_begin(printable_name(s.name) + range, columns_ - 14, glyphs(ascii_).cut), style);
    canvas.put(line, columns_ - 10, s.kind, style, 9);
  }
  // A message replaces part of this screen.
  if (!message_.empty())
    canvas.put(rows_ - 3, 1, cut_end(message_, columns_ - 1, glyphs(ascii_).cut),
               {is_error_ ? Ink::kError : Ink::kPlain});
}

void Viewer::draw_help(Canvas& canvas) {
  const std::size_t room = rows_ - 3;
  const std::size_t last = kHelp.size() > room ? kHelp.size() - room : 0;
  help_top_ = std::min(help_top_, last);
  const std::size_t keys = std::min<std::size_t>(26, columns_ / 3);
  for (std::size_t i = 0; i < room && help_top_ + i < kHelp.size(); ++i) {
    const auto& [name, what] = kHelp[help_top_ + i];
    const bool heading = *name == 0 && *what >= 'A' && *what <= 'Z';
    canvas.put(1 + i, 1, cut_end(name, keys - 2, glyphs(ascii_).cut), {Ink::kHeading});
    canvas.put(1 + i, heading ? 1 : keys, cut_end(what, columns_ - keys - 1, glyphs(ascii_).cut),
               {heading ? Ink::kHeading : Ink::kPlain});
  }
  canvas.put(rows_ - 1, 1,
             cut_end(last > help_top_ ? "j k, space: more   any other key: back" : "any key: back",
                     columns_ - 1, glyphs(ascii_).cut),
             {Ink::kFaint});
}

}  // namespace cde::wave::tui
