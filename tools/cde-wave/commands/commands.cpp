// SPDX-License-Identifier: Apache-2.0
// cde wave info, ls, at, why.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "cde/card/json_keys.hpp"
#include "cde/support/counted.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "commands/commands.hpp"
#include "output/streams.hpp"

namespace cde::wave {

using Json = nlohmann::ordered_json;

int info(const Request& r) {
  if (!r.words.empty())
    throw Error(ErrorCode::kUsage, fmt::format("cde wave info takes only a file; remove {}",
                                               in_quotes(r.words.front())));
  Trace trace(r.file);
  Times times(trace, r.clock);
  const Signal* const clock = times.clock_if_any();
  std::set<std::uint32_t> things;
  for (const Signal& s : trace.signals()) things.insert(s.handle);
  const std::size_t aliases = trace.signals().size() - things.size();
  if (r.json) {
    Json j = begin_json(r);
    Json dark = Json::array();
    for (const Blackout& b : trace.blackouts())
      dark.push_back({{"from", times.number(b.from)}, {"to", times.number(b.to)}});
    j.update({{"file_format", trace.format()},
              {"closed", trace.structure().closed},
              {"ending", trace.ending().empty() ? Json() : Json(trace.ending())},
              {"time_zero", trace.time_zero()},
              {"blackouts", dark},
              {"file_bytes", trace.structure().bytes},
              {"writer", trace.writer()},
              {"date", trace.date()},
              {"seconds_per_unit", std::pow(10.0, trace.scale())},
              {"from", times.number(trace.start())},
              {"to", times.number(trace.end())},
              {"scopes", trace.scopes()},
              {"signals", trace.signals().size()},
              {"aliases", aliases},
              {"blocks", trace.structure().sections.size()},
              {"clock", clock != nullptr ? Json(clock->name) : Json()},
              {"cycles", clock != nullptr ? Json(times.edges().size()) : Json()},
              {"comments", trace.comments()}});
    cli::print_json(j);
    return 0;
  }
  std::string text;
  const auto line = [&](std::string_view key, const std::string& value) {
    text += fmt::format("{:<10} {}\n", key, printable_name(value));
  };
  line("file",
       fmt::format("{}, {}, {}", r.file, trace.format(), counted(trace.structure().bytes, "byte")));
  if (!trace.ending().empty()) line("end", trace.ending());
  line("writer", fmt::format("{}, {}", trace.writer(), trace.date()));
  line("time", fmt::format("{} to {}, in units of 1e{} s", times.text(trace.start()),
                           times.text(trace.end()), trace.scale()));
  if (trace.time_zero() != 0)
    line("time zero", fmt::format("{} units, included in all times", trace.time_zero()));
  for (const Blackout& b : trace.blackouts())
    line("no dump", fmt::format("{} to {} ($dumpoff)", times.text(b.from), times.text(b.to)));
  line("signals", fmt::format("{} in {}, {} of them alias names", trace.signals().size(),
                              counted(trace.scopes(), "scope"), aliases));
  line("blocks", fmt::to_string(trace.structure().sections.size()));
  line("clock", clock == nullptr
                    ? "none found; name it with --clock SIGNAL"
                    : fmt::format("{}, {}", clock->name, counted(times.edges().size(), "cycle")));
  for (const std::string& comment : trace.comments()) line("comment", comment);
  cli::print(text);
  return 0;
}

int list(const Request& r) {
  if (r.words.size() > 1)
    throw Error(ErrorCode::kUsage,
                "cde wave ls takes one pattern; put it in quotes if it has * or ?");
  Trace trace(r.file);
  warn_if_cut(trace, Times(trace, ""));
  Lines lines(r.max);
  Json signals = Json::array();
  fmt::memory_buffer text;
  std::vector<const Signal*> found;
  const std::string pattern = r.words.empty() ? "*" : r.words.front();
  const std::array<std::string, 4> forms = {pattern, "*." + pattern, pattern + ".*",
                                            "*." + pattern + ".*"};
  for (const Signal& s : trace.signals())
    if (std::any_of(forms.begin(), forms.end(),
                    [&](const std::string& form) { return matches(form, s.name); }))
      found.push_back(&s);
  if (found.empty()) (void)find_signal(trace, pattern);  // throws with the nearest names
  std::size_t longest = 4;
  for (std::size_t i = 0; i < found.size() && (r.max == 0 || i < r.max); ++i)
    longest = std::max(longest, found[i]->name.size());
  for (const Signal* s : found) {
    if (!lines.next()) continue;
    const std::string range = s->ranged ? fmt::format("[{}:{}]", s->left, s->right) : "";
    if (r.json)
      signals.push_back({{"name", s->name},
                         {"width", s->width},
                         {"range", range},
                         {"type", s->kind},
                         {"direction", s->direction}});
    else
      fmt::format_to(std::back_inserter(text), "{:<{}}  {:>5}  {} {}{}{}\n",
                     printable_name(s->name), longest, s->width, s->kind, s->direction,
                     range.empty() ? "" : " ", range);
  }
  if (r.json) {
    Json j = begin_json(r);
    j.update({{"signals", signals}, {"more", lines.more()}});
    cli::print_json(j);
    return 0;
  }
  cli::print(without_spaces(fmt::to_string(text) + lines.rest()));
  return 0;
}

int values_at(const Request& r) {
  if (r.words.size() < 2)
    throw Error(ErrorCode::kUsage,
                "cde wave at needs a time and signals: cde wave at FILE TIME SIGNAL ...");
  Trace trace(r.file);
  Times times(trace, r.clock);
  warn_if_cut(trace, times);
  const std::uint64_t time = times.parse(r.words.front());
  const std::vector<View> all = views(r, trace, 1);
  std::vector<std::string> values(trace.handles() + std::size_t{1});
  trace.stream(handles(all), time, time, [&](auto, std::uint32_t handle, std::string_view value) {
    values[handle] = value;
    return true;
  });
  Lines lines(r.max);
  Json list = Json::array();
  std::string text = fmt::format("at {}\n", times.text(time));
  std::size_t longest = 0;
  for (std::size_t i = 0; i < all.size() && (r.max == 0 || i < r.max); ++i)
    longest = std::max(longest, all[i].label.size());
  for (const View& v : all) {
    if (!lines.next()) continue;
    const std::string& value = values[v.signal.handle];
    if (r.json)
      list.push_back({{"name", v.label}, {"value", v.text(value)}, {"bits", v.bits(value)}});
    else
      text += fmt::format("{:<{}}  {}\n", printable_name(v.label), longest, v.text(value));
  }
  if (r.json) {
    Json j = begin_json(r);
    j.update({{"time", times.number(time)},
              {"at", times.text(time)},
              {"values", list},
              {"more", lines.more()}});
    cli::print_json(j);
    return 0;
  }
  cli::print(text + lines.rest());
  return 0;
}

int why(const Request& r) {
  cli::print(why_text(r));
  return 0;
}

}  // namespace cde::wave
