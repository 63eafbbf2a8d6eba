// SPDX-License-Identifier: Apache-2.0
// The reader of nodes: every visit gets its node once, whatever the cache, the order of visits, the
// stalls and the delay of memory.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <deque>
#include <functional>
#include <optional>

#include "NodeReader.h"
#include "NodeReaderHalves.h"
#include "NodeReaderOnChip.h"
#include "NodeReaderTwo.h"
#include "clocked.hpp"

namespace cde::testing {
namespace {

// Parameters in CMakeLists.txt.
constexpr unsigned kContexts = 64, kPinned = 16, kLines = 32, kSets = 8;
constexpr unsigned kNodes = 5000, kBase = 90'018, kBeat = 9, kWords = 18;
template <class Module>
constexpr unsigned kCycles = 1;
template <>
constexpr unsigned kCycles<NodeReaderTwo> = 2;
template <>
constexpr unsigned kCycles<NodeReaderHalves> = 4;
template <class Module>
constexpr bool kCached = true;
template <>
constexpr bool kCached<NodeReaderOnChip> = false;

using Places = std::function<unsigned(Dice&)>;

template <class Module>
class Bench {
 public:
  Bench() {
    module_->rst_i = 1;
    module_->clear_i = 1;
    module_->valid_i = module_->ddr_valid_i = module_->ddr_ready_i = 0;
    module_.clock();
    module_.clock();
    module_->rst_i = 0;
    module_->clear_i = 0;
    module_->nodes_i = kNodes;
    module_->base_i = kBase;
  }

  /// Reads nodes until `visits` visits have been served. `patient`: memory and visits never wait.
  void read(unsigned visits, const Places& places, bool patient, unsigned latency = 20) {
    const unsigned end = served + visits;
    for (unsigned left = 200 * visits + 10'000; served < end; ++cycles) {
      ASSERT_NE(left--, 0u) << served << " of " << end << " visits";
      offer(end, places, patient);
      answer(patient);
      module_.settle();
      observe(patient, latency);
      ASSERT_FALSE(::testing::Test::HasFailure());
      const unsigned chip = module_->chip_at_o, half = module_->chip_second_o;
      module_.clock();
      for (unsigned w = 0; w < kWords; ++w)
        module_->chip_node_i[w] =
            kCycles<Module> != 4 || w / kBeat == half ? word_of(chip, w) : ~word_of(chip, w);
    }
  }

  /// Ends the pass as a card does: clears until no answer is outstanding. The first cycle may still
  /// have a request.
  void clear() {
    module_->clear_i = 1;
    module_->valid_i = 0;
    offered_.reset();
    shown_ = 0;
    constexpr unsigned kMost = 2'000;
    unsigned left = kMost;
    do {
      answer(true);
      module_.settle();
      EXPECT_TRUE(!asks() || left == kMost);
      if (asks())
        asked_.push_back({static_cast<unsigned>(module_->ddr_o), cycles + 1 + dice_.below(40)});
      EXPECT_EQ(module_->outstanding_o != 0, !asked_.empty() || module_->ddr_valid_i != 0);
      module_.clock();
      ++cycles;
    } while (!asked_.empty() && --left != 0);
    EXPECT_NE(left, 0u);
    module_->clear_i = 0;
    places_.fill(std::nullopt);
    ++pass_;
  }

  unsigned cycles = 0, served = 0, cached = 0, fetched = 0;
  bool endless = false;  ///< visits are offered until the last cycle, so that some are left

 private:
  /// Other passes have other nodes.
  [[nodiscard]] std::uint32_t word_of(unsigned place, unsigned word) const {
    return (place * 0x9E3779B1u ^ word * 0x85EBCA77u) + pass_;
  }

  struct Asked {
    unsigned word, due;
  };

  [[nodiscard]] bool asks() { return (module_->ddr_o >> 32 & 1) != 0; }

  /// A visit of a free context. Without ready_o another visit may be offered in the next cycle.
  void offer(unsigned end, const Places& places, bool patient) {
    if (!offered_ || (!patient && dice_.once_in(3))) {
      offered_.reset();
      const unsigned first = dice_.below(kContexts);
      for (unsigned k = 0; k < kContexts && !offered_; ++k)
        if (const unsigned c = (first + k) % kContexts; !places_.at(c))
          offered_ = {c, places(dice_)};
    }
    const auto under_way = static_cast<unsigned>(
        std::count_if(places_.begin(), places_.end(), [](const auto& p) { return p.has_value(); }));
    const bool valid =
        offered_ && (endless || served + under_way < end) && (patient || !dice_.once_in(4));
    module_->valid_i = valid;
    if (!valid) return;
    module_->at_i = at_of((*offered_)[0]);
    module_->place_i = (*offered_)[1];
  }

  /// A context's number is in the upper bits; the others come back as they are.
  static unsigned at_of(unsigned context) { return context << 21 | (context * 77'777u & 0x1FFFFF); }

  void answer(bool patient) {
    module_->ddr_ready_i = patient || dice_.once_in(2);
    module_->ddr_valid_i =
        !asked_.empty() && asked_.front().due <= cycles && (patient || !dice_.once_in(3));
    if (module_->ddr_valid_i == 0) return;
    const unsigned at = asked_.front().word - kBase;
    for (unsigned w = 0; w < kBeat; ++w)
      module_->ddr_data_i[w] = word_of((at + w) / kWords, (at + w) % kWords);
    asked_.pop_front();
  }

  void observe(bool patient, unsigned latency) {
    if (asks() && module_->ddr_ready_i != 0) {
      const auto word = static_cast<unsigned>(module_->ddr_o);
      EXPECT_EQ((word - kBase) % kBeat, 0u);
      asked_.push_back({word, cycles + 1 + latency + (patient ? 0 : dice_.below(60))});
    }
    if (shown_ != 0) {
      --shown_;
      // Four cycles: words of a half.
      const unsigned first = kCycles<Module> == 4 && shown_ < 2 ? kBeat : 0;
      for (unsigned w = first; w < (kCycles<Module> == 4 ? first + kBeat : kWords); ++w)
        EXPECT_EQ(module_->node_o[w], word_of(shown_place_, w)) << "node " << shown_place_;
    }
    // On chip, a visit is served in the cycle in which it is offered.
    if (module_->valid_i != 0 && module_->ready_o != 0) {
      places_.at((*offered_)[0]) = (*offered_)[1];
      offered_.reset();
    }
    if (module_->valid_o != 0) {
      EXPECT_EQ(shown_, 0u) << "a visit during another";
      const unsigned context = module_->at_o >> 21, place = module_->place_o;
      EXPECT_EQ(module_->at_o, at_of(context));
      ASSERT_TRUE(places_.at(context)) << "context " << context << " has no visit under way";
      EXPECT_EQ(place, *places_.at(context));
      places_.at(context).reset();
      const bool in_ddr = kCached<Module> && place >= kPinned && place < kNodes;
      EXPECT_EQ(module_->cached_o != 0, in_ddr);
      EXPECT_EQ(module_->chip_read_o != 0, !in_ddr);
      shown_ = kCycles<Module>;
      shown_place_ = place;
      ++served;
      cached += in_ddr;
    } else {
      EXPECT_EQ(module_->cached_o, 0);
      EXPECT_EQ(module_->chip_read_o, 0);
    }
    fetched += module_->fetched_o;
  }

  Clocked<Module> module_;
  Dice dice_;
  std::array<std::optional<unsigned>, kContexts> places_;  ///< by context, of visits under way
  std::optional<std::array<unsigned, 2>> offered_;         ///< context, place
  std::deque<Asked> asked_;
  unsigned shown_ = 0, shown_place_ = 0, pass_ = 0;
};

/// Orders of visits. The set of a reset that is cleared last has nodes of its own.
struct Pattern {
  const char* name;
  Places places;
};
const Pattern kPatterns[] = {
    {"on chip", [](Dice& dice) { return dice.below(kPinned); }},
    {"one node", [](Dice&) { return 1234u; }},
    {"few nodes", [](Dice& dice) { return kPinned + dice.below(24); }},
    {"one set", [](Dice& dice) { return 101 * kSets - 1 + kSets * dice.below(40); }},
    {"two nodes", [](Dice& dice) { return 101 * kSets - 1 + kSets * dice.below(2); }},
    {"some of a set",
     [](Dice& dice) {
       return dice.once_in(20) ? 101 * kSets - 1 + kSets * dice.below(5) : dice.below(kPinned);
     }},
    {"in order", [at = 0u](Dice&) mutable { return at = (at + 1) % kNodes; }},
    {"any", [](Dice& dice) { return dice.below(kNodes); }},
    {"mixed",
     [](Dice& dice) {
       return dice.once_in(3)   ? dice.below(kPinned)
              : dice.once_in(2) ? 64 + dice.below(32)
                                : dice.below(kNodes);
     }},
    {"beyond", [](Dice& dice) { return kNodes - 4 + dice.below(8); }},
};

template <class Module>
class NodeReading : public ::testing::Test {};
using Modules = ::testing::Types<NodeReader, NodeReaderTwo, NodeReaderHalves, NodeReaderOnChip>;
TYPED_TEST_SUITE(NodeReading, Modules, );

TYPED_TEST(NodeReading, EveryVisitGetsItsNode) {
  for (const Pattern& pattern : kPatterns)
    for (const bool patient : {true, false})
      for (const unsigned latency : {1u, 20u, 300u}) {
        SCOPED_TRACE(pattern.name);
        SCOPED_TRACE(latency);
        Bench<TypeParam> bench;
        bench.read(5'000, pattern.places, patient, latency);
        ASSERT_FALSE(::testing::Test::HasFailure());
      }
}

/// Passes that end with visits and requests under way. The next pass starts with an empty cache.
TYPED_TEST(NodeReading, PassesMayEndAtAnyTime) {
  Bench<TypeParam> bench;
  bench.endless = true;
  Dice dice;
  for (unsigned pass = 0; pass < 3'000; ++pass) {
    SCOPED_TRACE(pass);
    bench.read(dice.below(100), kPatterns[pass % std::size(kPatterns)].places, pass % 2 == 0,
               dice.below(80) + 1);
    bench.clear();
    ASSERT_FALSE(::testing::Test::HasFailure());
  }
}

/// Nodes in the cache take as long as nodes on chip. Without stalls, a node takes CYCLES cycles.
TYPED_TEST(NodeReading, CachedNodes_TakeTheDocumentedCycles) {
  constexpr unsigned kVisits = 20'000;
  const auto cached = [](Dice& dice) { return kPinned + dice.below(kLines); };
  Bench<TypeParam> bench;
  bench.read(1'000, cached, true);
  bench.fetched = bench.cycles = 0;
  bench.read(kVisits, cached, true);
  EXPECT_EQ(bench.fetched, 0u);
  EXPECT_GE(bench.cycles + kCycles<TypeParam> - 1, kVisits * kCycles<TypeParam>);
  EXPECT_LT(bench.cycles, 1.03 * kVisits * kCycles<TypeParam>);
}

/// A node takes CYCLES cycles, and a fetch two beats. With one cycle per node, a visit that begins
/// to wait delays others by a cycle, if none is kept. The latency is one that the contexts hide.
TYPED_TEST(NodeReading, Fetches_TakeTheDocumentedCycles) {
  if constexpr (kCached<TypeParam>) {
    constexpr unsigned kVisits = 20'000, kReads = kVisits * kCycles<TypeParam>;
    for (const unsigned one_in : {2u, 10u}) {
      Bench<TypeParam> bench;
      bench.read(
          kVisits,
          [&](Dice& dice) { return dice.once_in(one_in) ? kPinned + dice.below(4'000) : 3u; }, true,
          20);
      EXPECT_GT(bench.fetched, kVisits / one_in * 9 / 10);
      EXPECT_GE(bench.cycles + kCycles<TypeParam> - 1,  // the last node is still there
                std::max(kReads, 2 * bench.fetched));
      EXPECT_LT(bench.cycles, 1.02 * kReads + (kCycles<TypeParam> == 1 ? 0.3 * bench.fetched : 0));
    }
  }
}

/// Nodes that are visited at the same time are fetched once.
TEST(NodeReaders, OneNode_IsFetchedOnce) {
  Bench<NodeReader> bench;
  bench.read(
      2'000, [](Dice&) { return 1234u; }, true, 300);
  EXPECT_EQ(bench.fetched, 1u);
  EXPECT_EQ(bench.cached, 2'000u);
}

}  // namespace
}  // namespace cde::testing
