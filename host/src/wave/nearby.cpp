// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/nearby.hpp"

#include <algorithm>
#include <deque>
#include <set>

namespace cde::wave {
namespace {

constexpr std::size_t kMostSlices = 4000;

}  // namespace

std::vector<Near> driving_statements(const Design& design, const std::vector<std::string>& signals,
                                     unsigned steps, std::size_t most, const Passing& passing) {
  struct Waiting {
    Slice slice;
    unsigned step;
  };
  std::deque<Waiting> waiting;
  std::set<Slice> seen;
  std::vector<Near> places;
  // Breadth first by step; wires add no step, so they go in front.
  const auto add = [&](const Slice& slice, unsigned step, bool wire) {
    if (seen.size() >= kMostSlices || !seen.insert(slice).second) return;
    if (wire)
      waiting.push_front({slice, step});
    else
      waiting.push_back({slice, step});
  };
  for (const std::string& name : signals)
    if (const auto slice = design.find(name)) add(*slice, 0, false);
  while (!waiting.empty() && places.size() < most) {
    const Waiting now = waiting.front();
    waiting.pop_front();
    for (const Driver& d : design.drivers(now.slice, nullptr)) {
      if (passing.end && passing.end(d.place)) continue;
      const bool wire = d.kind == Driver::Kind::kWire || d.kind == Driver::Kind::kPort ||
                        (passing.wire && passing.wire(d.place));
      if (!wire && now.step == steps) continue;
      const bool known = std::any_of(places.begin(), places.end(), [&](const Near& n) {
        return n.place.file == d.place.file && n.place.line == d.place.line;
      });
      const unsigned step = now.step + (wire ? 0 : 1);
      if (!known && d.place.line != 0 && places.size() < most) places.push_back({d.place, step});
      for (const auto* all : {&d.sources, &d.controls})
        for (const Slice& s : *all) add(s, step, wire);
    }
  }
  return places;
}

}  // namespace cde::wave
