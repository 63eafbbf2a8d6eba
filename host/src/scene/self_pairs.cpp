// SPDX-License-Identifier: Apache-2.0
#include "scene/self_pairs.hpp"

#include <algorithm>
#include <unordered_map>
#include <vector>

namespace cde {

SelfPairs::SelfPairs(const Scene& scene, const SceneQuery& query)
    : mask_(query.mask), once_(query.mode == Mode::kAll || query.mode == Mode::kHits) {
  for (const std::size_t i : query.secondaries) secondaries_ += size(scene.objects[i].shapes);
  if (query.self) return;
  std::unordered_map<std::size_t, std::vector<std::uint64_t>> first_of;  // secondaries, by object
  std::uint64_t secondary = 0, primary = 0;
  for (const std::size_t s : query.secondaries) {
    first_of[s].push_back(secondary);
    secondary += size(scene.objects[s].shapes);
  }
  for (const std::size_t p : query.primaries) {
    const std::uint64_t count = size(scene.objects[p].shapes);
    if (const auto found = first_of.find(p); found != first_of.end())
      for (const std::uint64_t first : found->second) shared_.push_back({primary, first, count});
    primary += count;
  }
}

std::int64_t SelfPairs::twin(std::uint64_t number, std::uint64_t Shared::*side,
                             std::uint64_t Shared::*other) const {
  for (const Shared& s : shared_)
    if (number >= s.*side && number - s.*side < s.count)
      return static_cast<std::int64_t>(number - s.*side + s.*other);
  return -1;
}

bool SelfPairs::counts(std::uint32_t primary, std::uint32_t secondary) const {
  if (shared_.empty()) return true;
  const std::int64_t mirrored = twin(secondary, &Shared::secondary, &Shared::primary);
  if (mirrored < 0) return true;
  if (mirrored == std::int64_t{primary}) return false;
  if (!once_ || mirrored > std::int64_t{primary}) return true;
  return twin(primary, &Shared::primary, &Shared::secondary) < 0 ||
         contains(mask_, static_cast<std::uint64_t>(mirrored));
}

std::uint64_t SelfPairs::left_out() const {
  std::uint64_t shapes = 0;
  for (const Shared& s : shared_) {
    shapes += s.count;
    for (const Range& m : mask_) {
      const std::uint64_t first = std::max<std::uint64_t>(m.first, s.primary);
      const std::uint64_t end = std::min<std::uint64_t>(m.first + m.count, s.primary + s.count);
      shapes -= end > first ? end - first : 0;
    }
  }
  return shapes + (once_ && shapes != 0 ? shapes * (shapes - 1) / 2 : 0);
}

/// The first secondary for which some primary of the packet needs a record. Records are pairwise.
std::uint64_t SelfPairs::first_needed(std::uint64_t first, std::uint64_t count) const {
  if (!mask_.empty()) return 0;
  std::uint64_t covered = first;  // end of the leading primaries that have twins; any other primary
                                  // needs all secondaries
  for (const Shared& s : shared_)
    if (s.primary <= covered && covered < s.primary + s.count) covered = s.primary + s.count;
  if (covered < first + count) return 0;
  std::vector<Shared> in_order = shared_;
  std::sort(in_order.begin(), in_order.end(),
            [](const Shared& a, const Shared& b) { return a.secondary < b.secondary; });
  std::uint64_t at = 0;
  for (const Shared& s : in_order) {
    if (s.secondary > at) return at;
    const std::uint64_t before = std::clamp(first + 1, s.primary, s.primary + s.count) - s.primary;
    if (before < s.count) return s.secondary + before;
    at = s.secondary + s.count;
  }
  return at;
}

std::vector<SelfPairs::PassRange> SelfPairs::passes(std::uint64_t first, std::uint64_t count,
                                                    bool whole) const {
  std::vector<PassRange> all;
  const auto add = [&](std::uint64_t from, std::uint64_t to, bool pairwise) {
    if (from < to) all.push_back({from, to - from, pairwise});
  };
  if (once_) {
    const std::uint64_t needed = first_needed(first, count);
    add(whole && needed < secondaries_ ? 0 : needed, secondaries_, false);
    return all;
  }
  std::uint64_t low = secondaries_, high = 0;  // twins of the packet
  for (const Shared& s : shared_) {
    const std::uint64_t from = std::max(first, s.primary);
    const std::uint64_t to = std::min(first + count, s.primary + s.count);
    if (from >= to) continue;
    low = std::min(low, from - s.primary + s.secondary);
    high = std::max(high, to - s.primary + s.secondary);
  }
  if (high == 0) low = high = secondaries_;
  if (whole && high > low) low = 0, high = secondaries_;
  add(0, low, false);
  add(low, high, true);
  add(high, secondaries_, false);
  return all;
}

}  // namespace cde
