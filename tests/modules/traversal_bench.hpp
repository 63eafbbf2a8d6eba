// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <deque>
#include <type_traits>
#include <utility>
#include <vector>

#include "TraversalCached.h"
#include "TraversalGatesTwo.h"
#include "TraversalSerial.h"
#include "TraversalTwo.h"
#include "cde/reference/pipes/root_bounds.hpp"
#include "cde/reference/traversal.hpp"
#include "clocked.hpp"

/// The module traversal.sv with its memories and its rays, for tests.
namespace cde::testing::traversals {

struct Goal {
  unsigned number;  // bvh_pkg::GOAL_*
  Mode mode;
};
inline constexpr Goal kGoals[] = {{0, Mode::kNearest}, {1, Mode::kFarthest}, {2, Mode::kAny}};
inline constexpr unsigned kOccluded = 3, kHits = 4;

inline std::uint32_t word(float x) {
  return std::bit_cast<std::uint32_t>(x);
}

struct Asked {
  std::uint32_t slot, tag;
  unsigned due;
};

/// Answers memory requests after a random delay, out of order.
struct Memory {
  std::vector<Asked> waiting;
};

/// Cycles per node of a unit.
template <class Module>
constexpr unsigned kNodeCycles = 1;
template <>
constexpr unsigned kNodeCycles<TraversalTwo> = 2;
template <>
constexpr unsigned kNodeCycles<TraversalCached> = 2;
template <>
constexpr unsigned kNodeCycles<TraversalSerial> = 2;
template <>
constexpr unsigned kNodeCycles<TraversalGatesTwo> = 2;

/// Cycles per secondary of one lane; 0: a leaf per cycle.
template <class Module>
constexpr unsigned kSerial = 0;
template <>
constexpr unsigned kSerial<TraversalSerial> = 4;

/// Cycles from ray to ray of ray_front_shared.sv; one of ray_front.sv.
template <class Module>
constexpr unsigned kFrontCycles = kNodeCycles<Module> == 2 ? 8 : 1;

/// Nodes on chip; 0: all.
template <class Module>
constexpr unsigned kPinned = 0;
template <>
constexpr unsigned kPinned<TraversalCached> = 32;

template <class Module>
class Bench {
 public:
  Bench(const std::vector<Triangle>& triangles, const Bvh& bvh) : triangles_(triangles), bvh_(bvh) {
    module_->rst_i = module_->reset_i = 1;
    module_->node_base_i = kNodeBase;
    module_->node_ddr_ready_i = module_->node_ddr_valid_i = 0;
    module_->ray_valid_i = module_->fetched_valid_i = 0;
    module_->record_ready_i = module_->fetch_ready_i = 0;
    module_.clock();
    module_->nodes_i = static_cast<IData>(bvh.nodes().size());
    const auto& box = bvh.box();
    const auto root = reference::root_bounds<float>(box.min(), box.max());
    for (unsigned k = 0; k < 3; ++k) {
      module_->root_i[k] = word(root.lower[static_cast<int>(k)]);
      module_->root_i[3 + k] = word(root.upper[static_cast<int>(k)]);
    }
    module_->root_i[6] = word(root.margin);
    module_->rst_i = module_->reset_i = 0;
  }

  /// Records by ray number. `patient`: memory and the record output are always ready.
  template <class P>
  std::vector<Record> cast(const std::vector<P>& rays, unsigned goal, bool patient) {
    std::vector<Record> records(rays.size());
    std::size_t sent = 0, got = 0;
    module_->goal_i = static_cast<CData>(goal);
    module_->traversal_i =
        std::is_same_v<P, Ray> ? 0 : 11;  // ray-triangle, triangle-sphere swapped
    module_->ahead_i = ahead;
    for (cycles = 0; got < rays.size(); ++cycles) {
      if (cycles > 1000 * rays.size() + 1'000'000) {
        ADD_FAILURE() << "timeout: " << got << " of " << rays.size();
        break;
      }
      // The front takes a ray in one of its cycles only, so an impatient test offers it for longer.
      const bool ray = sent < rays.size() && (patient || offered_ || !dice_.once_in(3));
      offered_ = ray && kFrontCycles<Module> > 1;
      module_->ray_valid_i = ray;
      if (ray) {
        const auto words = to_words(rays[sent]);
        for (unsigned w = 0; w < words.size(); ++w) module_->ray_i[w] = word(words[w]);
        module_->number_i = static_cast<IData>(sent);
      }
      module_->turn_i = static_cast<CData>(kSerial<Module> != 0 ? cycles % kSerial<Module> : 0);
      module_->record_ready_i = patient || dice_.once_in(2);
      module_->fetch_ready_i = patient || dice_.once_in(2);
      answer(patient);
      if constexpr (kPinned<Module> != 0) answer_nodes(patient);
      module_.settle();
      if constexpr (kPinned<Module> != 0) ask_nodes(patient);
      if (ray && module_->ray_ready_o != 0) {
        ++sent;
        offered_ = false;
      }
      if (module_->fetch_valid_o != 0 && module_->fetch_ready_i != 0)
        memory_.waiting.push_back({module_->fetch_slot_o, module_->fetch_tag_o,
                                   cycles + 1 + (patient ? 0 : dice_.below(40))});
      if (module_->record_valid_o != 0 && module_->record_ready_i != 0) {
        Record& r = records.at(module_->number_o);
        EXPECT_EQ(r.primary, 0u) << "duplicate record";
        r = record();
        ++got;
      }
      for (unsigned l = 0; l < 2; ++l)
        if ((module_->hit_o >> l & 1) != 0) hits.push_back(hit(l));
      fetched_ += module_->events_o >> 16 & 15u;
      cached_ += module_->events_o >> 12 & 15u;
      nodes_ += module_->events_o >> 8 & 15u;
      leaves_ += module_->events_o >> 4 & 15u;
      secondaries_ += module_->events_o & 15u;
      EXPECT_EQ(module_->fault_o, 0);
      std::array<std::uint32_t, kUnits> at;
      for (unsigned u = 0; u < kUnits; ++u) at.at(u) = place(u);
      module_.clock();
      for (unsigned u = 0; u < kUnits; ++u) {
        if (at.at(u) >= bvh_.nodes().size()) continue;
        if (kPinned<Module> != 0 && at.at(u) >= kPinned<Module>) at.at(u) = 0;  // not on chip
        const auto& words = bvh_.nodes()[at.at(u)].words;
        std::copy(words.begin(), words.end(), &module_->node_i[words.size() * u]);
      }
    }
    return records;
  }

  bool ahead = false;        ///< rays do not wait for their leaves
  std::vector<Record> hits;  ///< records of the goal "hits"

  unsigned cycles = 0;
  [[nodiscard]] std::uint64_t nodes() const { return nodes_; }
  [[nodiscard]] std::uint64_t secondaries() const { return secondaries_; }
  [[nodiscard]] std::uint64_t fetched() const { return fetched_; }
  [[nodiscard]] std::uint64_t cached() const { return cached_; }

  /// Expected cycles of a `patient` cast with enough rays to hide latency. Each unit reads one node
  /// in kNodeCycles. All units together accept one ray, one tested leaf and one beat of DDR per
  /// cycle.
  void expect_cycles(std::size_t rays) const {
    const std::uint64_t tests =
        kSerial<Module> != 0 ? secondaries_ * kSerial<Module> : rays + leaves_;
    const double bound = std::max({static_cast<double>(nodes_ * kNodeCycles<Module>) / kUnits,
                                   static_cast<double>(rays * kFrontCycles<Module>),
                                   static_cast<double>(std::max(tests, 2 * fetched_))});
    EXPECT_GE(cycles, bound);
    EXPECT_LT(cycles, 1.03 * bound);
  }

 private:
  static constexpr unsigned kNodeBase = 1'000'002, kBeat = 9;
  static constexpr unsigned kUnits =
      sizeof(Module::node_i) / sizeof(std::array<std::uint32_t, bvh::Node::kWords>);

  /// Address of the node that a unit requests, 28 bits each.
  std::uint32_t place(unsigned unit) {
    const auto* words = reinterpret_cast<const IData*>(&module_->node_at_o);
    std::uint32_t place = 0;
    for (unsigned bit = 0; bit < 28; ++bit) {
      const unsigned at = 28 * unit + bit;
      place |= (words[at / 32] >> (at % 32) & 1u) << bit;
    }
    return place;
  }

  /// Requests for nodes in DDR: of one unit per cycle, in turn.
  void answer_nodes(bool patient) {
    turn_ = (turn_ + 1) % kUnits;
    module_->node_ddr_ready_i =
        static_cast<CData>(patient || dice_.once_in(2) ? 1u << asking(turn_) : 0);
    module_->node_ddr_valid_i = 0;
    if (beats_.empty() || beats_.front().due > cycles || (!patient && dice_.once_in(4))) return;
    const Asked beat = beats_.front();
    beats_.pop_front();
    module_->node_ddr_valid_i = static_cast<CData>(1u << beat.tag);
    const std::uint32_t word = beat.slot - kNodeBase, place = word / bvh::Node::kWords;
    ASSERT_LT(place, bvh_.nodes().size());
    for (unsigned w = 0; w < kBeat; ++w)
      module_->ddr_data_i[w] = bvh_.nodes()[place].words.at(word % bvh::Node::kWords + w);
  }
  /// The first unit from `unit` on with a request, by the outputs of the last cycle.
  unsigned asking(unsigned unit) {
    for (unsigned k = 0; k < kUnits; ++k)
      if (request((unit + k) % kUnits) >> 32 != 0) return (unit + k) % kUnits;
    return unit;
  }
  void ask_nodes(bool patient) {
    for (unsigned u = 0; u < kUnits; ++u)
      if (const std::uint64_t r = request(u); r >> 32 != 0 && (module_->node_ddr_ready_i >> u & 1))
        beats_.push_back(
            {static_cast<std::uint32_t>(r), u, cycles + 8 + (patient ? 0 : dice_.below(40))});
  }
  /// A unit's request: bit 32 valid, below it the word.
  std::uint64_t request(unsigned unit) {
    const auto* words = reinterpret_cast<const IData*>(&module_->node_ddr_o);
    std::uint64_t r = 0;
    for (unsigned bit = 0; bit < 33; ++bit) {
      const unsigned at = 37 * unit + bit;
      r |= static_cast<std::uint64_t>(words[at / 32] >> (at % 32) & 1u) << bit;
    }
    return r;
  }

  Record record() {
    Record r;
    r.primary = ~0u;  // marks the record as seen
    r.f = module_->f_o != 0;
    if (module_->found_o == 0) return r;
    r.t = std::bit_cast<float>(module_->t_o);
    for (unsigned k = 0; k < 3; ++k)
      r.cp[static_cast<int>(k)] = std::bit_cast<float>(module_->point_o[k]);
    r.index = module_->index_o;
    return r;
  }

  Record hit(unsigned lane) {
    Record r;
    r.primary = module_->hit_number_o;
    r.f = true;
    r.t = std::bit_cast<float>(reinterpret_cast<const IData*>(&module_->hit_t_o)[lane]);
    for (unsigned k = 0; k < 3; ++k)
      r.cp[static_cast<int>(k)] = std::bit_cast<float>(module_->hit_point_o[2 * k + lane]);
    r.index = reinterpret_cast<const IData*>(&module_->hit_index_o)[lane];
    return r;
  }

  void answer(bool patient) {
    auto& waiting = memory_.waiting;
    const auto ready = std::find_if(waiting.begin(), waiting.end(),
                                    [&](const auto& asked) { return asked.due <= cycles; });
    module_->fetched_valid_i = ready != waiting.end() && (patient || !dice_.once_in(4));
    if (module_->fetched_valid_i == 0) return;
    module_->fetched_tag_i = ready->tag;
    if constexpr (kSerial<Module> != 0) return answer_one(ready);
    for (unsigned l = 0; l < 2; ++l) {
      const std::size_t slot = ready->slot + l;
      const bool there = slot < triangles_.size() && (l == 0 || (ready->tag & 1) != 0);
      const std::uint32_t index = there ? bvh_.order()[slot] : 0;
      const auto words = to_words(triangles_[index]);
      for (unsigned w = 0; w < 9; ++w) module_->fetched_i[9 * l + w] = word(words[w]);
      reinterpret_cast<IData*>(&module_->index_i)[l] = index;
    }
    waiting.erase(ready);
  }
  /// A leaf's secondaries come one after the other.
  void answer_one(std::vector<Asked>::iterator leaf) {
    const bool two = (leaf->tag & 1) != 0;
    const std::uint32_t index = bvh_.order()[leaf->slot + (second_ ? 1 : 0)];
    module_->fetched_last_i = second_ || !two;
    second_ = module_->fetched_last_i == 0;
    const auto words = to_words(triangles_[index]);
    for (unsigned w = 0; w < 9; ++w) module_->fetched_i[9 + w] = word(words[w]);
    reinterpret_cast<IData*>(&module_->index_i)[1] = index;
    if (second_) {
      std::swap(*leaf, memory_.waiting.front());
      memory_.waiting.front().due = 0;
    } else {
      memory_.waiting.erase(leaf);
    }
  }

  const std::vector<Triangle>& triangles_;
  const Bvh& bvh_;
  Clocked<Module> module_;
  Memory memory_;
  std::deque<Asked> beats_;  ///< of nodes: the word, the unit
  unsigned turn_ = 0;
  bool second_ = false;   ///< the second secondary of a leaf is next
  bool offered_ = false;  ///< a ray has been offered and not taken
  std::uint64_t nodes_ = 0, leaves_ = 0, secondaries_ = 0, fetched_ = 0, cached_ = 0;
  Dice dice_;
};

}  // namespace cde::testing::traversals
