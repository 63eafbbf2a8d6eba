// SPDX-License-Identifier: Apache-2.0
// A card whose nodes and slots are in DDR, behind a cache: messages of the driver, how often a node
// is fetched, wrong bits and words. Tests of all cards with a BVH compare its records.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "bvh_cards.hpp"
#include "cde/card/board.hpp"
#include "cde/mesh/terrain.hpp"
#include "expect_error.hpp"
#include "has.hpp"

namespace cde::testing {
namespace {

using namespace hard;
using namespace through;

/// A BVH in the card, rays, and their records.
struct Loaded {
  explicit Loaded(const OpenOptions& options = {}) : board(Board::open(cached_config(), options)) {
    board.upload(scene, bvh);
  }
  [[nodiscard]] std::vector<Record> cast(Counters* counters = nullptr) {
    std::vector<Record> records;
    const Counters c = board.cast(rays, query, [&](std::span<const Record> some) {
      records.insert(records.end(), some.begin(), some.end());
    });
    if (counters != nullptr) *counters = c;
    return records;
  }
  void write_ddr(std::uint64_t word, std::uint32_t value, std::uint32_t next) {
    const std::uint64_t beat = value | std::uint64_t{next} << 32;
    board.bus_write(card::kSpaceDdr, static_cast<std::uint32_t>(4 * word), {&beat, 1});
  }

  TriangleScene scene = kScenes[0].make();
  Bvh bvh = Bvh::build(scene);
  std::vector<Ray> rays = hard_rays(scene, 600);
  std::vector<Record> should = expected(scene, bvh, rays, Mode::kNearest);
  Query query{.pair = Pair::kRayTriangle, .through = Through::kBvh};
  Board board;
};

TEST(BvhCache, ImpossibleConfigurations_AreRefused) {
  const auto refused = [](const char* why, auto change) {
    BoardConfig c = cached_config();
    change(c);
    expect_error(ErrorCode::kUsage, why, [&] { (void)c.parameters(); });
  };
  refused("node_cache is 33; it must be a power of two from 4 to 65536",
          [](BoardConfig& c) { c.node_cache = 33; });
  refused("node_cache is 2; it must be a power of two from 4 to 65536",
          [](BoardConfig& c) { c.node_cache = 2; });
  refused("node_ways is 1; it must be a power of two from 2 to 16",
          [](BoardConfig& c) { c.node_ways = 1; });
  refused("pinned_nodes is 2048; it must be a power of two from 16 to 1024",
          [](BoardConfig& c) { c.pinned_nodes = 2048; });
  refused("without a node cache has no node_ways", [](BoardConfig& c) { c.node_cache = 0; });
  refused("without traversal units has no node cache", [](BoardConfig& c) {
    c.traversal_units = 0;
    c.nodes = BoardConfig().nodes;
    c.node_cycles = 1;
  });
  const auto again = BoardConfig::of(cached_config().parameters());
  ASSERT_TRUE(again);
  EXPECT_EQ(again->parameters(), cached_config().parameters());
}

/// Each unit fetches a node of these passes once, or a little more often. The others are read from
/// the cache.
TEST(BvhCache, Counters_TellCachedAndFetchedNodes) {
  Loaded its;
  ASSERT_GT(its.bvh.nodes().size(), 3 * 16u);
  Counters c;
  expect_same(its.cast(&c), its.should);
  EXPECT_LT(c.fetched_nodes, c.cached_nodes);
  EXPECT_LT(c.cached_nodes, c.nodes);
  EXPECT_GT(c.fetched_nodes, its.bvh.nodes().size() - 16);
  // A pass begins with an empty cache, so the next one is the same.
  Counters again;
  expect_same(its.cast(&again), its.should);
  EXPECT_EQ(c.fetched_nodes, again.fetched_nodes);
  EXPECT_EQ(c.cached_nodes, again.cached_nodes);
  // Nodes on chip need no cache.
  const TriangleScene few(its.scene.begin(), its.scene.begin() + 50);
  const Bvh small = Bvh::build(few);
  ASSERT_LE(small.nodes().size(), 16u);
  its.board.upload(few, small);
  expect_same(its.cast(&c), expected(few, small, its.rays, Mode::kNearest));
  EXPECT_GT(c.nodes, 0u);
  EXPECT_EQ(c.cached_nodes, 0u);
  EXPECT_EQ(c.fetched_nodes, 0u);
}

TEST(BvhCache, ShapesNodesAndSlots_ShareDdr) {
  Board board = Board::open(cached_config());
  // 3,000 triangles take 108,000 of 144,000 bytes.
  const Mesh mesh = make_terrain({.quads_x = 30, .quads_y = 50});
  const Bvh bvh = Bvh::build(mesh);
  const std::size_t bytes = 72 * (bvh.nodes().size() + 1) + 2 * 4 * 3002;
  ASSERT_LE(bvh.nodes().size(), 1024u);
  ASSERT_GT(bytes, 36'000u);
  expect_error(ErrorCode::kCapacity,
               "3000 triangles of 108000 bytes and a BVH of " + std::to_string(bytes) +
                   " bytes do not fit the card's DDR, which holds 144000",
               [&] { board.upload(mesh, bvh); });
  const std::uint64_t words = board.words_uploaded();
  const Mesh fits = make_terrain({.quads_x = 30, .quads_y = 30});
  const Bvh its = Bvh::build(fits);
  board.upload(fits, its);
  EXPECT_EQ(board.words_uploaded() - words, 9 * 1800u) << "words of shapes alone are counted";
}

/// A card with a node cache does not refit, even if all nodes are on chip. The host does, and
/// uploads the result.
TEST(BvhCache, MovedTriangles_AreRefittedByTheHost) {
  Loaded its;
  for (Triangle& t : its.scene)
    for (Eigen::Vector3f* v : {&t.v0, &t.v1, &t.v2}) v->z() += 0.1f * std::sin(v->x() * 3);
  its.board.update_shapes<Triangle>(0, its.scene);
  EXPECT_FALSE(its.board.refits());
  expect_error(ErrorCode::kUsage, "has a node cache and does not refit",
               [&] { (void)its.board.refit(); });
  its.bvh.refit(its.scene);
  its.board.upload(its.bvh);
  its.should = expected(its.scene, its.bvh, its.rays, Mode::kNearest);
  EXPECT_GT(expect_same(its.cast(), its.should), 30u);
  // All nodes on chip, slots in DDR.
  TriangleScene few(its.scene.begin(), its.scene.begin() + 50);
  const Bvh built = Bvh::build(few);
  its.board.upload(few, built);
  for (Triangle& t : few) t.v1.x() += 0.25f;
  its.board.update_shapes<Triangle>(0, few);
  EXPECT_FALSE(its.board.refits());
  Bvh own = built;
  own.refit(few);
  its.board.upload(own);
  expect_same(its.cast(), expected(few, own, its.rays, Mode::kNearest));
}

/// A wrong bit in a node or slot in DDR is corrected and counted. Two are an error.
TEST(BvhCache, FlippedBits_AreCorrectedOrNamed) {
  Loaded its;
  const std::uint64_t node_base = its.board.read_register(card::kRegNodeBase),
                      slots = its.board.read_register(card::kRegSlotBase),
                      slot_base = card::kSlotBaseSlots.of(slots);
  (void)its.cast();  // writes the registers
  ASSERT_NE(its.board.read_register(card::kRegNodeBase), node_base);
  const std::uint64_t node = its.board.read_register(card::kRegNodeBase) + 18 * 20,
                      slot = card::kSlotBaseSlots.of(its.board.read_register(card::kRegSlotBase));
  EXPECT_NE(slot, slot_base);
  for (const std::uint64_t word : {node, node + 17, slot, slot + 1}) {
    SCOPED_TRACE(word);
    its.board.flip_ddr(4 * word + 1, 4);
    Counters c;
    expect_same(its.cast(&c), its.should);
    EXPECT_GT(c.corrected_words, 0u);
    its.board.flip_ddr(4 * word + 1, 8);
    expect_error(ErrorCode::kDevice, "uncorrectable", [&] { (void)its.cast(); });
    its.board.flip_ddr(4 * word + 1, 12);
    expect_same(its.cast(), its.should);
  }
  // The word behind the slots is node 0, which is pinned and was not written to DDR.
  its.board.flip_ddr(4 * (node - 18 * 20), 3);
  Counters c;
  expect_same(its.cast(&c), its.should);
  EXPECT_EQ(c.corrected_words, 0u);
}

/// Random words in the nodes of DDR give an error or records within a bounded number of cycles.
TEST(BvhCache, RandomWords_GiveAnErrorOrRecords) {
  Loaded its({.memory = Memory::kCycle});
  (void)its.cast();
  const std::uint64_t base = its.board.read_register(card::kRegNodeBase),
                      slot = card::kSlotBaseSlots.of(its.board.read_register(card::kRegSlotBase));
  Draw draw(9);
  const auto any = [&] { return static_cast<std::uint32_t>(draw.below(1ull << 32)); };
  unsigned faults = 0;
  for (int round = 0; round < 60; ++round) {
    its.board.upload(its.bvh);
    if (round % 3 == 2) {
      its.write_ddr(slot / 2 * 2 + 2 * draw.below(600), any(), any());
    } else {
      for (std::uint64_t word = 18 * 16; word < 18 * its.bvh.nodes().size(); word += 2)
        if (round % 3 == 0 || draw.below(20) == 0) its.write_ddr(base + word, any(), any());
    }
    its.query.mode = round % 2 == 0 ? Mode::kNearest : Mode::kHits;
    const std::uint64_t before = its.board.cycles();
    try {
      (void)its.cast();
    } catch (const Error& e) {
      ++faults;
      EXPECT_EQ(e.code(), ErrorCode::kDevice) << e.what();
      EXPECT_TRUE(has(e.what(), "is malformed: ")) << e.what();
    }
    EXPECT_LT(its.board.cycles() - before, 600'000u);
  }
  EXPECT_GT(faults, 20u);
  its.query.mode = Mode::kNearest;
  its.board.upload(its.bvh);
  expect_same(its.cast(), its.should);
}

/// Registers and memories that only one kind of card has, and settings beyond DDR.
TEST(BvhCache, InvalidAccesses_AreRefused) {
  Loaded its;
  (void)its.cast();
  Board plain = Board::open(fast_config());
  const auto refused = [](Board& board, auto access) {
    access(board);
    EXPECT_NE(board.read_register(card::kRegStatus) >> card::kStatusBusError & 1, 0u);
    board.write_register(card::kRegControl, card::kControlClear);
  };
  const std::uint64_t beat = 0;
  for (const card::Register r : {card::kRegNodeBase, card::kRegSlotBase})
    refused(plain, [&](Board& board) { board.write_register(r, 0); });
  refused(its.board, [&](Board& board) { board.bus_write(card::kSpaceSlots, 0, {&beat, 1}); });
  refused(its.board, [&](Board& board) {
    board.bus_write(card::kSpaceNodes, 16 * 72, {&beat, 1});
  });
  const auto go_refused = [&](card::Register r, std::uint64_t value) {
    const std::uint64_t before = its.board.read_register(r);
    its.board.write_register(r, value);
    its.board.write_register(card::kRegControl, card::kControlGo);
    EXPECT_NE(its.board.read_register(card::kRegStatus) >> card::kStatusCommandError & 1, 0u) << r;
    its.board.write_register(card::kRegControl, card::kControlClear);
    its.board.write_register(r, before);
  };
  its.board.write_register(card::kRegRayCount, 1);
  go_refused(card::kRegNodeBase, 36'000 - 17);
  go_refused(card::kRegNodeBase, ~std::uint64_t{0});
  go_refused(card::kRegSlotBase, 36'000);
  go_refused(card::kRegSlotBase, std::uint64_t{36'000} << 32);
  its.board.write_register(card::kRegCommand, card::kCommandBvh | card::kModeRefit);
  its.board.write_register(card::kRegControl, card::kControlGo);
  EXPECT_NE(its.board.read_register(card::kRegStatus) >> card::kStatusCommandError & 1, 0u);
  its.board.write_register(card::kRegControl, card::kControlClear);
  expect_same(its.cast(), its.should);
}

/// A pass that ends early leaves no fetch of a node behind.
TEST(BvhCache, PassesMayEndAtAnyTime) {
  Loaded its({.ddr_latency = 200});
  for (std::uint64_t cycles = 150; cycles < 3'000; cycles += 97) {
    its.query.deadline_cycles = cycles;
    expect_error(ErrorCode::kTimeout, "deadline", [&] { (void)its.cast(); });
  }
  its.query.deadline_cycles = 0;
  expect_same(its.cast(), its.should);
}

}  // namespace
}  // namespace cde::testing
