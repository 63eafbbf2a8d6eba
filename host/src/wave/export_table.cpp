// SPDX-License-Identifier: Apache-2.0
// Waves as CSV and WaveDrom.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "cde/support/error.hpp"
#include "cde/support/json_text.hpp"
#include "cde/support/message.hpp"
#include "cde/support/output_file.hpp"
#include "cde/wave/export.hpp"
#include "cde/wave/export_names.hpp"
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

/// The values of views while their changes come by.
class Values {
 public:
  Values(Trace& trace, std::vector<View> views)
      : views_(std::move(views)),
        texts_(views_.size()),
        bits_(views_.size()),
        of_(trace.handles() + std::size_t{1}) {
    for (std::size_t i = 0; i < views_.size(); ++i) of_[views_[i].signal.handle].push_back(i);
  }
  /// Whether something of it changes.
  bool set(std::uint32_t handle, std::string_view value) {
    bool changed = false;
    for (const std::size_t i : of_[handle]) {
      const std::string_view bits = views_[i].bits(value);
      if (bits == bits_[i]) continue;
      bits_[i] = bits;
      stale_.insert(i);
      whole_[i] = value;
      changed = true;
    }
    return changed;
  }
  /// Texts are made when they are wanted: a signal may change often in between.
  const std::vector<std::string>& texts() {
    for (const std::size_t i : stale_) {
      texts_[i] = views_[i].text(whole_[i]);
      if (views_[i].signal.text) texts_[i] = printable(texts_[i]);
    }
    stale_.clear();
    return texts_;
  }
  [[nodiscard]] const std::vector<View>& views() const { return views_; }
  [[nodiscard]] const std::string& bits(std::size_t i) const { return bits_[i]; }

 private:
  std::vector<View> views_;
  std::vector<std::string> texts_, bits_;
  std::map<std::size_t, std::string> whole_;
  std::set<std::size_t> stale_;
  std::vector<std::vector<std::size_t>> of_;
};

/// Rows of CSV, written as they come.
class Rows {
 public:
  Rows(OutputFile& file, Times& times)
      : file_(file), times_(times), cycles_(times.clock_if_any() != nullptr) {}
  void head(const std::vector<View>& views) {
    std::string line = cycles_ ? "time,cycle" : "time";
    for (const View& v : views) line += fmt::format(",{}", csv_field(printable_name(v.label)));
    put(line);
  }
  void row(std::uint64_t time, const std::vector<std::string>& texts) {
    std::string line = fmt::to_string(times_.number(time));
    if (cycles_) {
      const auto cycle = times_.cycle(time);
      line += cycle ? fmt::format(",{}", *cycle) : ",";
    }
    for (const std::string& text : texts) line += fmt::format(",{}", csv_field(text));
    put(line);
  }
  void flush() {
    file_.write(text_);
    text_.clear();
  }

 private:
  void put(const std::string& line) {
    text_.append(line).append("\n");
    if (text_.size() > 1u << 20) flush();
  }
  OutputFile& file_;
  Times& times_;
  bool cycles_;
  std::string text_;
};

}  // namespace

void write_csv(Trace& trace, Times& times, std::span<const View> views,
               const std::optional<Event>& on, std::uint64_t from, std::uint64_t to,
               const std::filesystem::path& path) {
  Values values(trace, views_or_all(trace, views));
  if (times.clock_if_any() != nullptr) (void)times.edges();  // before the stream: it is another one
  OutputFile file(path);
  Rows rows(file, times);
  rows.head(values.views());
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
      if (edge) rows.row(now, values.texts());  // what was there just before the edge
    }
    for (const auto& [handle, value] : waiting) changed = values.set(handle, value) || changed;
    if (!on && changed) rows.row(now, values.texts());
    waiting.clear();
  };
  trace.stream(wanted, from, to,
               [&](std::uint64_t time, std::uint32_t handle, std::string_view value) {
                 if (time != now) {
                   step();
                   now = time;
                 }
                 waiting.emplace_back(handle, value);
                 return true;
               });
  step();
  rows.flush();
  file.commit();
}

namespace {

constexpr std::size_t kMostColumns = 5000;

/// When the columns of a WaveDrom picture begin.
std::vector<std::uint64_t> columns_of(Trace& trace, Times& times, const std::vector<View>& views,
                                      std::uint64_t from, std::uint64_t to) {
  std::vector<std::uint64_t> begins = {from};
  const auto add = [&](std::uint64_t time) {
    if (time > begins.back()) begins.push_back(time);
    if (begins.size() > kMostColumns)
      throw Error(ErrorCode::kUsage,
                  fmt::format("a picture of WaveDrom would have more than {} columns; --from, --to "
                              "or --around take a window",
                              kMostColumns));
  };
  if (times.clock_if_any() != nullptr && !times.edges().empty()) {
    const auto& edges = times.edges();
    // A cycle that would begin where the window ends is not in it, if the file goes on.
    for (auto e = std::upper_bound(edges.begin(), edges.end(), from);
         e != edges.end() && (*e < to || (*e == to && to == trace.end())); ++e)
      add(*e);
    return begins;
  }
  trace.stream(handles(views), from, to, [&](std::uint64_t time, auto, std::string_view) {
    add(time);
    return true;
  });
  return begins;
}

/// A signal as WaveDrom writes it: one character per column, and texts of buses.
struct Drawn {
  std::string wave, last;
  Json data = Json::array();
};

void draw(Drawn& d, const View& v, const std::string& bits, const std::string& text) {
  const bool one = v.width == 1 && !v.signal.real && !v.signal.text;
  const std::string& now = one ? bits : text;
  if (!d.wave.empty() && now == d.last) {
    d.wave += '.';
    return;
  }
  d.last = now;
  if (one) {
    d.wave += bits.empty() ? 'x' : bits[0];
  } else if (bits.find_first_not_of("xX") == std::string::npos) {
    d.wave += 'x';
  } else if (bits.find_first_not_of("zZ") == std::string::npos) {
    d.wave += 'z';
  } else {
    d.wave += '=';
    d.data.push_back(text);
  }
}

/// Signals of a scope in a list with its name.
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
  const Signal* const clock = times.clock_if_any();
  std::vector<Drawn> drawn(all.size());
  std::size_t column = 0;
  const auto finish_column = [&] {
    // The first column may begin between two edges.
    const bool edge = clock != nullptr && std::binary_search(times.edges().begin(),
                                                             times.edges().end(), begins[column]);
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (edge && all[i].signal.handle == clock->handle)
        drawn[i].wave += drawn[i].wave.ends_with('p') || drawn[i].wave.ends_with('.') ? '.' : 'p';
      else
        draw(drawn[i], all[i], values.bits(i), values.texts()[i]);
    }
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
  Json head = {{"text", fmt::format("{}, {} to {}", trace.file().filename().string(),
                                    times.text(from), times.text(to))}};
  if (clock != nullptr && !times.edges().empty())
    head["tick"] = times.cycle(begins.front()) ? Json(*times.cycle(begins.front())) : Json(-1);
  write_file(path, wavedrom_text(all, drawn, head));
}

}  // namespace cde::wave
