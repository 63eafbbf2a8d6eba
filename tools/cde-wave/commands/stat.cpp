// SPDX-License-Identifier: Apache-2.0
// cde wave stat: measures how busy signals, handshakes and pipes are.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <optional>
#include <set>

#include "cde/support/columns.hpp"
#include "cde/support/counted.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/wave/handshakes.hpp"
#include "cde/wave/measure.hpp"
#include "cde/wave/scope_views.hpp"
#include "cde/wave/stalls.hpp"
#include "commands/commands.hpp"
#include "output/streams.hpp"

namespace cde::wave {
namespace {

using Json = nlohmann::ordered_json;

std::string percent(std::uint64_t part, std::uint64_t whole) {
  if (whole == 0) return "-";
  return fmt::format("{:.1f} %", 100.0 * static_cast<double>(part) / static_cast<double>(whole));
}
Json share(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? Json() : Json(static_cast<double>(part) / static_cast<double>(whole));
}

std::string text_of(const Columns& table, const Lines& lines) {
  return table.lines.empty() ? "" : table.text() + lines.rest() + "\n";
}

/// Keeps only flows of the requested signals.
void keep_wanted(Flows& flows, const std::vector<View>& views) {
  std::set<std::uint32_t> asked;
  for (const View& v : views) asked.insert(v.signal.handle);
  std::vector<Handshake> kept;
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < flows.handshakes.size(); ++i) {
    const Handshake& h = flows.handshakes[i];
    if (asked.contains(h.valid.handle) || asked.contains(h.ready.handle) ||
        (h.is_pci() && asked.contains(h.frame.handle)))
      numbers.push_back(i);
  }
  for (const std::size_t i : numbers) {
    Handshake& h = kept.emplace_back(flows.handshakes[i]);
    h.leads_to.clear();
    for (const std::size_t j : numbers) h.leads_to.push_back(flows.handshakes[i].leads_to[j]);
  }
  flows.handshakes = std::move(kept);
  std::erase_if(flows.pipes, [&](const PipeValid& p) { return !asked.contains(p.handle); });
}

/// Prints the measurements.
class Report {
 public:
  Report(const Request& r, const Measure& m, Times& times, const Window& w)
      : r_(r), m_(m), times_(times), w_(w) {
    if (const Signal* const clock = times.clock_if_any()) {
      const auto& edges = times.edges();
      const auto before = [&](std::uint64_t t) {
        return static_cast<std::uint64_t>(std::upper_bound(edges.begin(), edges.end(), t) -
                                          edges.begin());
      };
      clock_ = clock->name;
      cycles_ = before(w.to) - before(w.from);
    }
  }

  void text() {
    std::string all = fmt::format("{} to {}", times_.text(w_.from), times_.text(w_.to));
    if (cycles_) all += fmt::format(", {} of {}", counted(*cycles_, "cycle"), clock_);
    all += "\n";
    for (const Blackout& b : m_.dark)
      all += fmt::format("no dump from {} to {} ($dumpoff); this time does not count\n",
                         times_.text(b.from), times_.text(b.to));
    all += "\n";
    handshakes_text(all);
    chains_text(all);
    pipes_text(all);
    signals_text(all);
    if (all.ends_with("\n\n")) all.pop_back();
    cli::print(without_spaces(printable_lines(all)));
  }

  void json() {
    Json j = begin_json(r_);
    const auto list = [&](std::size_t count, auto&& entry) {
      Lines lines(r_.max);
      Json all = Json::array();
      for (std::size_t i = 0; i < count; ++i)
        if (lines.next()) all.push_back(entry(i));
      more_ += lines.more();
      return all;
    };
    j.update({{"from", times_.number(w_.from)},
              {"to", times_.number(w_.to)},
              {"clock", cycles_ ? Json(clock_) : Json()},
              {"cycles", cycles_ ? Json(*cycles_) : Json()}});
    Json dark = Json::array();
    for (const Blackout& b : m_.dark)
      dark.push_back({{"from", times_.number(b.from)}, {"to", times_.number(b.to)}});
    j["blackouts"] = std::move(dark);
    j["handshakes"] = list(m_.uses.size(), [&](std::size_t i) { return handshake_json(i); });
    const std::vector<Chain> chains = stall_chains(m_.handshakes, m_.stalls);
    j["chains"] = list(chains.size(), [&](std::size_t i) { return chain_json(chains[i]); });
    j["bubbles"] = list(m_.bubbles.size(), [&](std::size_t i) { return pipe_json(i); });
    j["signals"] = list(m_.signals.size(), [&](std::size_t i) { return signal_json(i); });
    j["more"] = more_;
    cli::print_json(j);
  }

 private:
  static std::string printable_lines(const std::string& text) {
    std::string all;
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t stop = std::min(text.find('\n', at), text.size());
      all += printable_name(text.substr(at, stop - at)) + "\n";
      at = stop + 1;
    }
    return all;
  }
  /// "155ns cyc:15"; cycles count by the clock of the measurement.
  std::string at(std::uint64_t time) {
    const auto cycle = cycles_ ? times_.cycle(time) : std::nullopt;
    return times_.text(time) + (cycle ? fmt::format(" cyc:{}", *cycle) : "");
  }

  void handshakes_text(std::string& all) {
    Lines lines(r_.max);
    Columns table{.heads = {"handshake", "cycles", "transfers", "stalled", "idle", "unknown",
                            "utilisation", "longest stall"},
                  .gap = 2};
    std::string notes;
    for (std::size_t i = 0; i < m_.uses.size(); ++i) {
      if (!lines.next()) continue;
      const Use& u = m_.uses[i];
      table.lines.push_back(
          {m_.handshakes[i].name, fmt::to_string(u.cycles), fmt::to_string(u.transferred),
           fmt::to_string(u.stalled), fmt::to_string(u.idle), fmt::to_string(u.unknown),
           percent(u.transferred, u.cycles),
           u.longest == 0 ? "-" : fmt::format("{} at {}", u.longest, at(u.longest_time))});
      if (m_.handshakes[i].is_pci())
        notes += fmt::format("{}: {} address phases, not included above\n", m_.handshakes[i].name,
                             u.address);
    }
    std::string text = text_of(table, lines);
    if (!notes.empty()) {
      text.pop_back();
      text += notes + "\n";
    }
    all += text;
  }

  void chains_text(std::string& all) {
    const std::vector<Chain> chains = stall_chains(m_.handshakes, m_.stalls);
    Lines lines(r_.max);
    std::string text;
    // Each line of a chain counts towards --max, because a chain may be long.
    for (const Chain& c : chains) {
      if (lines.next()) {
        text += counted(c.cycles, "cycle") + ", ";
        if (c.times != 1) text += fmt::format("{} times, longest {}, first ", c.times, c.longest);
        text += fmt::format("at {}, origin {}\n", at(c.first_time), m_.handshakes[c.origin].name);
      }
      for (const std::size_t m : c.members)
        if (lines.next()) text += fmt::format("  {}\n", m_.handshakes[m].name);
    }
    if (!text.empty()) all += "stall chains, upstream to downstream\n" + text + lines.rest() + "\n";
  }

  void pipes_text(std::string& all) {
    Lines lines(r_.max);
    Columns table{.heads = {"valid of a pipe", "cycles", "at 1", "first at", "last at", "bubbles",
                            "longest bubble"},
                  .gap = 2};
    for (std::size_t i = 0; i < m_.bubbles.size(); ++i) {
      if (!lines.next()) continue;
      const Bubbles& b = m_.bubbles[i];
      table.lines.push_back(
          {m_.pipes[i].name, fmt::to_string(b.cycles), fmt::to_string(b.valid),
           b.valid == 0 ? "-" : at(b.first), b.valid == 0 ? "-" : at(b.last),
           fmt::to_string(b.empty),
           b.longest == 0 ? "-" : fmt::format("{} at {}", b.longest, at(b.longest_time))});
    }
    all += text_of(table, lines);
  }

  void signals_text(std::string& all) {
    Lines lines(r_.max);
    Columns table{
        .heads = {"signal", "changes", "per cycle", "toggles", "time at 1", "longest quiet"},
        .gap = 2};
    for (const Activity& a : m_.signals) {
      if (!lines.next()) continue;
      table.lines.push_back(
          {a.view.label, fmt::to_string(a.changes),
           cycles_ && *cycles_ != 0 ? fmt::format("{:.3g}", static_cast<double>(a.changes) /
                                                                static_cast<double>(*cycles_))
                                    : "-",
           a.bits ? fmt::to_string(a.toggles) : "-", one_bit(a) ? percent(a.high, measured()) : "-",
           fmt::format("{} from {}", times_.span(a.quiet), times_.text(a.quiet_from))});
    }
    all += text_of(table, lines);
  }
  [[nodiscard]] std::uint64_t measured() const {
    return w_.to - w_.from - dark_time(m_.dark, w_.from, w_.to);
  }
  static bool one_bit(const Activity& a) { return a.bits && a.view.width == 1; }

  Json handshake_json(std::size_t i) {
    const Handshake& h = m_.handshakes[i];
    const Use& u = m_.uses[i];
    const bool stalled = u.longest != 0;
    Json j = {{"name", h.name},
              {"protocol", h.protocol},
              {"clock", h.clock_name},
              {"cycles", u.cycles},
              {"transferred_cycles", u.transferred},
              {"stalled_cycles", u.stalled},
              {"idle_cycles", u.idle},
              {"unknown_cycles", u.unknown},
              {"address_cycles", h.is_pci() ? Json(u.address) : Json()},
              {"utilisation", share(u.transferred, u.cycles)},
              {"longest_stall", u.longest},
              {"time", stalled ? Json(times_.number(u.longest_time)) : Json()},
              {"at", stalled ? Json(times_.text(u.longest_time)) : Json()}};
    return j;
  }
  Json chain_json(const Chain& c) {
    Json members = Json::array();
    Lines lines(r_.max);
    for (const std::size_t m : c.members)
      if (lines.next()) members.push_back(m_.handshakes[m].name);
    more_ += lines.more();
    return {{"members", members},
            {"origin", m_.handshakes[c.origin].name},
            {"occurrences", c.times},
            {"stalled_cycles", c.cycles},
            {"longest_stall", c.longest},
            {"time", times_.number(c.first_time)},
            {"at", times_.text(c.first_time)}};
  }
  Json pipe_json(std::size_t i) {
    const Bubbles& b = m_.bubbles[i];
    const bool any = b.valid != 0;
    return {{"name", m_.pipes[i].name},
            {"clock", m_.pipes[i].clock_name},
            {"cycles", b.cycles},
            {"valid_cycles", b.valid},
            {"first_valid", any ? Json(times_.number(b.first)) : Json()},
            {"last_valid", any ? Json(times_.number(b.last)) : Json()},
            {"empty_cycles", b.empty},
            {"longest_bubble", b.longest},
            {"time", b.longest != 0 ? Json(times_.number(b.longest_time)) : Json()},
            {"at", b.longest != 0 ? Json(times_.text(b.longest_time)) : Json()}};
  }
  Json signal_json(std::size_t i) {
    const Activity& a = m_.signals[i];
    return {{"name", a.view.label},
            {"change_count", a.changes},
            {"changes_per_cycle", cycles_ ? share(a.changes, *cycles_) : Json()},
            {"toggles", a.bits ? Json(a.toggles) : Json()},
            {"share_at_one", one_bit(a) ? share(a.high, measured()) : Json()},
            {"longest_quiet", a.quiet},
            {"time", times_.number(a.quiet_from)},
            {"at", times_.text(a.quiet_from)}};
  }

  const Request& r_;
  const Measure& m_;
  Times& times_;
  Window w_;
  std::string clock_;
  std::optional<std::uint64_t> cycles_;
  std::uint64_t more_ = 0;  ///< entries that JSON leaves out
};

}  // namespace

int statistics(const Request& r) {
  Trace trace(r.file);
  Times times(trace, r.clock);
  warn_if_cut(trace, times);
  if (!r.clock.empty()) (void)times.clock();  // throws if it is not a clock
  const Window w = window(r, trace, times);
  std::vector<View> views = views_in_scopes(r, trace, true);
  Flows flows = find_flows(trace, r.clock);
  keep_wanted(flows, views);
  Measure measure(trace, std::move(flows), std::move(views));
  measure.run(trace, w.from, w.to);
  Report report(r, measure, times, w);
  r.json ? report.json() : report.text();
  return 0;
}

}  // namespace cde::wave
