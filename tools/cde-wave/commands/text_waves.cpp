// SPDX-License-Identifier: Apache-2.0
// cde wave show: draws waves with characters.
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdlib>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/wave/blackouts.hpp"
#include "cde/wave/changes.hpp"
#include "cde/wave/four_state.hpp"
#include "commands/commands.hpp"
#include "output/streams.hpp"

namespace cde::wave {
namespace {

using Json = nlohmann::ordered_json;

struct Glyphs {
  const char *across, *rise_top, *rise_low, *fall_top, *fall_low, *change, *busy, *unknown, *cut,
      *event;
};
constexpr Glyphs kUnicode = {"─", "┌", "┘", "┐", "└", "╳", "▒", "░", "…", "↑"};
constexpr Glyphs kAscii = {"_", " ", "/", " ", "\\", "|", "#", "?", "~", "^"};

/// The activity of a signal in a column.
struct Cell {
  std::string value;     ///< value at the end of the column
  unsigned changes = 0;  ///< changes in the column
};
using Row = std::vector<Cell>;

/// The number of characters in a UTF-8 text.
std::size_t length(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xc0u) != 0x80u;
  }));
}

/// The two text lines of a one-bit signal.
std::pair<std::string, std::string> bit_lines(const Row& row, const Glyphs& g, bool ascii) {
  std::string top, low;
  char before = 'x';
  for (std::size_t c = 0; c < row.size(); ++c) {
    const char now = row[c].value.empty() ? 'x' : four_state(row[c].value[0]);
    const bool edge = c != 0 && row[c].changes != 0 && now != before;
    if (row[c].changes > 1) {
      top += ascii ? " " : g.busy;
      low += g.busy;
    } else if (now != '0' && now != '1') {
      top += ascii ? " " : g.unknown;
      low += now == 'z' ? "z" : g.unknown;
    } else if (edge && now == '1') {
      top += g.rise_top;
      low += before == '0' ? g.rise_low : " ";
    } else if (edge) {
      top += before == '1' ? g.fall_top : " ";
      low += g.fall_low;
    } else {
      top += now == '1' ? g.across : " ";
      low += now == '1' ? " " : g.across;
    }
    before = now;
  }
  return {top, low};
}

/// The line of an event signal, with a mark at each event.
std::string event_line(const Row& row, const Glyphs& g) {
  std::string text;
  for (const Cell& cell : row)
    text += cell.changes == 0 ? " " : cell.changes == 1 ? g.event : g.busy;
  return text;
}

/// The line of a bus: a mark at each change, followed by as much of the value as fits.
std::string bus_line(const Row& row, const Glyphs& g) {
  std::string text;
  for (std::size_t c = 0; c < row.size();) {
    std::size_t stop = c + 1;
    while (stop < row.size() && row[stop].changes == 0) ++stop;
    if (row[c].changes > 1) {
      text += g.busy;
    } else if (c != 0 || row[c].changes != 0) {
      text += g.change;
    } else {
      text += " ";
    }
    const std::size_t room = stop - c - 1;
    const std::string value = printable_name(row[c].value);
    if (length(value) <= room) {
      text += value + std::string(room - length(value), ' ');
    } else if (room > 0) {
      // Cuts at a character, because a value may be any text.
      std::size_t bytes = 0;
      for (std::size_t n = 0; bytes < value.size(); ++bytes)
        if ((static_cast<unsigned char>(value[bytes]) & 0xc0u) != 0x80u && n++ == room - 1) break;
      text += value.substr(0, bytes) + g.cut;
    }
    c = stop;
  }
  return text;
}

std::size_t terminal_columns(const Request& r) {
  if (r.columns != 0) return r.columns;
  winsize size{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col >= 40) return size.ws_col;
  if (const char* text = std::getenv("COLUMNS"))  // NOLINT(concurrency-mt-unsafe)
    if (const auto n = std::strtoul(text, nullptr, 10); n >= 40 && n <= 10000) return n;
  return 100;
}

/// The ruler above the waves: ticks with times at regular columns.
std::string ruler(const Times& times, const Window& w, std::uint64_t span, std::size_t columns,
                  bool ascii) {
  std::string text;
  std::size_t used = 0;
  for (std::size_t c = 0; c < columns; ++c) {
    if (c % 20 != 0 || c < used) continue;
    const std::string tick = (ascii ? "|" : "╷") + times.text(w.from + c * span / columns);
    if (c + length(tick) > columns) break;
    text += std::string(c - used, ' ') + tick;
    used = c + length(tick);
  }
  return text;
}

struct Picture {
  std::vector<Row> rows;
  std::uint64_t span;  ///< time drawn over all columns
};

Picture sample(Trace& trace, const std::vector<View>& all, const Window& w, std::size_t columns) {
  Picture p{std::vector<Row>(all.size(), Row(columns)), w.to - w.from + 1};
  std::vector<std::vector<std::size_t>> of(trace.handles() + std::size_t{1});
  for (std::size_t i = 0; i < all.size(); ++i) of[all[i].signal.handle].push_back(i);
  std::vector<std::string> last(all.size());
  std::vector<std::size_t> at(all.size(), 0);
  const auto fill = [&](std::size_t i, std::size_t column) {
    for (std::size_t c = at[i] + 1; c <= column; ++c) p.rows[i][c].value = p.rows[i][c - 1].value;
    at[i] = std::max(at[i], column);
  };
  stream_changes(trace, handles(all), w.from, w.to,
                 [&](std::uint64_t time, std::uint32_t handle, std::string_view value) {
                   const auto column = static_cast<std::size_t>(
                       static_cast<long double>(time - w.from) * columns / p.span);
                   for (const std::size_t i : of[handle]) {
                     const std::string_view bits = all[i].bits(value);
                     const bool begins = time == w.from;
                     const bool event = all[i].signal.event;
                     if (event ? bits != "1" : !begins && bits == last[i]) continue;
                     fill(i, std::min(column, columns - 1));
                     Cell& cell = p.rows[i][at[i]];
                     if (!begins || event) ++cell.changes;
                     last[i] = bits;
                     // Texts are made once per column: only its last change is visible.
                     cell.value = bits;
                   }
                   return true;
                 });
  for (std::size_t i = 0; i < all.size(); ++i) {
    fill(i, columns - 1);
    if (all[i].width == 1 && !all[i].signal.text) continue;
    std::string bits, text;
    for (Cell& cell : p.rows[i]) {
      if (cell.value != bits || text.empty()) {
        bits = cell.value;
        View whole = all[i];
        whole.signal.width = 0;  // the view's bits are already extracted
        text = whole.text(bits);
      }
      cell.value = text;
    }
  }
  return p;
}

/// Length of the common scope, which labels leave out.
std::size_t common_scope(const std::vector<View>& all) {
  std::string_view common = all.front().label;
  common = common.substr(0, common.rfind('.') + 1);
  for (const View& v : all)
    while (!std::string_view(v.label).starts_with(common)) {
      common.remove_suffix(1);
      common = common.substr(0, common.rfind('.') + 1);
    }
  return common.size();
}

/// The signals shown by default: the ports of the outermost scope with ports, else the signals of
/// the outermost scope.
std::vector<View> outermost(const Request& r, Trace& trace) {
  std::vector<View> all;
  const FileForms forms(trace);
  const auto depth = [](const Signal& s) { return std::count(s.name.begin(), s.name.end(), '.'); };
  for (const bool ports : {true, false}) {
    std::ptrdiff_t least = PTRDIFF_MAX;
    for (const Signal& s : trace.signals())
      if (!ports || *s.direction != 0) least = std::min(least, depth(s));
    for (const Signal& s : trace.signals()) {
      if (depth(s) != least || (ports && *s.direction == 0)) continue;
      View& v = all.emplace_back();
      v.signal = s;
      v.label = s.name;
      v.width = s.width;
      v.form = forms.of(s, r.default_form());
    }
    if (!all.empty()) break;
  }
  return all;
}

void show_json(const Request& r, Trace& trace, const Times& times, const Window& w,
               const std::vector<View>& all) {
  std::vector<Json> changes(all.size(), Json::array());
  std::vector<std::string> last(all.size());
  Lines lines(r.max);
  stream_changes(trace, handles(all), w.from, w.to,
                 [&](std::uint64_t time, std::uint32_t handle, std::string_view value) {
                   for (std::size_t i = 0; i < all.size(); ++i) {
                     if (all[i].signal.handle != handle) continue;
                     std::string text = all[i].text(value);
                     if (all[i].signal.event ? text != "1" : time != w.from && text == last[i])
                       continue;
                     if (lines.next())
                       changes[i].push_back({{"time", times.number(time)}, {"value", text}});
                     last[i] = std::move(text);
                   }
                   return true;
                 });
  Json signals = Json::array();
  for (std::size_t i = 0; i < all.size(); ++i)
    signals.push_back({{"name", all[i].label}, {"changes", changes[i]}});
  Json j = begin_json(r);
  Json dark = Json::array();
  for (const Blackout& b : blackouts_in(trace, w.from, w.to))
    dark.push_back({{"from", times.number(b.from)}, {"to", times.number(b.to)}});
  j.update({{"from", times.number(w.from)},
            {"to", times.number(w.to)},
            {"blackouts", dark},
            {"signals", signals},
            {"more", lines.more()}});
  cli::print_json(j);
}

}  // namespace

int show(const Request& r) {
  Trace trace(r.file);
  Times times(trace, r.clock);
  warn_if_cut(trace, times);
  std::vector<View> all = r.words.empty() ? outermost(r, trace) : views(r, trace, 0);
  const Window w = window(r, trace, times);
  if (r.json) {
    show_json(r, trace, times, w, all);
    return 0;
  }
  Lines lines(r.max);
  std::size_t drawn = 0;
  while (drawn < all.size() && lines.next()) ++drawn;
  for (std::size_t i = drawn + 1; i < all.size(); ++i) (void)lines.next();
  all.resize(drawn);
  const std::size_t total = terminal_columns(r), scope = common_scope(all);
  std::size_t names = 4;
  for (const View& v : all) names = std::max(names, length(v.label.substr(scope)));
  names = std::min(names, total / 3);
  const std::size_t columns = total - names - 1;
  const Picture p = sample(trace, all, w, columns);
  const Glyphs& g = r.ascii ? kAscii : kUnicode;
  const auto label = [&](std::string text) {
    text = printable_name(text);
    if (text.size() > names) text = g.cut + text.substr(text.size() - names + 1);
    return text + std::string(names - std::min(names, length(text)), ' ') + " ";
  };
  std::string text =
      fmt::format("{}{} to {}\n",
                  scope == 0 ? "" : printable_name(all.front().label.substr(0, scope - 1)) + "  ",
                  times.text(w.from), times.text(w.to));
  for (const Blackout& b : blackouts_in(trace, w.from, w.to))
    text += fmt::format("no dump from {} to {} ($dumpoff)\n", times.text(b.from), times.text(b.to));
  text += label("") + ruler(times, w, p.span, columns, r.ascii) + "\n";
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string name = all[i].label.substr(scope);
    if (all[i].signal.event) {
      text += label(name) + event_line(p.rows[i], g) + "\n";
    } else if (all[i].width == 1 && !all[i].signal.text) {
      const auto [top, low] = bit_lines(p.rows[i], g, r.ascii);
      // In ASCII the high level is the upper line, drawn with the same character.
      text += fmt::format("{}{}\n{}{}\n", label(""), top, label(name), low);
    } else {
      text += label(name) + bus_line(p.rows[i], g) + "\n";
    }
  }
  cli::print(without_spaces(text + lines.rest()));
  return 0;
}

}  // namespace cde::wave
