// SPDX-License-Identifier: Apache-2.0
// Rays against the BVH of a card. Records equal the reference and a brute-force pass,
// for all rays, memories and buses. A malformed BVH gives an error with its address and never hangs
// the card.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <memory>
#include <tuple>
#include <vector>

#include "bvh_cards.hpp"
#include "cde/card/board.hpp"
#include "cde/mesh/terrain.hpp"
#include "expect_error.hpp"

namespace cde::testing {
namespace {

using namespace hard;
using namespace through;

// ---- Records ----

class BvhCards : public ::testing::TestWithParam<Card> {};
INSTANTIATE_TEST_SUITE_P(Cards, BvhCards,
                         ::testing::Values(kFast, kGates, kSlow, kPci, kWatertight, kDdr, kLate,
                                           kCached, kCachedLate),
                         [](const auto& card) { return std::string(card.param.name); });

/// CDE_FULL=1: more than a million rays with host arithmetic, 100,000 with gates.
TEST_P(BvhCards, HardRays_EqualTheReference) {
  const BoardConfig config = GetParam().config();
  Board board = Board::open(config, GetParam().options);
  const bool gates = config.arithmetic == Arithmetic::kRtl,
             full = std::getenv("CDE_FULL") != nullptr;
  const bool slow = config.latency.add > 1 || config.node_cache != 0;
  const bool late = config.node_cache != 0 && GetParam().options.ddr_latency > 100;
  const std::size_t count = full    ? (gates ? 3'000 : 30'000)
                            : late  ? 60
                            : gates ? 100
                            : slow  ? 300
                                    : 1500;
  for (const Case& one : kScenes) {
    SCOPED_TRACE(one.name);
    const TriangleScene scene = one.make();
    const std::vector<Ray> rays = hard_rays(scene, count);
    for (const unsigned leaf : {1u, 2u}) {
      const Bvh bvh = Bvh::build(scene, {.leaf = leaf});
      board.upload(scene, bvh);
      for (const Mode mode : kModes) {
        SCOPED_TRACE(name_of(mode));
        reference::Traversal traversal(scene, bvh, config.algorithm);
        std::vector<Record> records;
        const Counters c =
            board.cast(rays, {.mode = mode, .pair = Pair::kRayTriangle, .through = Through::kBvh},
                       [&](std::span<const Record> some) {
                         records.insert(records.end(), some.begin(), some.end());
                       });
        const std::size_t hits =
            expect_same(records, expected(scene, bvh, rays, mode, config.algorithm));
        EXPECT_GT(hits, count / 20);
        EXPECT_EQ(c.records, records.size());
        EXPECT_GE(c.nodes, count * 9 / 10 * (scene.size() > 1 ? 1 : 0));
        if (mode == Mode::kNearest || mode == Mode::kFarthest) {
          for (std::uint32_t i = 0; i < rays.size(); ++i) (void)traversal.trace(rays[i], i, mode);
          expect_read(c, traversal.counts(), rays.size());
          EXPECT_LE(c.deepest, traversal.counts().deepest);
        }
      }
    }
  }
}

/// The same card's brute-force pass with several packets, modes and stencils. run() equals cast().
TEST_P(BvhCards, Modes_EqualBruteForce) {
  Board board = Board::open(GetParam().config(), GetParam().options);
  const bool gates = GetParam().config().arithmetic == Arithmetic::kRtl;
  const TriangleScene scene = kScenes[2].make();  // flat, with duplicates
  const std::vector<Ray> rays = hard_rays(scene, gates ? 40 : 600);
  board.upload(scene, Bvh::build(scene));
  Stencil stencil;
  for (std::size_t i = 0; i < stencil.size(); i += 3) stencil[i] = true;
  for (const Mode mode : kModes) {
    SCOPED_TRACE(name_of(mode));
    Query query{.mode = mode, .pair = Pair::kRayTriangle, .stencil = stencil};
    query.through = Through::kBruteForce;
    const std::vector<Record> brute_force = board.cast(rays, query);
    query.through = Through::kAuto;
    EXPECT_FALSE(board.why_not_traversable(query));
    EXPECT_GT(expect_same(board.cast(rays, query), brute_force), 10u);
    board.load(std::span(rays).first(30));
    query.through = Through::kBruteForce;
    const std::vector<Record> packet = board.run(query);
    query.through = Through::kBvh;
    Counters c;
    expect_same(board.run(query, &c), packet);
    EXPECT_EQ(c.secondaries, 0u);
    EXPECT_GT(c.nodes, 0u);
  }
}

/// A hit that lies in no box, because |T d| overflows: neither traversal nor brute force reports
/// it.
TEST_P(BvhCards, HitOutsideItsBox_IsNotReported) {
  Board board = Board::open(GetParam().config(), GetParam().options);
  const TriangleScene scene = edge_on();
  const Ray ray = beyond_numbers();
  board.upload(scene, Bvh::build(scene));
  for (const Through through : {Through::kBruteForce, Through::kBvh})
    EXPECT_FALSE(
        board.cast(std::span(&ray, 1), {.pair = Pair::kRayTriangle, .through = through})[0].f);
}

/// Rays from inside a closed mesh at its edges and vertices, near and far from the origin.
TEST(BvhWatertight, RaysInsideAClosedMesh_DoNotLeak) {
  Board board = Board::open(watertight_config());
  Draw draw(6);
  for (const Vector3f& centre : {Vector3f(0, 0, 0), Vector3f(37, -1234, 5)}) {
    const TriangleScene scene = icosphere(centre);
    std::vector<Ray> rays;
    for (int i = 0; i < 5'000; ++i) rays.push_back(from_inside(scene, centre, 1, draw));
    board.upload(scene, Bvh::build(scene));
    for (const Mode mode : {Mode::kNearest, Mode::kOccluded}) {
      const std::vector<Record> records =
          board.cast(rays, {.mode = mode, .through = Through::kBvh});
      EXPECT_EQ(std::count_if(records.begin(), records.end(), [](const Record& r) { return r.f; }),
                5'000);
    }
    const RayView some = RayView(rays).subview(0, 500);
    expect_same(board.cast(some, {.through = Through::kBvh}),
                board.cast(some, {.through = Through::kBruteForce}));
  }
}

// ---- Lifetime of a BVH: kept, dropped, refitted ----

/// A small terrain, rays towards it, and their expected records.
struct Found {
  Found(std::size_t count, Mode mode)
      : rays(hard_rays(scene, count)), should(expected(scene, bvh, rays, mode)) {}
  TriangleScene scene = kScenes[6].make();
  Bvh bvh = Bvh::build(scene);
  std::vector<Ray> rays;
  std::vector<Record> should;
};

TEST(BvhDriver, WhyNotTraversable_NamesTheReason) {
  const TriangleScene scene = kScenes[0].make();
  const Bvh bvh = Bvh::build(scene);
  Board plain = Board::open(small_config());
  expect_error(ErrorCode::kUsage, "no traversal units", [&] { plain.upload(scene, bvh); });
  EXPECT_EQ(*plain.why_not_traversable({}), "the card has no traversal units");

  Board board = Board::open(slow_config());
  const std::vector<Ray> rays = hard_rays(scene, 20);
  const Query on{.pair = Pair::kRayTriangle, .through = Through::kBvh};
  expect_error(ErrorCode::kUsage, "a BVH needs uploaded triangles", [&] { board.upload(bvh); });
  board.upload(scene);
  board.load(rays);
  expect_error(ErrorCode::kUsage, "no BVH was uploaded", [&] { (void)board.run(on); });
  expect_error(ErrorCode::kUsage, "of 1280 secondaries does not match 1279 triangles",
               [&] { board.upload(std::span(scene).first(1'279), bvh); });
  board.upload(bvh);
  EXPECT_EQ(board.why_not_traversable(on), std::nullopt);
  const auto refused = [&](const char* why, Query query) {
    SCOPED_TRACE(why);
    EXPECT_NE(board.why_not_traversable(query).value_or("").find(why), std::string::npos);
    query.through = Through::kBvh;
    expect_error(ErrorCode::kUsage, why, [&] { (void)board.cast(rays, query); });
  };
  refused("mode all", {.mode = Mode::kAll, .pair = Pair::kRayTriangle});
  refused("a range of secondaries", {.pair = Pair::kRayTriangle, .first_secondary = 3});
  refused("a range of secondaries", {.pair = Pair::kRayTriangle, .secondary_count = 3});
  board.set_objects(std::vector<Object>{{.first = 0, .count = 10}});
  refused("not over the card's objects", {.pair = Pair::kRayTriangle});
  board.move_object(0, Transform());  // no object of the BVH
  board.set_objects({});
  EXPECT_GT(expect_same(board.run(on), expected(scene, bvh, rays, Mode::kNearest)), 0u);
  board.upload(scene);
  refused("no BVH was uploaded", {.pair = Pair::kRayTriangle});
}

TEST(BvhDriver, Progress_RisesToOne) {
  Board board = Board::open(fast_config());
  const TriangleScene scene = kScenes[6].make();
  board.upload(scene, Bvh::build(scene));
  std::vector<double> shares;
  Query query{.pair = Pair::kRayTriangle, .through = Through::kBvh};
  query.progress = [&](double share) { shares.push_back(share); };
  (void)board.cast(hard_rays(scene, 20'000), query);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  ASSERT_GT(shares.size(), 3u);
  EXPECT_GT(shares[shares.size() / 2], 0.1);
  EXPECT_EQ(shares.back(), 1);
}

TEST(BvhDriver, TooLargeBvh_IsRefusedWithSizes) {
  Board board = Board::open(fast_config());
  const Mesh mesh = make_terrain({.quads_x = 100, .quads_y = 100});
  const Bvh bvh = Bvh::build(mesh);
  ASSERT_GT(bvh.nodes().size(), 1'024u);
  expect_error(
      ErrorCode::kCapacity,
      std::to_string(bvh.nodes().size()) +
          " nodes and 20000 slots does not fit this card, which has memory for 1024 and 8192",
      [&] { board.upload(mesh, bvh); });
}

TEST(BvhDriver, ImpossibleConfigurations_AreRefused) {
  const auto refused = [](const char* why, BoardConfig config) {
    expect_error(ErrorCode::kUsage, why, [&] { (void)config.parameters(); });
  };
  BoardConfig c = fast_config();
  c.traversal_units = 3;
  refused("0, 1, 2 or 4", c);
  c = fast_config();
  c.nodes = 1000;
  refused("a power of two", c);
  c = fast_config();
  c.box = false;
  refused("box rule", c);
  c = fast_config();
  c.format = FpFormat{5, 10};
  refused("by percents", c);
  c = fast_config();
  c.traversal_units = 0;
  refused("no node memory", c);
}

TEST(BvhDriver, ResetOrFailedPass_KeepsTheBvh) {
  Board board = Board::open(fast_config());
  const Found its(700, Mode::kNearest);
  board.upload(its.scene, its.bvh);
  const Query on{.through = Through::kBvh};
  expect_same(board.cast(its.rays, on), its.should);
  board.reset();
  expect_same(board.cast(its.rays, on), its.should);
  Query soon = on;
  soon.deadline_cycles = 200;
  expect_error(ErrorCode::kTimeout, "deadline of 200 cycles",
               [&] { (void)board.cast(its.rays, soon); });
  expect_same(board.cast(its.rays, on), its.should);
  expect_error(ErrorCode::kUsage, "from the sink", [&] {
    board.cast(its.rays, on,
               [](std::span<const Record>) { throw Error(ErrorCode::kUsage, "from the sink"); });
  });
  expect_same(board.cast(its.rays, on), its.should);
  auto owned = std::make_unique<Board>(std::move(board));
  expect_error(ErrorCode::kUsage, "destroyed its board", [&] {
    Board* const it = owned.get();
    it->cast(its.rays, on, [&](std::span<const Record>) { owned.reset(); });
  });
}

/// update_shapes() marks the BVH as outdated. The card refits it bit-identically to the reference,
/// or the host refits it.
TEST(BvhDriver, MovedTriangles_AreRefitted) {
  for (const Card& card : {kFast, kSlow, kDdr}) {
    SCOPED_TRACE(card.name);
    Board board = Board::open(card.config(), card.options);
    TriangleScene scene = kScenes[6].make();
    const Bvh built = Bvh::build(scene);
    const std::vector<Ray> rays = hard_rays(scene, 600);
    board.upload(scene, built);
    const Query query{.pair = Pair::kRayTriangle};
    for (int frame = 0; frame < 3; ++frame) {
      for (std::size_t i = 0; i < scene.size(); ++i)
        for (Vector3f* v : {&scene[i].v0, &scene[i].v1, &scene[i].v2})
          v->z() += 0.1f * std::sin(static_cast<float>(i + frame));
      board.update_shapes<Triangle>(0, scene);
      EXPECT_NE(board.why_not_traversable(query).value_or("").find("moved after their BVH"),
                std::string::npos);
      const std::vector<Record> brute_force = board.cast(rays, query);
      Bvh own = built;
      own.refit(scene);
      if (frame == 1) {
        board.upload(own);
      } else {
        const Counters c = board.refit();
        EXPECT_GT(c.cycles, scene.size() / 2);
        EXPECT_LT(c.cycles, 200'000u);
      }
      EXPECT_FALSE(board.why_not_traversable(query));
      Counters c;
      std::vector<Record> records;
      c = board.cast(rays, query, [&](std::span<const Record> some) {
        records.insert(records.end(), some.begin(), some.end());
      });
      EXPECT_GT(c.nodes, 0u);
      EXPECT_GT(expect_same(records, brute_force), 5u);
    }
    // A triangle without a bounding box.
    std::vector<Triangle> bad{scene[7]};
    bad[0].v1.y() = std::numeric_limits<float>::infinity();
    board.update_shapes<Triangle>(7, bad, false);
    expect_error(ErrorCode::kBadInput, "no box can contain it", [&] { (void)board.refit(); });
    EXPECT_TRUE(board.why_not_traversable(query));
    board.update_shapes<Triangle>(7, std::span(scene).subspan(7, 1));
    (void)board.refit();
    EXPECT_FALSE(board.why_not_traversable(query));
  }
}

/// 256 rays, then streams: cycles from the first ray to the last record, without the bus.
TEST(BvhDriver, Terrain_TakesTheStatedCycles) {
  BoardConfig config = fast_config();
  const Mesh mesh = make_terrain({.quads_x = 60, .quads_y = 60});
  const Bvh bvh = Bvh::build(mesh);
  Board board = Board::open(config);
  board.upload(mesh, bvh);
  const auto box = bounds(mesh);
  Draw draw(3);
  std::vector<Ray> rays;
  for (int i = 0; i < 4096; ++i) {
    const Vector3f at = box.center() + 0.5f * draw.point().cwiseProduct(box.sizes());
    rays.push_back({at, draw.point()});
  }
  Counters few, many;
  board.load(std::span(rays).first(256));
  (void)board.run({.through = Through::kBvh}, &few);
  many = board.cast(rays, {.through = Through::kBvh}, [](std::span<const Record>) {});
  std::printf("256 rays: %lu cycles; 4,096: %.2f per ray\n", few.cycles,
              static_cast<double>(many.cycles) / 4096);
  // Contexts hide each other's latency: two nodes or one leaf per cycle.
  const double nodes = static_cast<double>(many.nodes) / 2,
               leaves = static_cast<double>(many.pairs);
  EXPECT_LT(static_cast<double>(many.cycles), 1.25 * std::max(nodes, leaves) + 1000);
}

// ---- Check bits ----

/// Every bit of a node's words and of the slots. One wrong bit is corrected and counted. Two wrong
/// bits end the pass, with the address of the first word read.
TEST(BvhDriver, FlippedBitsOfNodesAndSlots_AreCorrectedOrNamed) {
  Board board = Board::open(slow_config());
  const Found its(100, Mode::kHits);
  const Query query{.mode = Mode::kHits, .pair = Pair::kRayTriangle};
  board.upload(its.scene);
  Draw draw(4);
  const auto upload_with = [&](unsigned word, std::uint32_t bits) {
    board.write_register(card::kRegNodeFlip, std::uint64_t{word} << 32 | bits);
    board.upload(its.bvh);
    board.write_register(card::kRegNodeFlip, 0);
  };
  for (unsigned word = 0; word < 20; ++word) {
    SCOPED_TRACE(word);
    const std::uint32_t bit = 1u << draw.below(32);
    upload_with(word, bit);
    Counters c;
    std::vector<Record> records;
    c = board.cast(its.rays, query, [&](std::span<const Record> some) {
      records.insert(records.end(), some.begin(), some.end());
    });
    expect_same(records, its.should);
    if (word < 18) {
      EXPECT_EQ(c.corrected_words, c.nodes);
    } else {
      EXPECT_GT(c.corrected_words, c.pairs / 4);
      EXPECT_LT(c.corrected_words, c.pairs);
    }
    upload_with(word, bit | std::rotl(bit, 7));
    expect_error(ErrorCode::kDevice,
                 word < 18 ? "node 0 has an uncorrectable error" : "has an uncorrectable error",
                 [&] { (void)board.cast(its.rays, query); });
    expect_error(ErrorCode::kDevice, "has an uncorrectable error", [&] { (void)board.refit(); });
  }
  board.upload(its.bvh);
  (void)board.refit();  // the refit writes new check bits
  Counters c;
  board.load(its.rays);
  expect_same(board.run(query, &c), its.should);
  EXPECT_EQ(c.corrected_words, 0u);
}

/// The same for triangles in DDR, as in a brute-force pass.
TEST(BvhDriver, FlippedBitsOfTriangles_AreCorrectedOrNamed) {
  Board board = Board::open(slow_config());
  const Found its(100, Mode::kNearest);
  const auto hit =
      std::find_if(its.should.begin(), its.should.end(), [](const Record& r) { return r.f; });
  ASSERT_NE(hit, its.should.end());
  board.upload(its.scene, its.bvh);
  board.load(its.rays);
  const Query query{.pair = Pair::kRayTriangle, .through = Through::kBvh};
  const std::uint64_t byte = 36ull * hit->index + 6;
  board.flip_ddr(byte, 4);
  Counters c;
  expect_same(board.run(query, &c), its.should);
  EXPECT_GT(c.corrected_words, 0u);
  board.flip_ddr(byte, 8);
  expect_error(ErrorCode::kDevice, "in secondary " + std::to_string(hit->index) + " at byte",
               [&] { (void)board.run(query); });
  board.flip_ddr(byte, 12);
  expect_same(board.run(query), its.should);
}

// ---- Malformed BVHs ----

class MalformedBvh : public ::testing::Test {
 protected:
  MalformedBvh() : board_(Board::open(fast_config())) {}
  void upload(const Bvh& bvh) {
    bvh_ = bvh;
    board_.upload(scene_, bvh_);
  }
  /// Words of a node in the format of the card.
  void write_node(std::uint32_t number, const bvh::Node& node) {
    std::array<std::uint64_t, 9> beats{};
    for (unsigned k = 0; k < 9; ++k)
      beats.at(k) = node.words.at(2 * k) | std::uint64_t{node.words.at(2 * k + 1)} << 32;
    board_.bus_write(card::kSpaceNodes, 64 * number, std::span(beats).first(8));
    board_.bus_write(card::kSpaceNodes, 64 * 1024 + 8 * number, std::span(beats).last(1));
  }
  void expect_fault(const std::string& what) {
    expect_error(ErrorCode::kDevice, what, [&] {
      (void)board_.cast(rays_, {.mode = Mode::kHits, .through = Through::kBvh});
    });
    // The card still works.
    board_.upload(bvh_);
    expect_same(board_.cast(rays_, {.through = Through::kBvh}),
                expected(scene_, bvh_, rays_, Mode::kNearest));
  }
  TriangleScene scene_ = kScenes[0].make();
  Bvh bvh_;
  std::vector<Ray> rays_ = hard_rays(scene_, 300);
  Board board_;
};

TEST_F(MalformedBvh, BadNode_EndsThePassWithItsAddress) {
  upload(Bvh::build(scene_));
  bvh::Node root = bvh_.nodes()[0];
  root.set_first_node(5'000);
  write_node(0, root);
  expect_fault("there are " + std::to_string(bvh_.nodes().size()));

  root = bvh_.nodes()[0];
  root.set_first_node(0);  // a cycle: the root is its own child
  write_node(0, root);
  expect_fault("the BVH in the card's memory is malformed");

  for (std::uint32_t n = 0; n < bvh_.nodes().size(); ++n) {
    bvh::Node node = bvh_.nodes()[n];
    node.set_first_slot(1'280);
    write_node(n, node);
  }
  expect_fault("was requested; there are 1280");

  const std::vector<std::uint64_t> far(scene_.size() / 2, std::uint64_t{5'000} << 32 | 5'000);
  board_.bus_write(card::kSpaceSlots, 0, far);
  expect_fault("has a secondary above the 1280 uploaded");
}

/// Nodes with one child each that repeat forever: the traversal pushes no level on its stack and
/// never ends.
TEST_F(MalformedBvh, EndlessNodes_EndThePass) {
  upload(Bvh::build(scene_));
  bvh::Node node = bvh_.nodes()[0];
  for (unsigned i = 0; i < 8; ++i) node.set_child(i, bvh::Child::kNone);
  node.set_child(0, bvh::Child::kNode);
  node.set_first_node(0);
  for (int axis = 0; axis < 3; ++axis) {
    node.set_corner(false, 0, axis, 0);
    node.set_corner(true, 0, axis, 255);
  }
  write_node(0, node);
  expect_fault("its traversal does not end");
}

/// Random words and random bits in all memories give an error or records within a bounded number of
/// cycles.
TEST_F(MalformedBvh, RandomWords_GiveAnErrorOrRecords) {
  upload(Bvh::build(scene_));
  Draw draw(9);
  const auto word = [&] { return static_cast<std::uint32_t>(draw.below(1ull << 32)); };
  unsigned faults = 0;
  for (int round = 0; round < 60; ++round) {
    board_.upload(bvh_);
    for (std::uint32_t n = 0; n < bvh_.nodes().size(); ++n) {
      bvh::Node node = bvh_.nodes()[n];
      if (round % 3 == 0)
        for (std::uint32_t& w : node.words) w = word();
      else if (round % 3 == 1 && draw.below(4) == 0)
        node.words.at(draw.below(18)) ^= 1u << draw.below(32);
      else if (round % 3 == 2)
        node.words.at(3 + draw.below(3)) = word();
      write_node(n, node);
    }
    const std::uint64_t before = board_.cycles();
    try {
      (void)board_.cast(
          rays_, {.mode = round % 2 == 0 ? Mode::kNearest : Mode::kAny, .through = Through::kBvh});
    } catch (const Error& e) {
      ++faults;
      EXPECT_EQ(e.code(), ErrorCode::kDevice) << e.what();
      EXPECT_NE(std::string(e.what()).find("is malformed: "), std::string::npos) << e.what();
    }
    EXPECT_LT(board_.cycles() - before, 300'000u);
    try {
      (void)board_.refit();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::kDevice) << e.what();
    }
  }
  EXPECT_GT(faults, 20u);
  board_.upload(bvh_);
  expect_same(board_.cast(rays_, {.through = Through::kBvh}),
              expected(scene_, bvh_, rays_, Mode::kNearest));
}

/// Invalid accesses to registers and memories of the BVH.
TEST_F(MalformedBvh, InvalidAccesses_AreRefused) {
  upload(Bvh::build(scene_));
  const auto refused = [&](auto access) {
    access();
    EXPECT_NE(board_.read_register(card::kRegStatus) >> card::kStatusBusError & 1, 0u);
    board_.write_register(card::kRegControl, card::kControlClear);
  };
  const std::uint64_t beat = 0;
  const auto write = [&](card::Space space, std::uint32_t at) {
    refused([&] { board_.bus_write(space, at, {&beat, 1}); });
  };
  write(card::kSpaceNodes, 1024 * 72);
  write(card::kSpaceNodes, 0xfffffff8u);
  write(card::kSpaceSlots, 1024 * 32);
  write(card::kSpaceRays, 4096 * 32);
  std::array<std::uint64_t, 1> read{};
  for (const card::Space space : {card::kSpaceNodes, card::kSpaceSlots, card::kSpaceRays})
    refused([&] { board_.bus_read(space, 0, read); });
  // More rays than were loaded, or than fit.
  board_.write_register(card::kRegRayCount, 100);
  for (const std::uint64_t rays : {std::uint64_t{101}, std::uint64_t{1} << 40})
    refused([&] { board_.write_register(card::kRegRays, rays); });
  board_.write_register(card::kRegRayCount, 10'000);
  refused([&] { board_.write_register(card::kRegRays, 4'097); });
  for (const card::Register r : {card::kRegNodes, card::kRegDeepest, card::kRegNodeFault,
                                 card::kRegNodeCaps, card::kRegNewRoot})
    refused([&] { board_.write_register(r, 1); });
  // Commands: no nodes, too many nodes, no rays, an invalid mode.
  const auto go_refused = [&] {
    board_.write_register(card::kRegControl, card::kControlGo);
    EXPECT_NE(board_.read_register(card::kRegStatus) >> card::kStatusCommandError & 1, 0u);
    board_.write_register(card::kRegControl, card::kControlClear);
  };
  board_.write_register(card::kRegSecFirst, 0);
  board_.write_register(card::kRegSecCount, scene_.size());
  board_.write_register(card::kRegCommand, card::kCommandBvh);
  board_.write_register(card::kRegNodeCount, 0), go_refused();
  board_.write_register(card::kRegNodeCount, 1025), go_refused();
  board_.write_register(card::kRegNodeCount, std::uint64_t{1} << 33), go_refused();
  board_.write_register(card::kRegNodeCount, bvh_.nodes().size());
  board_.write_register(card::kRegRayCount, 0), go_refused();
  board_.write_register(card::kRegRayCount, 1);
  for (const std::uint64_t mode : {3, 7}) {
    board_.write_register(card::kRegCommand, card::kCommandBvh | mode);
    go_refused();
  }
  board_.write_register(card::kRegCommand, std::uint64_t{card::kModeOccluded});
  go_refused();  // without the BVH
  expect_same(board_.cast(rays_, {.through = Through::kBvh}),
              expected(scene_, bvh_, rays_, Mode::kNearest));
}

/// A read directly after a write waits for it.
TEST_F(MalformedBvh, RegistersJustWritten_ReadBack) {
  for (const std::uint64_t value : {7u, 0u, 1000u})
    for (const card::Register r :
         {card::kRegNodeCount, card::kRegRayCount, card::kRegSlotCount, card::kRegNodeFirst}) {
      board_.write_register(r, value);
      EXPECT_EQ(board_.read_register(r), value) << r;
    }
}

}  // namespace
}  // namespace cde::testing
