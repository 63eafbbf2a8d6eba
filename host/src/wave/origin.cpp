// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/origin.hpp"

#include <algorithm>
#include <set>

namespace cde::wave {
namespace {

constexpr unsigned kMostHops = 200;
constexpr std::size_t kLeastBits = 8;  // bits that a word needs for its path to be recognisable
constexpr std::uint64_t kLines = 60;   // lines of a cone, of which only the near ones are used

/// Whether another signal hardly has the same bits by chance.
bool tells(const std::string& bits) {
  return bits.size() >= kLeastBits && bits.find_first_not_of("01") == std::string::npos &&
         bits.find('0') != std::string::npos && bits.find('1') != std::string::npos;
}

}  // namespace

std::optional<std::size_t> forwarded_cause(const std::vector<Node>& nodes, const std::string& bits,
                                           const Node::Statement& statement) {
  if (bits.empty()) return std::nullopt;
  std::optional<std::size_t> found, hidden;
  for (const std::size_t n : statement.causes) {
    const Node& cause = nodes[n];
    if (cause.condition || cause.slice.width != bits.size()) continue;
    auto& one = cause.value.empty() ? hidden : found;
    if (one || (!cause.value.empty() && cause.value != bits)) return std::nullopt;
    one = n;
  }
  if (found && hidden) return std::nullopt;
  if (!hidden) return found;
  for (const Node::Statement& behind : nodes[*hidden].statements)
    if (forwarded_cause(nodes, bits, behind)) return hidden;
  return std::nullopt;
}

Origin origin_of(Trace& trace, Times& times, const Design& design, const Slice& signal,
                 std::uint64_t time) {
  Slice slice = signal;
  std::set<std::pair<Slice, std::uint64_t>> seen;
  for (unsigned hop = 0; hop < kMostHops && seen.emplace(slice, time).second; ++hop) {
    Lines lines(kLines);
    const Cone cone(trace, times, design, slice, time, 1, lines);
    const auto& nodes = cone.nodes();
    const std::string bits = nodes.front().value;
    if (!tells(bits)) break;
    // To the next signal in the waves.
    std::size_t at = 0;
    do {
      std::optional<std::size_t> before;
      for (const Node::Statement& s : nodes[at].statements)
        if (!before) before = forwarded_cause(nodes, bits, s);
      if (!before) break;
      at = *before;
    } while (nodes[at].value.empty());
    if (nodes[at].value.empty()) break;
    slice = nodes[at].slice;
    time = nodes[at].time;
  }
  return {design.name(slice), time};
}

}  // namespace cde::wave
