// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>

#include "cde/wave/cone.hpp"

namespace cde::wave {
namespace {

constexpr unsigned kMostWires = 200;  // wires in a chain

}  // namespace

Sampled::Sampled(Trace& trace, const Design& design) : trace_(trace), design_(design) {
  for (const Signal& s : trace.signals())
    if (!s.real && !s.text) {
      names_.emplace(s.name, &s);
      if (s.name.ends_with(']')) names_.emplace(without_array_scope(s.name), &s);
    }
  // Each section begins with the values at the end of the last one.
  std::uint64_t last = trace.start();
  for (const Section& s : trace.structure().sections) {
    if (s.end < last) continue;
    stretches_.push_back({last, s.end});
    last = s.end;
  }
  if (stretches_.empty() || last < trace.end()) stretches_.push_back({last, trace.end()});
}

std::vector<Sampled::Part> Sampled::find_parts(Slice s) {
  for (unsigned wires = 0; wires < kMostWires && s.width != 0; ++wires) {
    auto pieces = design_.pieces(s, [&](const std::string& name) { return names_.contains(name); });
    std::sort(pieces.begin(), pieces.end(),
              [](const auto& a, const auto& b) { return a.slice.low < b.slice.low; });
    std::vector<Part> parts;
    std::uint64_t at = s.low + s.width;  // end of the missing bits
    for (auto p = pieces.rbegin(); p != pieces.rend(); ++p) {
      const Signal& signal = *names_.at(p->name);
      if (signal.width != p->slice.width) break;
      const std::uint64_t top = p->slice.low + p->slice.width;
      const std::uint64_t low = std::max(s.low, p->slice.low);
      if (top < at || low >= at) break;
      parts.push_back({signal.handle, top - at, at - low});
      at = low;
    }
    if (at == s.low) return parts;
    const auto drivers = design_.drivers(s, nullptr);
    if (drivers.size() != 1 || drivers[0].kind != Driver::Kind::kWire ||
        drivers[0].sources.size() != 1 || drivers[0].sources[0].width != s.width)
      break;
    s = drivers[0].sources[0];
  }
  return {};
}

const std::vector<Sampled::Part>& Sampled::parts(const Slice& s) {
  const auto found = parts_.find(s);
  if (found != parts_.end()) return found->second;
  return parts_.emplace(s, find_parts(s)).first->second;
}

bool Sampled::has(const Slice& s) {
  return !parts(s).empty();
}

void Sampled::fetch(const std::vector<Slice>& slices, std::uint64_t time) {
  auto& values = values_[time];
  std::vector<std::uint32_t> wanted;
  for (const Slice& s : slices)
    for (const Part& p : parts(s))
      if (!values.contains(p.handle)) wanted.push_back(p.handle);
  if (wanted.empty() || time < trace_.start() || time > trace_.end()) return;
  trace_.stream(wanted, time, time, [&](auto, std::uint32_t handle, std::string_view value) {
    values[handle] = value;
    return true;
  });
}

std::string Sampled::bits(const Slice& s, std::uint64_t time) {
  fetch({s}, time);
  std::string all;
  const auto& values = values_[time];
  for (const Part& p : parts(s)) {
    const auto value = values.find(p.handle);
    if (value == values.end() || value->second.size() < p.first + p.count) return {};
    all.append(value->second, p.first, p.count);
  }
  return all;
}

const Sampled::Changes& Sampled::changes(std::uint32_t handle, std::size_t bit,
                                         std::size_t stretch) {
  const auto [at, fresh] = changes_.try_emplace({handle, bit, stretch});
  Changes& all = at->second;
  if (!fresh) return all;
  char before = 'x';
  trace_.stream(std::array{handle}, stretches_[stretch].from, stretches_[stretch].to,
                [&](std::uint64_t time, std::uint32_t, std::string_view value) {
                  const char now = bit < value.size() ? value[bit] : 'x';
                  if (now != before && before != 'x') all.emplace_back(time, now);
                  before = now;
                  return true;
                });
  return all;
}

std::optional<std::uint64_t> Sampled::last_edge(const ClockEdge& edge, std::uint64_t time) {
  const auto& where = parts(edge.signal);
  if (where.size() != 1 || where[0].count != 1) return std::nullopt;
  for (std::size_t i = stretches_.size(); i-- > 0;) {
    if (stretches_[i].from > time) continue;
    const Changes& all = changes(where[0].handle, where[0].first, i);
    auto at = std::upper_bound(all.begin(), all.end(), std::pair(time, '\x7f'));
    while (at != all.begin()) {
      --at;
      if ((at->second == '1' && edge.rising) || (at->second == '0' && edge.falling))
        return at->first;
    }
  }
  return std::nullopt;
}

std::optional<std::uint64_t> Sampled::last_change(const Slice& s, std::uint64_t time) {
  const auto& where = parts(s);
  std::vector<std::uint32_t> wanted;
  for (const Part& p : where) wanted.push_back(p.handle);
  for (std::size_t i = wanted.empty() ? 0 : stretches_.size(); i-- > 0;) {
    if (stretches_[i].from > time) continue;
    std::map<std::uint32_t, std::string> values;
    std::optional<std::uint64_t> last;
    trace_.stream(wanted, stretches_[i].from, std::min(time, stretches_[i].to),
                  [&](std::uint64_t at, std::uint32_t handle, std::string_view value) {
                    std::string& before = values[handle];
                    const bool first = before.empty();
                    for (const Part& p : where)
                      if (p.handle == handle && !first &&
                          before.compare(p.first, p.count, value.substr(p.first, p.count)) != 0)
                        last = at;
                    before = value;
                    return true;
                  });
    if (last) return last;
  }
  return std::nullopt;
}

}  // namespace cde::wave
