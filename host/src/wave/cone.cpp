// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/cone.hpp"

#include <algorithm>
#include <set>

namespace cde::wave {
namespace {

constexpr std::size_t kMostNodes = 100000;
constexpr unsigned kMostWires = 200;
constexpr unsigned kMostEdges = 256;  // edges to search for a value that is in the waves

/// The time whose values a register samples at an edge.
std::uint64_t just_before(std::uint64_t edge) {
  return edge == 0 ? 0 : edge - 1;
}

bool is_register(const std::vector<Driver>& drivers) {
  return std::any_of(drivers.begin(), drivers.end(),
                     [](const Driver& d) { return d.kind == Driver::Kind::kRegister; });
}

}  // namespace

Cone::Cone(Trace& trace, Times& times, const Design& design, const Slice& root, std::uint64_t time,
           unsigned depth, Lines& lines)
    : times_(times), design_(design), waves_(trace, design), depth_(depth), lines_(lines) {
  (void)lines_.next();
  std::vector<std::size_t> level = {add(root, time, 0)};
  while (!level.empty()) {
    // Reads the signals for a whole level at once.
    std::vector<Waiting> waiting;
    std::map<std::uint64_t, std::vector<Slice>> wanted;
    for (const std::size_t n : level) {
      Waiting w = prepare(n);
      auto& early = wanted[w.edge ? just_before(*w.edge) : nodes_[n].time];
      for (const Driver& d : w.all) {
        early.insert(early.end(), d.sources.begin(), d.sources.end());
        early.insert(early.end(), d.controls.begin(), d.controls.end());
      }
      wanted[nodes_[n].time].push_back(nodes_[n].slice);
      waiting.push_back(std::move(w));
    }
    for (const auto& [at, slices] : wanted) waves_.fetch(slices, at);
    std::vector<std::size_t> next;
    for (Waiting& w : waiting) expand(w, next);
    level = std::move(next);
  }
}

std::size_t Cone::add(const Slice& slice, std::uint64_t time, unsigned registers) {
  Node node;
  node.slice = node.driven = slice;
  node.time = time;
  node.registers = registers;
  nodes_.push_back(std::move(node));
  return nodes_.size() - 1;
}

/// Follows wires to their end, and finds its drivers.
Cone::Waiting Cone::prepare(std::size_t n) {
  Waiting w{n, {}, std::nullopt, false};
  Node& node = nodes_[n];
  for (unsigned wires = 0; wires < kMostWires; ++wires) {
    w.all = design_.drivers(node.driven, nullptr);
    if (w.all.size() != 1 || w.all[0].kind != Driver::Kind::kWire || w.all[0].sources.size() != 1)
      break;
    node.driven = w.all[0].sources[0];
  }
  w.is_register = is_register(w.all);
  if (w.is_register) w.edge = edge_before(w.all, node.time);
  return w;
}

std::optional<std::uint64_t> Cone::edge_before(const std::vector<Driver>& drivers,
                                               std::uint64_t time) {
  std::optional<std::uint64_t> last;
  bool there = false;
  for (const Driver& d : drivers)
    for (const ClockEdge& e : d.edges) {
      there = there || waves_.has(e.signal);
      const auto at = waves_.last_edge(e, time);
      if (at && (!last || *at > *last)) last = at;
    }
  if (there) return last;
  // The clock is hidden, perhaps behind a gate: the waves' clock is near enough.
  if (times_.clock_if_any() == nullptr) return std::nullopt;
  const auto cycle = times_.cycle(time);
  return cycle ? std::optional(times_.edges()[*cycle]) : std::nullopt;
}

/// The drivers that are active at a time or an edge.
std::vector<Driver> Cone::active(const Waiting& w, std::optional<std::uint64_t> edge,
                                 std::uint64_t time) {
  const std::uint64_t at = edge ? just_before(*edge) : time;
  std::vector<Slice> clocks;
  for (const Driver& d : w.all)
    for (const ClockEdge& e : d.edges) clocks.push_back(e.signal);
  const Values values = [&](const Slice& s) {
    // A reset in the sensitivity list has its new value.
    const bool awaited = edge && std::find(clocks.begin(), clocks.end(), s) != clocks.end();
    return waves_.bits(s, awaited ? *edge : at);
  };
  return design_.drivers(nodes_[w.node].driven, &values);
}

/// Handles a value that no statement assigned at the last edge. Searches earlier edges one by one
/// for an assignment. If that is too long ago, uses the value's last change.
void Cone::hold(Waiting& w, std::vector<Driver>& now, bool& held) {
  const Node& node = nodes_[w.node];
  const std::uint64_t start = waves_.start();
  const std::uint64_t changed =
      node.in_waves ? waves_.last_change(node.driven, node.time).value_or(start) : start;
  unsigned most = node.in_waves ? kMostEdges : steps_;
  while (now.empty() && w.is_register && w.edge && *w.edge > changed && most > 0) {
    --most;
    if (!node.in_waves) --steps_;
    w.edge = edge_before(w.all, *w.edge - 1);
    if (!w.edge) break;
    std::vector<Slice> wanted;
    for (const Driver& d : w.all) {
      wanted.insert(wanted.end(), d.sources.begin(), d.sources.end());
      wanted.insert(wanted.end(), d.controls.begin(), d.controls.end());
    }
    waves_.fetch(wanted, just_before(*w.edge));
    now = active(w, w.edge, node.time);
  }
  if (now.empty() && node.in_waves && (!w.is_register || changed > start)) {
    if (w.is_register) w.edge = edge_before(w.all, changed);
    now = active(w, w.edge, changed);
    if (!w.is_register) w.edge = changed;
  }
  held = !now.empty();
}

/// Records why no statement was executed at the last edge.
void Cone::keep(const Waiting& w, std::vector<std::size_t>& next) {
  Node::Statement s;
  s.kept = true;
  s.edge = w.edge;
  std::set<Slice> seen;
  for (const Driver& d : w.all)
    for (const Slice& slice : d.controls) {
      if (design_.is_hidden(slice) || !seen.insert(slice).second || !lines_.next()) continue;
      s.causes.push_back(add(slice, just_before(*w.edge), 1));
      nodes_.back().condition = true;
      next.push_back(s.causes.back());
    }
  if (!s.causes.empty()) nodes_[w.node].statements.push_back(std::move(s));
}

void Cone::expand(Waiting& w, std::vector<std::size_t>& next) {
  const std::size_t n = w.node;
  nodes_[n].in_waves = waves_.has(nodes_[n].slice);
  nodes_[n].value = waves_.bits(nodes_[n].slice, nodes_[n].time);
  const auto [first, fresh] = seen_.emplace(std::pair(nodes_[n].driven, nodes_[n].time), n);
  if (!fresh) {
    nodes_[n].again = true;
    return;
  }
  if (w.all.empty()) {
    nodes_[n].remark = design_.is_input(nodes_[n].driven) ? "input of the design" : "no driver";
    return;
  }
  std::vector<Driver> now;
  bool held = false;
  if (!w.is_register || w.edge) now = active(w, w.edge, nodes_[n].time);
  if (now.empty()) {
    if (n == 0 && w.is_register && w.edge) keep(w, next);
    hold(w, now, held);
  }
  if (now.empty()) {
    nodes_[n].remark =
        nodes_[n].in_waves ? "has not changed" : "assigned earlier, at an unknown time";
    return;
  }
  for (Driver& d : now) {
    Node::Statement s;
    const bool clocked = d.kind == Driver::Kind::kRegister;
    if (clocked || held) s.edge = w.edge;
    s.held = held;
    const unsigned registers = nodes_[n].registers + (clocked ? 1 : 0);
    nodes_[n].stopped = registers > depth_;
    const std::uint64_t at = !s.edge ? nodes_[n].time : clocked ? just_before(*s.edge) : *s.edge;
    const auto cause = [&](const Slice& slice, bool condition) {
      if (registers > depth_ || design_.is_hidden(slice)) return;
      if (!lines_.next() || nodes_.size() >= kMostNodes) return;
      const std::size_t child = add(slice, at, registers);
      nodes_[child].condition = condition;
      s.causes.push_back(child);
      next.push_back(child);
    };
    for (const Slice& slice : d.sources) cause(slice, false);
    for (const Slice& slice : d.controls)
      if (std::find(d.sources.begin(), d.sources.end(), slice) == d.sources.end())
        cause(slice, true);
    s.driver = std::move(d);
    auto& all = nodes_[n].statements;
    // Ports of several instances on one source line are one statement.
    const bool same = !all.empty() && s.driver.kind == Driver::Kind::kPort &&
                      all.back().driver.kind == Driver::Kind::kPort &&
                      all.back().driver.place.name() == s.driver.place.name();
    if (same)
      all.back().causes.insert(all.back().causes.end(), s.causes.begin(), s.causes.end());
    else
      all.push_back(std::move(s));
  }
}

}  // namespace cde::wave
