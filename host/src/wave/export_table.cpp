// SPDX-License-Identifier: Apache-2.0
// Writes waves as CSV and as WaveDrom.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "cde/support/error.hpp"
#include "cde/support/json_text.hpp"
#include "cde/support/message.hpp"
#include "cde/support/output_file.hpp"
#include "cde/wave/changes.hpp"
#include "cde/wave/export.hpp"
#include "cde/wave/export_names.hpp"
#include "cde/wave/four_state.hpp"
#include "cde/wave/request.hpp"

namespace cde::wave {
namespace {

using Json = nlohmann::ordered_json;

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + "\"";
}

/// Tracks the values of views as their changes arrive.
class Values {
 public:
  Values(Trace& trace, std::vector<View> views)
      : views_(std::move(views)),
        texts_(views_.size()),
        bits_(views_.size()),
        whole_(views_.size()),
        is_stale_(views_.size(), 0),
        of_(trace.handles() + std::size_t{1}) {
    for (std::size_t i = 0; i < views_.size(); ++i) of_[views_[i].signal.handle].push_back(i);
  }
  /// Whether a view changes. An event counts as changed until it is over.
  bool set(std::uint32_t handle, std::string_view value) {
    bool changed = false;
    for (const std::size_t i : of_[handle]) {
      const std::string_view bits = views_[i].bits(value);
      if (views_[i].signal.event && bits == "1") triggered_.push_back(i);
      if (bits == bits_[i]) continue;
      bits_[i] = bits;
      whole_[i] = value;
      if (is_stale_[i] == 0) stale_.push_back(i);
      is_stale_[i] = 1;
      changed = true;
    }
    return changed;
  }
  /// Views with a new value since the last call. Texts are made only now, because signals may
  /// change often in between.
  const std::vector<std::size_t>& refresh() {
    fresh_.swap(stale_);
    stale_.clear();
    for (const std::size_t i : fresh_) {
      is_stale_[i] = 0;
      texts_[i] = views_[i].text(whole_[i]);
      if (views_[i].signal.text) texts_[i] = printable(texts_[i]);
    }
    return fresh_;
  }
  /// Sets all events to 0.
  void end_events() {
    for (const std::size_t i : std::exchange(triggered_, {}))
      (void)set(views_[i].signal.handle, "0");
  }
  [[nodiscard]] const std::vector<View>& views() const { return views_; }
  [[nodiscard]] const std::string& bits(std::size_t i) const { return bits_[i]; }
  [[nodiscard]] const std::string& text(std::size_t i) const { return texts_[i]; }

 private:
  std::vector<View> views_;
  std::vector<std::string> texts_, bits_, whole_;
  std::vector<std::size_t> stale_, fresh_, triggered_;
  std::vector<char> is_stale_;
  std::vector<std::vector<std::size_t>> of_;
};

/// Writes rows of CSV as they arrive.
class Rows {
 public:
  Rows(OutputFile& file, const Trace& trace, Times& times, Values& values, std::uint64_t most)
      : file_(file),
        trace_(trace),
        times_(times),
        values_(values),
        most_(most),
        cycles_(times.clock_if_any() != nullptr),
        fields_(values.views().size()) {
    std::string line = cycles_ ? "time,cycle" : "time";
    for (const View& v : values.views())
      line += fmt::format(",{}", csv_field(printable_name(v.label)));
    put(line);
  }
  void row(std::uint64_t time) {
    for (const std::size_t i : values_.refresh()) fields_[i] = ',' + csv_field(values_.text(i));
    std::string line = fmt::to_string(times_.number(time));
    if (cycles_) {
      const auto cycle = times_.cycle(time);
      line += cycle ? fmt::format(",{}", *cycle) : ",";
    }
    for (const std::string& field : fields_) line += field;
    put(line);
    values_.end_events();
  }
  void flush() {
    if ((bytes_ += text_.size()) > most_)
      throw Error(
          ErrorCode::kUsage,
          fmt::format("{}: a CSV table of the whole file takes more than {} MB; name signals "
                      "('*' for all of them), or select a window with --from, --to or "
                      "--around",
                      printable_name(trace_.file().string()), most_ >> 20));
    file_.write(text_);
    text_.clear();
  }

 private:
  void put(const std::string& line) {
    text_.append(line).append("\n");
    if (text_.size() > 1u << 20) flush();
  }
  OutputFile& file_;
  const Trace& trace_;
  Times& times_;
  Values& values_;
  std::uint64_t most_, bytes_ = 0;
  bool cycles_;
  std::vector<std::string> fields_;  ///< each with its comma
  std::string text_;
};

}  // namespace

std::uint64_t most_csv_bytes(const Trace& trace) {
  return (std::uint64_t{256} << 20) + 64 * trace.structure().bytes;
}

void write_csv(Trace& trace, Times& times, std::span<const View> views,
               const std::optional<Event>& on, std::uint64_t from, std::uint64_t to,
               const std::filesystem::path& path, std::uint64_t most) {
  Values values(trace, views_or_all(trace, views));
  if (times.clock_if_any() != nullptr)
    (void)times.edges();  // before the stream, since this is another stream
  OutputFile file(path);
  Rows rows(file, trace, times, values, most);
  std::vector<std::uint32_t> wanted = handles(values.views());
  if (on) wanted.push_back(on->handle);
  std::vector<std::pair<std::uint32_t, std::string>> waiting;
  std::uint64_t now = from;
  char clock = 'x';
  const auto step = [&] {
    bool edge = false, changed = now == from;
    if (on) {
      char before = clock;
      for (const auto& [handle, value] : waiting)
        if (handle == on->handle) {
          edge = edge || (now != from && on->happens(before, value[0]));
          before = value[0];
        }
      clock = before;
      if (edge) rows.row(now);  // values just before the edge
    }
    for (const auto& [handle, value] : waiting) changed = values.set(handle, value) || changed;
    if (!on && changed) rows.row(now);
    waiting.clear();
  };
  const Trace::Visit visit = [&](std::uint64_t time, std::uint32_t handle, std::string_view value) {
    if (time != now) {
      step();
      now = time;
    }
    waiting.emplace_back(handle, value);
    return true;
  };
  // A clock's edge counts even if it vanishes within its instant: flip-flops see it.
  if (on)
    trace.stream(wanted, from, to, visit);
  else
    stream_changes(trace, wanted, from, to, visit);
  step();
  rows.flush();
  file.commit();
}

namespace {

constexpr std::size_t kMostColumns = 5000, kMostCells = 100'000'000;

/// The times at which the columns of a WaveDrom picture begin.
std::vector<std::uint64_t> columns_of(Trace& trace, Times& times, const std::vector<View>& views,
                                      std::uint64_t from, std::uint64_t to) {
  std::vector<std::uint64_t> begins = {from};
  const auto add = [&](std::uint64_t time) {
    if (time > begins.back()) begins.push_back(time);
    if (begins.size() > kMostColumns)
      throw Error(ErrorCode::kUsage,
                  fmt::format("a picture of WaveDrom would have more than {} columns; select a "
                              "window with --from, --to or --around",
                              kMostColumns));
  };
  if (times.clock_if_any() != nullptr && !times.edges().empty()) {
    const auto& edges = times.edges();
    // A cycle that begins at the window's end is not in it, unless the file ends there.
    for (auto e = std::upper_bound(edges.begin(), edges.end(), from);
         e != edges.end() && (*e < to || (*e == to && to == trace.end())); ++e)
      add(*e);
    return begins;
  }
  stream_changes(trace, handles(views), from, to, [&](std::uint64_t time, auto, std::string_view) {
    add(time);
    return true;
  });
  return begins;
}

/// A signal in WaveDrom: one character per column, and the texts of buses.
struct Drawn {
  std::string wave, last;
  Json data = Json::array();
};

/// Adds a column's value, or a repetition mark if it equals the last one.
void draw(Drawn& d, const View& v, std::size_t column, const std::string& bits,
          const std::string& text) {
  const bool one = v.width == 1 && !v.signal.real && !v.signal.text;
  const std::string& now = one ? bits : text;
  if (!d.wave.empty() && now == d.last) return;
  d.wave.resize(column, '.');
  d.last = now;
  if (v.signal.event) {
    d.wave += bits == "1" ? 'P' : '0';  // an edge with an arrow
  } else if (one) {
    d.wave += bits.empty() ? 'x' : four_state(bits[0]);
  } else if (bits.find_first_not_of("xX") == std::string::npos) {
    d.wave += 'x';
  } else if (bits.find_first_not_of("zZ") == std::string::npos) {
    d.wave += 'z';
  } else {
    d.wave += '=';
    d.data.push_back(text);
  }
}

/// The signals of a scope, as a list with the scope's name.
std::string wavedrom_text(const std::vector<View>& views, const std::vector<Drawn>& drawn,
                          const Json& head) {
  const auto scope = [&](const View& v) { return v.label.substr(0, v.signal.name.rfind('.') + 1); };
  bool several = false;
  for (const View& v : views) several = several || scope(v) != scope(views.front());
  std::string text = "{ \"signal\": [\n";
  for (std::size_t i = 0; i < views.size();) {
    const std::string own = scope(views[i]);
    const bool group = several && !own.empty();
    if (group) text += "  [" + json_text(Json(own.substr(0, own.size() - 1)), -1) + ",\n";
    std::size_t stop = i;
    while (stop < views.size() && scope(views[stop]) == own) ++stop;
    for (; i < stop; ++i) {
      Json s = {{"name", views[i].label.substr(own.size())}, {"wave", drawn[i].wave}};
      if (!drawn[i].data.empty()) s["data"] = drawn[i].data;
      text +=
          fmt::format("{}  {}{}\n", group ? "  " : "", json_text(s, -1), i + 1 < stop ? "," : "");
    }
    if (group) text += "  ]";
    if (group && i < views.size()) text += ",";
    if (group) text += "\n";
    if (!group && i < views.size()) text.replace(text.size() - 1, 1, ",\n");
  }
  return text + "],\n  \"head\": " + json_text(head, -1) + " }\n";
}

}  // namespace

void write_wavedrom(Trace& trace, Times& times, std::span<const View> views, std::uint64_t from,
                    std::uint64_t to, const std::filesystem::path& path) {
  Values values(trace, views_or_all(trace, views));
  const std::vector<View>& all = values.views();
  const std::vector<std::uint64_t> begins = columns_of(trace, times, all, from, to);
  if (begins.size() * all.size() > kMostCells)
    throw Error(ErrorCode::kUsage,
                fmt::format("a picture of WaveDrom would have {} columns of {} signals; name fewer "
                            "signals, or select a window with --from, --to or --around",
                            begins.size(), all.size()));
  const Signal* const clock = times.clock_if_any();
  std::vector<Drawn> drawn(all.size());
  std::size_t column = 0;
  std::vector<std::size_t> clocks;
  for (std::size_t i = 0; clock != nullptr && i < all.size(); ++i)
    if (all[i].signal.handle == clock->handle) clocks.push_back(i);
  const auto finish_column = [&] {
    // The first column may begin between two edges.
    const bool edge = clock != nullptr && std::binary_search(times.edges().begin(),
                                                             times.edges().end(), begins[column]);
    for (const std::size_t i : values.refresh())
      if (!edge || all[i].signal.handle != clock->handle)
        draw(drawn[i], all[i], column, values.bits(i), values.text(i));
    for (const std::size_t i : edge ? clocks : std::vector<std::size_t>{}) {
      const bool goes_on = drawn[i].wave.find('p') != std::string::npos;
      drawn[i].wave.resize(column, '.');
      drawn[i].wave += goes_on ? '.' : 'p';
    }
    values.end_events();
    ++column;
  };
  const bool next = clock != nullptr && to > begins.back() &&
                    std::binary_search(times.edges().begin(), times.edges().end(), to);
  trace.stream(handles(all), from, next ? to - 1 : to,
               [&](std::uint64_t time, std::uint32_t handle, std::string_view value) {
                 while (column + 1 < begins.size() && time >= begins[column + 1]) finish_column();
                 (void)values.set(handle, value);
                 return true;
               });
  while (column < begins.size()) finish_column();
  for (Drawn& d : drawn) d.wave.resize(column, '.');
  Json head = {{"text", fmt::format("{}, {} to {}", trace.file().filename().string(),
                                    times.text(from), times.text(to))}};
  if (clock != nullptr && !times.edges().empty())
    head["tick"] = times.cycle(begins.front()) ? Json(*times.cycle(begins.front())) : Json(-1);
  write_file(path, wavedrom_text(all, drawn, head));
}

}  // namespace cde::wave
