// SPDX-License-Identifier: Apache-2.0
#include "wave/origin.hpp"

#include <algorithm>
#include <optional>
#include <set>

#include "wave/cone.hpp"

namespace cde::wave {
namespace {

constexpr unsigned kMostHops = 200;
constexpr std::size_t kLeastBits = 8;  // of a word whose way can be told from that of others
constexpr std::uint64_t kLines = 60;   // of a cone, of which only what is near is looked at

/// Whether another signal hardly has the same bits by chance.
bool tells(const std::string& bits) {
  return bits.size() >= kLeastBits && bits.find_first_not_of("01") == std::string::npos &&
         bits.find('0') != std::string::npos && bits.find('1') != std::string::npos;
}

/// What the first node has its word from; nothing if it was made there. What is not in the waves is
/// looked through.
const Node* handed_on(const Cone& cone) {
  const auto& nodes = cone.nodes();
  std::vector<std::size_t> waiting = {0};
  for (std::size_t i = 0; i < waiting.size(); ++i)
    for (const Node::Statement& s : nodes[waiting[i]].statements)
      for (const std::size_t n : s.causes) {
        if (nodes[n].condition) continue;
        if (nodes[n].value == nodes[0].value) return &nodes[n];
        if (nodes[n].value.empty() && !nodes[n].again) waiting.push_back(n);
      }
  return nullptr;
}

}  // namespace

Origin origin_of(Trace& trace, Times& times, const Design& design, const Slice& signal,
                 std::uint64_t time) {
  Slice slice = signal;
  std::set<std::pair<Slice, std::uint64_t>> seen;
  for (unsigned hop = 0; hop < kMostHops && seen.emplace(slice, time).second; ++hop) {
    Lines lines(kLines);
    const Cone cone(trace, times, design, slice, time, 1, lines);
    const Node* const before = tells(cone.nodes().front().value) ? handed_on(cone) : nullptr;
    if (before == nullptr) break;
    slice = before->slice;
    time = before->time;
  }
  return {design.name(slice), time};
}

}  // namespace cde::wave
