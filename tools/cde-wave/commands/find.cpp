// SPDX-License-Identifier: Apache-2.0
// cde wave find: finds where an expression is true.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <deque>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/wave/follow.hpp"
#include "commands/commands.hpp"
#include "output/streams.hpp"

namespace cde::wave {
namespace {

using Json = nlohmann::ordered_json;

struct Match {
  std::uint64_t time;
  std::vector<std::string> values;  ///< of the expression's signals
};

/// The places where an expression is true, as far as they are printed, and their number.
class Search {
 public:
  Search(const Request& r, Trace& trace) : r_(r), follow_(trace, r.words.front(), r.when, r.on) {}

  void run(Trace& trace, const Window& w) {
    follow_.run(trace, w.from, w.to, [&](std::uint64_t time) {
      ++count;
      if (r_.last) matches.clear();
      if (!r_.count && (r_.first || r_.last || r_.max == 0 || count <= r_.max))
        matches.push_back({time, follow_.texts()});
      return !r_.first;
    });
  }

  std::uint64_t count = 0;
  std::deque<Match> matches;
  [[nodiscard]] const std::vector<View>& shown() const { return follow_.views(); }

 private:
  const Request& r_;
  Follow follow_;
};

}  // namespace

int find(const Request& r) {
  if (r.words.size() != 1)
    throw Error(ErrorCode::kUsage, "cde wave find takes one expression; put it in quotes");
  Trace trace(r.file);
  Times times(trace, r.clock);
  warn_if_cut(trace, times);
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
      shown += fmt::format("  {}={}", v.short_label(), m.values[i]);
      values.push_back({{"name", v.label}, {"value", m.values[i]}});
    }
    if (r.json) {
      list.push_back({{"time", times.number(m.time)},
                      {"at", times.text(m.time)},
                      {"cycle", cycle},
                      {"values", values}});
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
    cli::print_json(j);
    return status;
  }
  if (r.count)
    text = fmt::format("{}\n", search.count);
  else if (search.count == 0)
    cli::log("cde: found nowhere from {} to {}\n", times.text(w.from), times.text(w.to));
  else if (more != 0)
    text += fmt::format("... {} more (--max 0 prints all)\n", more);
  cli::print(text);
  return status;
}

}  // namespace cde::wave
