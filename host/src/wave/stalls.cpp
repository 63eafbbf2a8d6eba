// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/stalls.hpp"

#include <algorithm>
#include <map>
#include <numeric>

namespace cde::wave {
namespace {

/// Sets of related stalls.
class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  std::size_t root(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) { parent_[root(b)] = root(a); }

 private:
  std::vector<std::size_t> parent_;
};

class Chains {
 public:
  explicit Chains(const std::vector<Handshake>& all) : all_(all), alone_(all.size(), true) {
    for (std::size_t a = 0; a < all.size(); ++a)
      for (std::size_t b = 0; b < all.size(); ++b)
        if (a != b && all[a].leads_to[b]) alone_[a] = alone_[b] = false;
  }

  [[nodiscard]] bool together(std::size_t a, std::size_t b) const {
    if (a == b || all_[a].clock != all_[b].clock) return false;
    return all_[a].leads_to[b] || all_[b].leads_to[a] || alone_[a] || alone_[b];
  }

  /// Adds a set of related stalls.
  void add(const std::vector<Stall>& stalls) {
    std::map<std::size_t, std::uint64_t> start;  // by handshake
    std::uint64_t first = stalls.front().first, last = 0;
    for (const Stall& s : stalls) {
      const auto [at, fresh] = start.try_emplace(s.handshake, s.first);
      if (!fresh) at->second = std::min(at->second, s.first);
      last = std::max(last, s.last);
    }
    if (start.size() < 2) return;
    Chain c;
    c.members = ordered(start);
    c.origin = c.members.front();
    for (const std::size_t m : c.members)
      if (start[m] <= start[c.origin]) c.origin = m;
    std::vector<std::size_t> key = c.members;
    key.push_back(c.origin);
    const auto [at, fresh] = found_.try_emplace(std::move(key), std::move(c));
    Chain& chain = at->second;
    if (fresh) chain.first_time = stalls.front().time;
    ++chain.times;
    chain.cycles += last - first + 1;
    chain.longest = std::max(chain.longest, last - first + 1);
  }

  [[nodiscard]] std::vector<Chain> take() {
    std::vector<Chain> all;
    for (auto& [key, chain] : found_) all.push_back(std::move(chain));
    std::stable_sort(all.begin(), all.end(), [](const Chain& a, const Chain& b) {
      return a.cycles != b.cycles ? a.cycles > b.cycles : a.first_time < b.first_time;
    });
    return all;
  }

 private:
  /// Orders handshakes upstream first: a handshake precedes those that it leads to. Otherwise later
  /// stalls come first, then the order of the file.
  [[nodiscard]] std::vector<std::size_t> ordered(
      const std::map<std::size_t, std::uint64_t>& start) const {
    std::vector<std::size_t> left, order;
    for (const auto& [handshake, begin] : start) left.push_back(handshake);
    std::stable_sort(left.begin(), left.end(),
                     [&](std::size_t a, std::size_t b) { return start.at(a) > start.at(b); });
    const auto before = [&](std::size_t a, std::size_t b) {
      return all_[a].leads_to[b] && !all_[b].leads_to[a];  // and not in a loop
    };
    while (!left.empty()) {
      const auto next = std::find_if(left.begin(), left.end(), [&](std::size_t candidate) {
        return std::none_of(left.begin(), left.end(),
                            [&](std::size_t other) { return before(other, candidate); });
      });
      order.push_back(*next);
      left.erase(next);
    }
    return order;
  }

  const std::vector<Handshake>& all_;
  std::vector<bool> alone_;
  std::map<std::vector<std::size_t>, Chain> found_;
};

}  // namespace

std::vector<Chain> stall_chains(const std::vector<Handshake>& handshakes,
                                std::vector<Stall> stalls) {
  Chains chains(handshakes);
  std::erase_if(stalls, [&](const Stall& s) { return handshakes[s.handshake].is_pci(); });
  std::stable_sort(stalls.begin(), stalls.end(),
                   [](const Stall& a, const Stall& b) { return a.first < b.first; });
  Sets sets(stalls.size());
  std::vector<std::size_t> active;
  for (std::size_t i = 0; i < stalls.size(); ++i) {
    // Cycles of different clocks are not comparable; stalls of another clock just stay slightly
    // longer.
    std::erase_if(active, [&](std::size_t a) { return stalls[a].last < stalls[i].first; });
    for (const std::size_t a : active)
      if (chains.together(stalls[a].handshake, stalls[i].handshake)) sets.join(a, i);
    active.push_back(i);
  }
  std::map<std::size_t, std::vector<Stall>> of;
  for (std::size_t i = 0; i < stalls.size(); ++i) of[sets.root(i)].push_back(stalls[i]);
  for (const auto& [root, members] : of) chains.add(members);
  return chains.take();
}

}  // namespace cde::wave
