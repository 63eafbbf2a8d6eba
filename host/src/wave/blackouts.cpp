// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/blackouts.hpp"

#include <algorithm>

namespace cde::wave {

std::vector<Blackout> blackouts_in(const Trace& trace, std::uint64_t from, std::uint64_t to) {
  std::vector<Blackout> all;
  for (const Blackout& b : trace.blackouts()) {
    const Blackout cut{std::max(b.from, from), std::min(b.to, to)};
    if (cut.from < cut.to) all.push_back(cut);
  }
  return all;
}

std::uint64_t dark_time(const std::vector<Blackout>& all, std::uint64_t from, std::uint64_t to) {
  std::uint64_t sum = 0;
  for (const Blackout& b : all) {
    const std::uint64_t begin = std::max(b.from, from), end = std::min(b.to, to);
    if (begin < end) sum += end - begin;
  }
  return sum;
}

bool is_dark(const std::vector<Blackout>& all, std::uint64_t time) {
  const auto after = std::upper_bound(
      all.begin(), all.end(), time, [](std::uint64_t t, const Blackout& b) { return t < b.from; });
  return after != all.begin() && time < std::prev(after)->to;
}

BlackoutsIn::BlackoutsIn(const Trace& trace, std::uint64_t from, std::uint64_t to) {
  for (const Blackout& b : blackouts_in(trace, from, to)) {
    turns_.push_back({b.from, false});
    if (b.to < to) turns_.push_back({b.to, true});
  }
}

void BlackoutsIn::until(std::uint64_t time, const std::function<void(std::uint64_t, bool)>& tell) {
  for (; next_ < turns_.size() && turns_[next_].time <= time; ++next_)
    tell(turns_[next_].time, turns_[next_].on);
}

}  // namespace cde::wave
