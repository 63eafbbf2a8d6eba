// SPDX-License-Identifier: Apache-2.0
// cde wave find: where an expression is true.
#include <fmt/format.h>

#include <algorithm>
#include <deque>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "output/streams.hpp"
#include "wave/expression.hpp"
#include "wave/request.hpp"

namespace cde::wave {
namespace {

using Json = nlohmann::ordered_json;

/// "posedge clk", "negedge clk", "edge clk".
struct Event {
  std::uint32_t handle = 0;
  std::string name;
  bool rising = false, falling = false;

  Event(Trace& trace, const std::string& text) {
    const std::size_t space = text.find(' ');
    const std::string edge = text.substr(0, space);
    rising = edge == "posedge" || edge == "edge";
    falling = edge == "negedge" || edge == "edge";
    if (space == std::string::npos || (!rising && !falling))
      throw Error(ErrorCode::kUsage,
                  fmt::format("--on is {}; it must be 'posedge SIGNAL', 'negedge SIGNAL' or 'edge "
                              "SIGNAL'",
                              in_quotes(text)));
    const Signal& s = find_signal(trace, text.substr(text.find_first_not_of(' ', space)));
    if (s.width != 1)
      throw Error(ErrorCode::kUsage, fmt::format("--on: {} has {} bits; an edge is of one",
                                                 printable_name(s.name), s.width));
    handle = s.handle;
    name = s.name;
  }
  [[nodiscard]] bool happens(char before, char now) const {
    return (rising && before == '0' && now == '1') || (falling && before == '1' && now == '0');
  }
};

struct Match {
  std::uint64_t time;
  std::vector<std::string> values;  ///< of the expression's signals
};

/// Follows the changes and says when the expression is true.
class Search {
 public:
  Search(const Request& r, Trace& trace) : r_(r), what_(trace, r.words.front(), "the expression") {
    if (!r.when.empty()) when_.emplace(trace, r.when, "--when");
    if (!r.on.empty()) on_.emplace(trace, r.on);
    for (const View& v : what_.views()) note(v);
    if (when_)
      for (const View& v : when_->views()) note(v);
    if (on_) handles_.push_back(on_->handle);
    if (handles_.empty())
      throw Error(ErrorCode::kUsage, "the expression has no signal: it is always the same");
    values_.resize(trace.handles() + std::size_t{1});
  }

  void run(Trace& trace, const Window& w) {
    now_ = w.from;
    from_ = w.from;
    bool go_on = true;
    trace.stream(handles_, w.from, w.to,
                 [&](std::uint64_t time, std::uint32_t handle, std::string_view value) {
                   if (time != now_) {
                     go_on = step();
                     if (!go_on) return false;
                     now_ = time;
                   }
                   waiting_.emplace_back(handle, value);
                   return true;
                 });
    if (go_on) (void)step();
  }

  std::uint64_t count = 0;
  std::deque<Match> matches;
  [[nodiscard]] const std::vector<View>& shown() const { return shown_; }

 private:
  void note(const View& v) {
    handles_.push_back(v.signal.handle);
    const bool known = std::any_of(shown_.begin(), shown_.end(),
                                   [&](const View& s) { return s.label == v.label; });
    if (!known) shown_.push_back(v);
  }

  /// All changes of `now_` are there; false: enough was found.
  bool step() {
    const bool begins = now_ == from_;
    bool edge = false;
    if (on_ && !begins) {
      char before = clock_;
      for (const auto& [handle, value] : waiting_)
        if (handle == on_->handle) {
          edge = edge || on_->happens(before, value[0]);
          before = value[0];
        }
    }
    bool found = false;
    if (edge) found = evaluate();  // what was there just before the edge
    for (const auto& [handle, value] : waiting_) {
      values_[handle] = value;
      what_.set(handle, value);
      if (when_) when_->set(handle, value);
      if (on_ && handle == on_->handle) clock_ = value[0];
    }
    // The values are those that decided: before the edge, or after the changes.
    if (on_ && found) return record(found_values_);
    waiting_.clear();
    if (on_) return true;
    const bool now = evaluate();
    const bool begins_to_be =
        now && (!was_ || what_.looks_back() || (when_ && when_->looks_back()));
    was_ = now;
    return begins_to_be ? record(texts()) : true;
  }
  bool evaluate() {
    const bool a = what_.evaluate(), b = when_ ? when_->evaluate() : true;
    if (on_ && a && b) found_values_ = texts();
    return a && b;
  }
  [[nodiscard]] std::vector<std::string> texts() const {
    if (r_.count) return {};
    if (!r_.first && !r_.last && r_.max != 0 && count >= r_.max) return {};
    std::vector<std::string> all;
    for (const View& v : shown_) all.push_back(v.text(values_[v.signal.handle]));
    return all;
  }
  bool record(std::vector<std::string> values) {
    waiting_.clear();
    ++count;
    if (r_.last) matches.clear();
    if (!r_.count && (r_.last || r_.max == 0 || count <= r_.max))
      matches.push_back({now_, std::move(values)});
    return !r_.first;
  }

  const Request& r_;
  Expression what_;
  std::optional<Expression> when_;
  std::optional<Event> on_;
  std::vector<std::uint32_t> handles_;
  std::vector<View> shown_;
  std::vector<std::string> values_, found_values_;
  std::vector<std::pair<std::uint32_t, std::string>> waiting_;
  std::uint64_t now_ = 0, from_ = 0;
  char clock_ = 'x';
  bool was_ = false;
};

}  // namespace

int find(const Request& r) {
  if (r.words.size() != 1)
    throw Error(ErrorCode::kUsage, "cde wave find takes one expression, in quotes");
  if (int{r.first} + int{r.last} + int{r.count} > 1)
    throw Error(ErrorCode::kUsage, "--first, --last and --count exclude each other");
  Trace trace(r.file);
  Times times(trace, r.clock);
  const Window w = window(r, trace, times);
  Search search(r, trace);
  search.run(trace, w);
  const int status = search.count == 0 ? 1 : 0;
  const bool cycles = !r.count && !search.matches.empty() && times.clock_if_any() != nullptr;
  Lines lines(r.first || r.last ? 0 : r.max);
  Json list = Json::array();
  std::string text;
  for (const Match& m : search.matches) {
    Json cycle;
    if (cycles)
      if (const auto number = times.cycle(m.time)) cycle = *number;
    Json values = Json::array();
    std::string shown;
    for (std::size_t i = 0; i < search.shown().size() && i < m.values.size(); ++i) {
      const View& v = search.shown()[i];
      shown += fmt::format("  {}={}", v.label.substr(v.label.rfind('.') + 1), m.values[i]);
      values.push_back({{"name", v.label}, {"value", m.values[i]}});
    }
    if (r.json) {
      list.push_back(
          {{"time", m.time}, {"at", times.text(m.time)}, {"cycle", cycle}, {"values", values}});
    } else {
      text += fmt::format("{}{}{}\n", times.text(m.time),
                          cycle.is_null() ? "" : fmt::format("  cyc:{}", cycle.dump()),
                          printable_name(shown));
    }
  }
  const std::uint64_t more =
      r.count || r.first || r.last ? 0 : search.count - search.matches.size();
  if (r.json) {
    Json j = begin_json(r);
    j.update({{"found", search.count}, {"matches", list}, {"more", more}});
    cli::put_json(j);
    return status;
  }
  if (r.count)
    text = fmt::format("{}\n", search.count);
  else if (search.count == 0)
    cli::say("cde: found nowhere from {} to {}\n", times.text(w.from), times.text(w.to));
  else if (more != 0)
    text += fmt::format("... {} more (--max 0 prints all)\n", more);
  cli::put(text);
  return status;
}

}  // namespace cde::wave
