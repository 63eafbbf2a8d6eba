// SPDX-License-Identifier: Apache-2.0
// Refits in hardware: every word of every node equals the reference, for any timing and order of
// memory responses.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <deque>
#include <numeric>
#include <vector>

#include "Refit.h"
#include "RefitNode.h"
#include "RefitTwo.h"
#include "cde/mesh/terrain.hpp"
#include "cde/reference/refit.hpp"
#include "clocked.hpp"
#include "refit_scenes.hpp"

namespace cde::testing {
namespace {

using bvh::Node;

/// Timing of memory responses.
enum class Timing {
  kSteady,  ///< one triangle per cycle, in order, 20 cycles later; a few requests wait
  kLate,    ///< ready at random, answers after any time, in any order
  kAtOnce,  ///< always ready, one leaf per cycle
};

template <class Module>
class Bench {
 public:
  Bench(std::vector<Node> nodes, const std::vector<std::uint32_t>& order,
        const Triangles& triangles, Timing timing, unsigned seed = 1)
      : nodes(std::move(nodes)),
        order_(order),
        triangles_(triangles),
        timing_(timing),
        dice_(seed) {
    module_->start_i = 0;
    reset();
  }

  void reset() {
    module_->rst_i = 1;
    module_->fetched_valid_i = module_->fetch_ready_i = 0;
    for (int i = 0; i < 2; ++i) module_.clock();
    module_->rst_i = 0;
    waiting_.clear();
    free_ = 0;
    read_ = false;
  }

  void start() {
    module_->start_i = 1;
    module_->first_node_i = first;
    module_->node_count_i = static_cast<IData>(nodes.size());
    step();
    module_->start_i = 0;
    cycles = free_ = asked_ = 0;
  }

  /// Runs to the end; false after a timeout.
  bool run() {
    start();
    const std::size_t most = 2000 + 200 * (nodes.size() + triangles_.size());
    while (cycles < most)
      if (step()) return waiting_.empty();
    return false;
  }

  /// Runs one cycle; returns whether it was the last.
  bool step() {
    if (read_) {
      std::copy(read_words_.begin(), read_words_.end(), &module_->node_i[0]);
    } else {
      for (unsigned w = 0; w < Node::kWords; ++w) module_->node_i[w] = noise();
    }
    module_->fetch_ready_i = ready();
    answer();
    module_.settle();
    const bool done = module_->done_o != 0;
    read_ = module_->read_o != 0;
    if (read_) {
      EXPECT_LT(module_->read_at_o, nodes.size());
      read_words_ = nodes.at(module_->read_at_o).words;
    }
    if (module_->write_o != 0) {
      std::copy_n(&module_->node_o[0], Node::kWords, nodes.at(module_->write_at_o).words.begin());
      ++writes;
    }
    if (module_->fetch_valid_o != 0 && module_->fetch_ready_i != 0)
      ask(module_->fetch_slot_o, module_->fetch_tag_o);
    module_.clock();
    ++cycles;
    return done;
  }

  [[nodiscard]] bool bad() { return module_->bad_o != 0; }
  [[nodiscard]] std::uint32_t bad_slot() { return module_->bad_slot_o; }
  [[nodiscard]] bool busy() { return module_->busy_o != 0; }

  std::vector<Node> nodes;
  unsigned first = 0;  ///< the first node that is refitted
  unsigned cycles = 0, writes = 0;
  /// Memory takes `held_from` requests, then stalls until cycle `held_to`.
  unsigned held_from = ~0u, held_to = 0;

 private:
  struct Asked {
    std::uint32_t slot, tag;
    unsigned due;
  };

  std::uint32_t noise() { return dice_.below(1u << 16) << 16 | dice_.below(1u << 16); }

  bool ready() {
    if (asked_ >= held_from && cycles < held_to) return false;
    if (timing_ != Timing::kLate) return timing_ == Timing::kAtOnce || free_ < cycles + 4;
    if (cycles < free_) return false;
    if (dice_.once_in(100)) free_ = cycles + 60 + dice_.below(200);
    return dice_.once_in(2);
  }
  void ask(std::uint32_t slot, std::uint32_t tag) {
    ++asked_;
    unsigned due = cycles + 1;
    if (timing_ == Timing::kLate) due += dice_.below(dice_.once_in(8) ? 200 : 40);
    if (timing_ == Timing::kSteady) {
      free_ = std::max(free_, cycles) + 1 + (tag & 1);
      due = free_ + 20;
    }
    waiting_.push_back({slot, tag, due});
  }
  void answer() {
    const auto it = std::find_if(waiting_.begin(), waiting_.end(),
                                 [&](const Asked& a) { return a.due <= cycles; });
    const bool valid = it != waiting_.end() && (timing_ != Timing::kLate || !dice_.once_in(4));
    module_->fetched_valid_i = valid;
    for (unsigned w = 0; w < 18; ++w) module_->fetched_i[w] = noise();
    module_->fetched_tag_i = static_cast<CData>(noise() & 0x7f);
    if (!valid) return;
    module_->fetched_tag_i = static_cast<CData>(it->tag);
    for (unsigned l = 0; l < 1 + (it->tag & 1); ++l) {
      const auto words = to_words(triangles_[order_.at(it->slot + l)]);
      for (unsigned w = 0; w < 9; ++w)
        module_->fetched_i[9 * l + w] = std::bit_cast<std::uint32_t>(words[w]);
    }
    waiting_.erase(it);
  }

  const std::vector<std::uint32_t>& order_;
  const Triangles& triangles_;
  Timing timing_;
  RefitDice dice_;
  Clocked<Module> module_;
  std::deque<Asked> waiting_;
  unsigned asked_ = 0;
  unsigned free_ = 0;  // memory is free from this cycle on
  bool read_ = false;
  std::array<std::uint32_t, Node::kWords> read_words_{};
};

void expect_same(const std::vector<Node>& nodes, const reference::Refitted& should) {
  ASSERT_EQ(nodes.size(), should.nodes.size());
  for (std::size_t n = nodes.size(); n-- > 0;)
    for (unsigned w = 0; w < Node::kWords; ++w)
      ASSERT_EQ(nodes[n].words[w], should.nodes[n].words[w]) << "node " << n << ", word " << w;
}

template <class Module>
void expect_reference(const std::vector<Node>& nodes, const std::vector<std::uint32_t>& order,
                      const Triangles& triangles, unsigned seed = 1) {
  const auto should = reference::refit(nodes, order, triangles);
  for (const Timing timing : {Timing::kSteady, Timing::kLate, Timing::kAtOnce}) {
    Bench<Module> bench(nodes, order, triangles, timing, seed);
    for (int times = 0; times < 2; ++times) {  // the second run starts from the result of the first
      ASSERT_TRUE(bench.run()) << "the refit did not end";
      ASSERT_EQ(bench.bad(), should.bad.has_value());
      if (should.bad) {
        ASSERT_EQ(bench.bad_slot(), *should.bad);
      }
      expect_same(bench.nodes, should);
      if (::testing::Test::HasFatalFailure()) return;
    }
  }
}

struct BuiltBvh {
  std::vector<Node> nodes;
  std::vector<std::uint32_t> order;
};
BuiltBvh built(const Triangles& triangles, unsigned leaf) {
  const Bvh h = Bvh::build(triangles, {.leaf = leaf});
  return {{h.nodes().begin(), h.nodes().end()}, {h.order().begin(), h.order().end()}};
}

template <class Module>
void expect_reference_of_scenes() {
  RefitDice dice(1);
  for (const RefitScene& scene : kRefitScenes) {
    SCOPED_TRACE(scene.name);
    for (const std::size_t count : {1, 2, 9, 10, 40, 700}) {
      for (const unsigned leaf : {1u, 2u}) {
        const Triangles before = scene.make(count, dice);
        const BuiltBvh bvh = built(before, leaf);
        expect_reference<Module>(bvh.nodes, bvh.order, before);
        // Moved: arbitrary other triangles in the same BVH.
        expect_reference<Module>(bvh.nodes, bvh.order, scene.make(count, dice));
        if (::testing::Test::HasFatalFailure()) return;
      }
    }
  }
}

TEST(RefitModule, Scenes_EqualTheReference) {
  expect_reference_of_scenes<Refit>();
}

TEST(RefitModule, TwoContexts_EqualTheReference) {
  expect_reference_of_scenes<RefitTwo>();
}

/// Children close behind their parents, and of any kind.
TEST(RefitModule, AnyBvh_EqualsTheReference) {
  RefitDice dice(2);
  for (unsigned i = 0; i < 400; ++i) {
    const RandomBvh bvh = random_bvh(1 + dice.below(40), dice);
    const auto which = dice.below(static_cast<unsigned>(std::size(kRefitScenes)));
    Triangles triangles = kRefitScenes[which].make(bvh.slots, dice);
    if (i % 4 == 0 && bvh.slots != 0)
      triangles[dice.below(static_cast<unsigned>(bvh.slots))].v1.z() = std::nanf("");
    std::vector<std::uint32_t> order(bvh.slots);
    std::iota(order.begin(), order.end(), 0u);
    SCOPED_TRACE(i);
    if (i % 2 == 0)
      expect_reference<Refit>(bvh.nodes, order, triangles, i);
    else
      expect_reference<RefitTwo>(bvh.nodes, order, triangles, i);
    if (::testing::Test::HasFatalFailure()) return;
  }
}

/// A refit from any node on leaves the nodes before it unchanged and takes no time for them.
TEST(RefitModule, PartialRefit_LeavesEarlierNodes) {
  RefitDice dice(3);
  for (const RefitScene& scene : kRefitScenes) {
    SCOPED_TRACE(scene.name);
    const BuiltBvh bvh = built(scene.make(300, dice), 2);
    const Triangles moved = scene.make(300, dice);
    const auto all = reference::refit(bvh.nodes, bvh.order, moved);
    for (const Timing timing : {Timing::kSteady, Timing::kLate, Timing::kAtOnce}) {
      Bench<Refit> bench(bvh.nodes, bvh.order, moved, timing);
      for (int times = 0; times < 5; ++times) {
        const auto first = dice.below(static_cast<unsigned>(bvh.nodes.size()));
        bench.nodes = bvh.nodes;
        bench.first = first;
        bench.writes = 0;
        ASSERT_TRUE(bench.run()) << "the refit did not end";
        if (all.bad) continue;
        reference::Refitted should{bvh.nodes, {}};
        std::copy(all.nodes.begin() + first, all.nodes.end(), should.nodes.begin() + first);
        expect_same(bench.nodes, should);
        EXPECT_EQ(bench.writes, bvh.nodes.size() - first);
      }
    }
  }
}

TEST(RefitModule, EmptyBvh_EqualsTheReference) {
  expect_reference<Refit>(std::vector<Node>(1), {}, {});
  const std::vector<std::uint32_t> order;
  const Triangles triangles;
  Bench<Refit> none({}, order, triangles, Timing::kSteady);  // without a root
  ASSERT_TRUE(none.run());
  EXPECT_FALSE(none.bad());
  EXPECT_EQ(none.writes, 0u);
}

TEST(RefitModule, TriangleWithoutABox_EndsTheRefit) {
  RefitDice dice(3);
  const Triangles good = kRefitScenes[1].make(300, dice);
  for (const unsigned leaf : {1u, 2u}) {
    const BuiltBvh bvh = built(good, leaf);
    for (const float x : {std::nanf(""), INFINITY, -INFINITY, 0x1.000002p40f, -0x1.000002p40f}) {
      for (int several = 0; several < 4; ++several) {
        Triangles bad = good;
        for (int k = 0; k <= 2 * several; ++k)
          bad[dice.below(300)].v0[static_cast<int>(dice.below(3))] = x;
        expect_reference<Refit>(bvh.nodes, bvh.order, bad);
        expect_reference<RefitTwo>(bvh.nodes, bvh.order, bad);
        if (::testing::Test::HasFatalFailure()) return;
      }
    }
  }
  // The module still works.
  const BuiltBvh bvh = built(good, 2);
  Triangles some = good;
  some[77].v2.x() = INFINITY;
  Bench<Refit> bench(bvh.nodes, bvh.order, some, Timing::kLate);
  ASSERT_TRUE(bench.run());
  EXPECT_TRUE(bench.bad());
  some[77] = good[77];
  ASSERT_TRUE(bench.run());
  EXPECT_FALSE(bench.bad());
  expect_same(bench.nodes, reference::refit(bvh.nodes, bvh.order, good));
}

/// At any stage of the next requests.
TEST(RefitModule, EarlyEnd_LeavesNoRequest) {
  std::vector<Node> nodes(2);
  nodes[0].set_first_node(1);
  nodes[0].set_first_slot(8);
  nodes[1].set_first_slot(0);
  for (unsigned i = 0; i < Node::kChildren; ++i) {
    nodes[0].set_child(i, i == 7 ? bvh::Child::kNode : bvh::Child::kLeafOfOne);
    nodes[1].set_child(i, bvh::Child::kLeafOfOne);
  }
  Triangles triangles(15, Triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  triangles[7].v0.x() = INFINITY;
  std::vector<std::uint32_t> order(15);
  std::iota(order.begin(), order.end(), 0u);
  Bench<Refit> bench(nodes, order, triangles, Timing::kSteady);
  bench.held_from = 8;
  for (bench.held_to = 0; bench.held_to < 120; ++bench.held_to) {
    ASSERT_TRUE(bench.run()) << bench.held_to;
    ASSERT_EQ(bench.bad_slot(), 7u);
  }
}

/// No state survives a reset during a refit.
TEST(RefitModule, Reset_ClearsAllState) {
  RefitDice dice(4);
  const Triangles triangles = kRefitScenes[1].make(200, dice);
  const BuiltBvh bvh = built(triangles, 2);
  const auto should = reference::refit(bvh.nodes, bvh.order, triangles);
  for (const Timing timing : {Timing::kSteady, Timing::kLate, Timing::kAtOnce}) {
    Bench<Refit> bench(bvh.nodes, bvh.order, triangles, timing);
    for (unsigned at = 1; at < 300; ++at) {
      bench.start();
      for (unsigned c = 0; c < at; ++c) (void)bench.step();
      bench.reset();
      EXPECT_FALSE(bench.busy());
      if (at % 7 != 0) continue;
      bench.nodes = bvh.nodes;
      ASSERT_TRUE(bench.run()) << "reset in cycle " << at;
      expect_same(bench.nodes, should);
      if (::testing::Test::HasFatalFailure()) return;
    }
  }
}

/// Arbitrary nodes, including nodes that no refit makes.
TEST(RefitModule, Nodes_HaveTheReferencesBox) {
  constexpr std::size_t kLatency = 5;
  RefitDice dice(5);
  Clocked<RefitNode> module;
  std::deque<Eigen::AlignedBox3f> should;
  for (int i = 0; i < 200'000; ++i) {
    Node node;
    const int near = dice.between(-80, 40), sign = dice.between(-1, 1);
    Eigen::Vector3f origin = dice.point();
    for (int k = 0; k < 3; ++k) {
      node.set_exponent(k, dice.once_in(2) ? near : dice.between(-80, 40));
      origin[k] = std::ldexp(
          sign == 0 ? origin[k] : std::copysign(origin[k], sign),
          dice.once_in(9) ? dice.between(-149, 40) : node.exponent(k) + dice.between(-4, 30));
      if (dice.once_in(40)) origin[k] = std::copysign(0.0f, origin[k]);
    }
    node.set_origin(origin);
    for (unsigned c = 0; c < Node::kChildren; ++c) {
      node.set_child(c, static_cast<bvh::Child>(dice.below(4)));
      const unsigned most = 1u << dice.below(9);
      for (int k = 0; k < 3; ++k)
        for (const bool upper : {false, true})
          node.set_corner(upper, c, k, static_cast<std::uint8_t>(dice.below(most)));
    }
    std::copy(node.words.begin(), node.words.end(), &module->node_i[0]);
    should.push_back(reference::box_of(node));
    module.clock();
    if (should.size() < kLatency) continue;
    const Eigen::AlignedBox3f box = should.front();
    should.pop_front();
    for (unsigned k = 0; k < 6; ++k) {
      const float x = k < 3 ? box.min()[static_cast<int>(k)] : box.max()[static_cast<int>(k - 3)];
      const auto word = std::bit_cast<std::uint32_t>(x + 0.0f);
      const std::uint32_t key = word >> 31 != 0 ? ~word : word | 0x80000000u;
      ASSERT_EQ(module->box_o[k], key) << "node " << i << ", corner " << k << ": " << x;
    }
  }
}

TEST(RefitModule, Terrain_TakesTheDocumentedCycles) {
  const Mesh mesh = make_terrain();
  Triangles triangles;
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) triangles.push_back(mesh.triangle(i));
  const BuiltBvh bvh = built(triangles, 2);
  for (Triangle& t : triangles)
    for (Eigen::Vector3f* v : {&t.v0, &t.v1, &t.v2}) v->z() += 5 * std::sin(v->x() * 0.01f);
  const auto should = reference::refit(bvh.nodes, bvh.order, triangles);
  for (const Timing timing : {Timing::kSteady, Timing::kAtOnce}) {
    Bench<Refit> bench(bvh.nodes, bvh.order, triangles, timing);
    ASSERT_TRUE(bench.run());
    expect_same(bench.nodes, should);
    EXPECT_EQ(bench.writes, bvh.nodes.size());
    EXPECT_LT(bench.cycles, 450'000u);
    std::printf("%zu triangles, %zu nodes, memory %s: %u cycles, %.3f per triangle\n",
                triangles.size(), bvh.nodes.size(),
                timing == Timing::kSteady ? "with a triangle per cycle" : "without waiting",
                bench.cycles, bench.cycles / static_cast<double>(triangles.size()));
  }
}

}  // namespace
}  // namespace cde::testing
