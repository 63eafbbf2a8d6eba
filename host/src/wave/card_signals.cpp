// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/card_signals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "cde/wave/candidates.hpp"

namespace cde::wave {

const std::vector<KindSignals>& card_signals() {
  static const std::vector<KindSignals> kAll = {
      {"pci",
       "transactions on the PCI bus, by the host and by the card",
       {"clk"},
       {"devsel_n", "frame_n", "irdy_n", "trdy_n", "stop_n", "req64_n", "ack64_n", "perr_n",
        "cbe_n", "ad", "own"},
       {},
       {},
       {"cycles", "master", "access", "command", "address", "words", "width", "bytes", "first_word",
        "stop"}},
      {"bus",
       "accesses on the card's local bus, which the functional bus drives",
       {"clk_i"},
       {"bus_i.valid", "bus_i.write", "bus_i.space", "bus_i.addr", "bus_o.ready", "bus_o.rvalid",
        "valid_q", "ready", "allowed"},
       {},
       {},
       {"cycles", "access", "space", "address", "words", "bytes"}},
      {"dma",
       "descriptors that the DMA engine serves",
       {"clk_i"},
       {"fetched_q", "busy_o", "start_o", "purpose_q", "head_q", "host_q", "bytes_q", "remaining_q",
        "offset_q", "space_q", "to_host_q", "irq_q", "code_q"},
       {},
       {},
       {"cycles", "descriptor", "direction", "host", "space", "offset", "bytes", "moved", "bursts",
        "interrupt"}},
      {"pass",
       "passes, from go to done",
       {"control.clk_i"},
       {"control.writeback_ready_i", "control.go_i", "control.ready_o", "control.busy_o",
        "control.done_o", "control.abort_i", "control.command_i.mode", "control.command_i.pair[0]",
        "control.command_i.pair[1]", "control.command_i.primaries", "control.command_i.count",
        "control.command_i.objects", "control.issue_o.valid", "control.secondary_pop_o",
        "control.bubble_o", "control.stall_o", "control.writeback_o.valid", "records.write_o"},
       {},
       {},
       {"cycles", "pass", "mode", "pair", "second_pair", "primaries", "secondaries", "objects",
        "tested", "rows", "records", "bubbles", "writeback"}},
      {"primary",
       "primaries, from their first word to the register file",
       {"registers.clk_bus_o", "control.clk_i"},
       {"engine.primaries.commit", "engine.primaries.write_i", "engine.primaries.number",
        "engine.prim_bad_o", "control.clear_o", "control.go_i", "control.ready_o", "control.busy_o",
        "registers.caps.exp", "registers.caps.man", "registers.caps.lanes"},
       {"engine.primaries.slot[#]"},
       {"engine.primaries.pose_i", "engine.primaries.pose_number_i", "engine.primaries.commit_o"},
       {"cycles", "primary", "row", "lane", "source", "pass", "operand"}},
      {"secondary",
       "secondaries, from the DDR request to the last row that tests them",
       {"control.clk_i"},
       {"control.secondary_pop_o", "control.secondary_valid_i", "control.fetch_start_o",
        "control.go_i", "control.ready_o", "control.busy_o", "control.done_o", "control.flush_o",
        "control.issue_o.valid", "control.stall_o", "secondaries.taken",
        "secondaries.slot_requested", "secondaries.slot_number", "secondaries.index_o",
        "secondaries.bad_o", "registers.caps.exp", "registers.caps.man"},
       {"secondaries.slot_o[#]"},
       {},
       {"cycles", "pass", "index", "slot", "fetch", "rows", "operand"}},
      {"test",
       "rows of pair tests, one test per lane, from issue to answer",
       {"control.clk_i"},
       {"control.retire_i", "control.go_i", "control.ready_o", "control.busy_o", "control.flush_o",
        "control.issue_o.valid", "control.stall_o", "engine.index_i"},
       {"control.issue_o.row[#]", "engine.row_out[#]", "engine.index[#]",
        "engine.group[#].lanes.port[#].results.f[#]",
        "engine.group[#].lanes.port[#].results.update.mask[#]",
        "engine.group[#].lanes.port[#].results.update.better[#]"},
       {},
       {"cycles", "pass", "port", "row", "index", "tests", "hits", "kept", "hit_primaries",
        "kept_primaries"}},
      {"record",
       "records, from the result to the record memory",
       {"control.clk_i"},
       {"records.record_valid", "records.sram_ready", "records.write_o", "control.go_i",
        "control.ready_o", "control.busy_o", "registers.caps.exp", "registers.caps.man"},
       {"records.record_o[#]"},
       {},
       {"cycles", "pass", "primary", "index", "F", "T", "CP", "normal"}},
  };
  return kAll;
}

const KindSignals& tested_signals() {
  static const KindSignals kTested = {
      "tested",
      "pairs of a primary as they arrive at the update engine",
      {"control.clk_i"},
      {"control.retire_i", "control.go_i", "control.ready_o", "control.busy_o"},
      {"engine.row_out[#]", "engine.index[#]", "engine.group[#].lanes.port[#].results.f[#]",
       "engine.group[#].lanes.port[#].results.bad[#]",
       "engine.group[#].lanes.port[#].results.streaming_i",
       "engine.group[#].lanes.port[#].results.update.mask[#]",
       "engine.group[#].lanes.port[#].results.update.hit[#]",
       "engine.group[#].lanes.port[#].results.update.better[#]",
       "engine.group[#].lanes.port[#].results.update.t_value[#]",
       "engine.group[#].lanes.port[#].results.update.t_old[#]"},
      {},
      {}};
  return kTested;
}

std::vector<std::string> tested_scopes() {
  std::vector<std::string> patterns;
  const KindSignals& kind = tested_signals();
  for (const auto* names : {&kind.clocks, &kind.signals, &kind.arrays})
    patterns.insert(patterns.end(), names->begin(), names->end());
  for (std::string& p : patterns) std::replace(p.begin(), p.end(), '#', '*');
  return patterns;
}

namespace {

/// Whether a name matches a pattern in which # stands for a number. Collects the numbers.
bool fits(std::string_view pattern, std::string_view name, std::vector<unsigned>& indices) {
  indices.clear();
  std::size_t at = 0;
  for (const char c : pattern) {
    if (c != '#') {
      if (at >= name.size() || name[at++] != c) return false;
      continue;
    }
    unsigned number = 0;
    const auto read = std::from_chars(name.data() + at, name.data() + name.size(), number);
    if (read.ec != std::errc()) return false;
    at = static_cast<std::size_t>(read.ptr - name.data());
    indices.push_back(number);
  }
  return at == name.size();
}

}  // namespace

SignalPlaces::SignalPlaces(Trace& trace) : trace_(trace) {
  for (const Signal& s : trace.signals()) by_name_.emplace(s.name, &s);
}

std::vector<std::string> SignalPlaces::scopes(const KindSignals& kind) const {
  std::vector<std::string> found;
  const std::string end = fmt::format(".{}", kind.signals.front());
  for (const Signal& s : trace_.signals())
    if (s.name.ends_with(end)) found.push_back(s.name.substr(0, s.name.size() - end.size()));
  return found;
}

SignalPlace SignalPlaces::place(const KindSignals& kind, const std::string& scope,
                                std::vector<std::string>& missing) const {
  SignalPlace p{&kind, scope, {}, {}};
  const auto look = [&](std::string_view name, bool needed) {
    const auto at = by_name_.find(fmt::format("{}.{}", scope, name));
    if (at != by_name_.end())
      p.signals.emplace(name, at->second);
    else if (needed)
      missing.emplace_back(name);
  };
  for (const auto name : kind.clocks) look(name, true);
  for (const auto name : kind.signals) look(name, true);
  for (const auto name : kind.optional) look(name, false);
  for (const auto pattern : kind.arrays) {
    const std::string whole = fmt::format("{}.{}", scope, pattern);
    const std::string start = whole.substr(0, whole.find('#'));
    std::vector<Element> elements;
    std::vector<unsigned> indices;
    for (auto at = by_name_.lower_bound(start);
         at != by_name_.end() && at->first.starts_with(start); ++at)
      if (fits(whole, at->first, indices)) elements.push_back({indices, at->second});
    std::sort(elements.begin(), elements.end(),
              [](const Element& a, const Element& b) { return a.indices < b.indices; });
    if (elements.empty())
      missing.emplace_back(pattern);
    else
      p.arrays.emplace(pattern, std::move(elements));
  }
  return p;
}

std::vector<SignalPlace> SignalPlaces::of(const KindSignals& kind) const {
  std::vector<SignalPlace> found;
  for (const std::string& scope : scopes(kind)) {
    std::vector<std::string> missing;
    SignalPlace p = place(kind, scope, missing);
    if (missing.empty()) found.push_back(std::move(p));
  }
  return found;
}

std::vector<std::string> SignalPlaces::missing(const KindSignals& kind) const {
  std::vector<std::string> least;
  bool first = true;
  for (const std::string& scope : scopes(kind)) {
    std::vector<std::string> missing;
    (void)place(kind, scope, missing);
    if (first || missing.size() < least.size()) least = std::move(missing);
    first = false;
  }
  if (!first) return least;
  for (const auto* names : {&kind.clocks, &kind.signals, &kind.arrays})
    least.insert(least.end(), names->begin(), names->end());
  return least;
}

}  // namespace cde::wave
