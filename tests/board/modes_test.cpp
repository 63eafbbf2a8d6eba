// SPDX-License-Identifier: Apache-2.0
// Casts end to end: result modes, stencils, packet sizes, cycles, and refusals of the driver.
#include <fmt/format.h>
#include <ostream>

#include "../expect_error.hpp"
#include "cases.hpp"

namespace cde::testing {
namespace {

struct Kind {
  const char* name;
  BoardConfig (*config)();

  friend void PrintTo(const Kind& k, std::ostream* out) { *out << k.name; }
};
const auto kKindName = [](const auto& info) { return info.param.name; };

class Modes : public ::testing::TestWithParam<Kind> {};

TEST_P(Modes, EveryMode_EqualsTheReference) {
  Board board = Board::open(GetParam().config());
  Random random;
  const RayScene scene = cloud(random, 300, 400);
  for (const Mode mode : {Mode::kNearest, Mode::kFarthest, Mode::kAny, Mode::kAll, Mode::kHits}) {
    SCOPED_TRACE(name_of(mode));
    Counters counters;
    const auto records = cast_and_compare(board, scene, {.mode = mode}, &counters);
    EXPECT_EQ(counters.records, records.size());
    std::size_t hits = 0;
    for (const Record& r : records) hits += r.f ? 1 : 0;
    EXPECT_GT(hits, 50u);
    if (mode != Mode::kHits) {
      EXPECT_LT(hits, records.size());
    }
  }
}

TEST_P(Modes, EveryPacketSize_EqualsTheReference) {
  Board board = Board::open(GetParam().config());
  Random random;
  const RayScene all = cloud(random, 256, 20);
  for (std::size_t n = 1; n <= 256; n += n < 40 || n > 250 ? 1 : 13) {
    SCOPED_TRACE(n);
    RayScene scene = all;
    scene.rays.resize(n);
    EXPECT_EQ(cast_and_compare(board, scene, {}).size(), n);
    EXPECT_EQ(cast_and_compare(board, scene, {.mode = Mode::kAll}).size(), n * 20);
  }
}

TEST_P(Modes, StencilMasks_ApplyInEveryMode) {
  Board board = Board::open(GetParam().config());
  Random random;
  const RayScene scene = cloud(random, 200, 60);
  Stencil scattered, halves, all;
  for (std::size_t i = 0; i < 256; ++i) scattered[i] = random.below(3) == 0, halves[i] = i < 128;
  all.set();
  for (const Stencil& stencil : {scattered, halves, all, ~scattered}) {
    for (const Mode mode : {Mode::kNearest, Mode::kFarthest, Mode::kAny, Mode::kAll, Mode::kHits}) {
      SCOPED_TRACE(fmt::format("{} {}", name_of(mode), stencil.count()));
      const auto records = cast_and_compare(board, scene, {.mode = mode, .stencil = stencil});
      for (const Record& r : records) ASSERT_FALSE(stencil[r.primary]);
      if (stencil.all()) {
        EXPECT_TRUE(records.empty());
      }
    }
  }
}

TEST_P(Modes, BadRaysAndTriangles_AreFlaggedAndCounted) {
  Board board = Board::open(GetParam().config());
  Random random;
  RayScene scene = beam(random, 100, 50);
  scene.rays[3].o.x() = std::numeric_limits<float>::quiet_NaN();
  scene.rays[99].d.setZero();
  scene.triangles[0].v1.z() = std::numeric_limits<float>::infinity();
  scene.triangles[49].v2.x() = -std::numeric_limits<float>::quiet_NaN();
  scene.triangles[20].v0.y() = std::numeric_limits<float>::quiet_NaN();
  Counters counters;
  const auto nearest = cast_and_compare(board, scene, {}, &counters);
  EXPECT_EQ(counters.bad_primaries, 2u);
  EXPECT_EQ(counters.bad_secondaries, 3u);
  for (const Record& r : nearest) EXPECT_EQ(r.bad, r.primary == 3 || r.primary == 99) << r.primary;
  std::size_t bad = 0;
  for (const Record& r : cast_and_compare(board, scene, {.mode = Mode::kAll})) bad += r.bad ? 1 : 0;
  EXPECT_EQ(bad, 2u * 50 + 3u * 100 - 6);
}

TEST_P(Modes, FullRows_LoseNoCycle) {
  Board board = Board::open(GetParam().config());
  Random random;
  const RayScene scene = cloud(random, 256, 1000);
  Counters c;
  cast_and_compare(board, scene, {}, &c);
  const std::uint64_t rows = 1000 * 256 / board.lanes();
  EXPECT_EQ(c.rows, rows);
  EXPECT_EQ(c.secondaries, 1000u);
  EXPECT_EQ(c.stalls, 0u);
  EXPECT_LE(c.bubbles, 20u) << "more idle cycles than the latency of the first memory read";
  EXPECT_LE(c.cycles, rows + 200);
  EXPECT_GE(c.writeback, 256u);
  // A ring with fewer records than rays makes the card wait for the host.
  if (board.sram_records() > 256) {
    EXPECT_LE(c.writeback, 256u + 16);
  }
  EXPECT_DOUBLE_EQ(c.modelled_seconds(1e8), static_cast<double>(c.cycles + c.writeback) * 1e-8);
}

TEST_P(Modes, AnyMode_EndsEarly) {
  Board board = Board::open(GetParam().config());
  RayScene scene;
  for (int i = 0; i < 10; ++i)
    scene.rays.push_back({.o = {0.1f, 0.1f, static_cast<float>(-i)}, .d = {0, 0, 1}});
  const Triangle far{{5, 5, 1}, {6, 5, 1}, {5, 6, 1}};
  scene.triangles.assign(900, far);
  scene.triangles[40] = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  Counters c;
  for (const Record& r : cast_and_compare(board, scene, {.mode = Mode::kAny}, &c))
    EXPECT_EQ(r.index, 40u);
  EXPECT_LT(c.secondaries, 200u);
}

INSTANTIATE_TEST_SUITE_P(Boards, Modes,
                         ::testing::Values(Kind{"Host", host_config}, Kind{"Rtl", rtl_config},
                                           Kind{"SmallAndSlow", small_config}),
                         kKindName);

TEST(Driver, InvalidRequests_AreRefused) {
  Board board = Board::open(small_config());
  Random random;
  const RayScene scene = beam(random, 4, 1001);
  expect_error(ErrorCode::kUsage, "no secondaries", [&] { (void)board.run({}); });
  expect_error(ErrorCode::kUsage, "no triangles",
               [&] { board.upload(std::span<const Triangle>()); });
  expect_error(ErrorCode::kCapacity, "1001 triangles do not fit the card's DDR, which holds 1000",
               [&] { board.upload(scene.triangles); });
  std::vector<Triangle> some(scene.triangles.begin(), scene.triangles.begin() + 100);
  some[77].v1.y() = std::numeric_limits<float>::quiet_NaN();
  expect_error(ErrorCode::kBadInput, "triangle 77: v1.y", [&] { board.upload(some); });
  board.upload(std::span(scene.triangles).first(1000));
  expect_error(ErrorCode::kUsage, "no primaries", [&] { (void)board.run({}); });
  expect_error(ErrorCode::kUsage, "1 to 256 rays, not 0", [&] { board.load({}); });
  expect_error(ErrorCode::kUsage, "1 to 256 rays, not 257",
               [&] { board.load(std::vector<Ray>(257, scene.rays[0])); });
  expect_error(ErrorCode::kUsage, "lanes is 3", [] { (void)Board::open({.lanes = 3}); });
  expect_error(ErrorCode::kUsage, "latency.div is 0",
               [] { (void)Board::open({.latency = {.div = 0}}); });
  expect_error(ErrorCode::kUsage, "latency.sqrt is 65; it must be 1 to 64 cycles",
               [] { (void)Board::open({.latency = {.sqrt = 65}}); });
  expect_error(ErrorCode::kUsage, "sram_records is 100",
               [] { (void)Board::open({.sram_records = 100}); });
  expect_error(ErrorCode::kUsage, "ddr_latency is 0",
               [] { (void)Board::open(small_config(), {.ddr_latency = 0}); });
  expect_error(ErrorCode::kUsage, "cannot write waves", [&] { board.trace_open("/tmp/x.fst"); });
  // The board still works.
  RayScene good{scene.rays, {scene.triangles.begin(), scene.triangles.begin() + 1000}};
  EXPECT_EQ(cast_and_compare(board, good, {}).size(), 4u);
  board.reset();
  expect_error(ErrorCode::kUsage, "no primaries", [&] { (void)board.run({}); });
  board.load(good.rays);
  EXPECT_EQ(board.run(Query{}).size(), 4u) << "a reset keeps the triangles";
}

TEST(Driver, FewerRaysAfterMore_GiveCorrectRecords) {
  Board board = Board::open(host_config());
  Random random;
  for (const std::size_t n : {256u, 3u, 200u, 17u, 1u, 256u})
    EXPECT_EQ(cast_and_compare(board, cloud(random, n, 30), {}).size(), n);
}

TEST(Driver, SlowMemory_ChangesOnlyTime) {
  Random random;
  const RayScene scene = cloud(random, 256, 300);
  std::uint64_t before = 0;
  for (const std::uint32_t latency : {1u, 20u, 60u, 500u}) {
    Board board = Board::open(host_config(), {.ddr_latency = latency});
    Counters c;
    cast_and_compare(board, scene, {}, &c);
    EXPECT_GE(c.cycles, before);
    before = c.cycles;
  }
}

TEST(Driver, FlippedDdrBit_IsFound) {
  Board board = Board::open(host_config());
  Random random;
  const RayScene scene = beam(random, 64, 40);
  board.upload(scene.triangles);
  board.flip_ddr(36 * 17 + 3, 0x40);  // an exponent bit of triangle 17
  reference::Checker checker(scene.rays, scene.triangles, Mode::kAll, {}, 256, "cde cast");
  try {
    board.cast(scene.rays, {.mode = Mode::kAll},
               [&](std::span<const Record> some) { checker.check(some); });
    FAIL() << "the flipped bit was not found";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::kMismatch);
  }
}

}  // namespace
}  // namespace cde::testing
