// SPDX-License-Identifier: Apache-2.0
// Which record of a primary is kept, where one detail decides: consecutive hits, equal T, and zero
// T of either sign.
#include <algorithm>
#include <cmath>

#include "cases.hpp"
#include "moving_cases.hpp"

namespace cde::testing {
namespace {

/// One ray per column, 4 apart, and a triangle across one column.
Ray ray_in(std::size_t column) {
  return {.o = {4 * static_cast<float>(column) + 0.25f, 0.25f, 0}, .d = {0, 0, 1}};
}
Triangle triangle_in(std::size_t column, float z = 1) {
  const float x = 4 * static_cast<float>(column);
  return {{x, 0, z}, {x + 1, 0, z}, {x, 1, z}};
}

/// Each ray hits its own triangle in turn, and one ray hits only the last triangle. The pass goes
/// on while any ray has no hit, for every ray and row.
TEST(Reduction, AnyMode_ContinuesUntilEveryRayHits) {
  Board board = Board::open(small_config());
  constexpr std::size_t kRays = 11, kBetween = 400;
  for (std::size_t last = 0; last < kRays; ++last) {
    SCOPED_TRACE(last);
    RayScene scene;
    for (std::size_t i = 0; i < kRays; ++i) scene.rays.push_back(ray_in(i));
    for (std::size_t i = 0; i < kRays; ++i)
      if (i != last) scene.triangles.push_back(triangle_in(i));
    // More triangles than are in flight once the other rays have hit.
    scene.triangles.insert(scene.triangles.end(), kBetween, triangle_in(kRays));
    scene.triangles.push_back(triangle_in(last));
    scene.triangles.insert(scene.triangles.end(), kBetween, triangle_in(kRays));
    Counters counters;
    const auto records = cast_and_compare(board, scene, {.mode = Mode::kAny}, &counters);
    for (const Record& r : records) EXPECT_TRUE(r.f) << r.primary;
    EXPECT_EQ(records.at(last).index, kRays - 1 + kBetween);
    EXPECT_LT(counters.secondaries, scene.triangles.size())
        << "the pass must end once every ray has a hit";
  }
}

/// The pass does not wait for masked rays, and their hits do not count for other rays.
TEST(Reduction, AnyMode_CountsOnlyActiveRays) {
  Board board = Board::open(small_config());
  RayScene scene;
  Stencil masked;
  for (std::size_t i = 0; i < 10; ++i) {
    scene.rays.push_back(ray_in(i));
    masked[i] = i % 2 == 0;
  }
  for (std::size_t i = 0; i < 9; ++i) scene.triangles.push_back(triangle_in(i));
  scene.triangles.insert(scene.triangles.end(), 400, triangle_in(20));
  scene.triangles.push_back(triangle_in(9));
  scene.triangles.insert(scene.triangles.end(), 400, triangle_in(20));
  Counters counters;
  const Query query{.mode = Mode::kAny, .stencil = masked};
  const auto records = cast_and_compare(board, scene, query, &counters);
  ASSERT_EQ(records.size(), 5u);
  EXPECT_EQ(records.back().index, 409u);
  EXPECT_LT(counters.secondaries, scene.triangles.size());
}

/// The same triangle several times, among nearer and farther ones: the first equal one is kept.
TEST(Reduction, EqualT_KeepsTheLowestIndex) {
  Board board = Board::open(small_config());
  for (const Mode mode : {Mode::kNearest, Mode::kFarthest}) {
    SCOPED_TRACE(name_of(mode));
    const float extreme = mode == Mode::kNearest ? 1.0f : 3.0f;
    for (const unsigned first : {0u, 1u, 5u})
      for (const unsigned apart : {1u, 2u, 7u}) {
        RayScene scene;
        for (std::size_t i = 0; i < 9; ++i) scene.rays.push_back(ray_in(i));
        for (std::size_t slot = 0; slot < 30; ++slot) {
          const bool tied = slot >= first && (slot - first) % apart == 0;
          for (std::size_t i = 0; i < 9; ++i)
            scene.triangles.push_back(triangle_in(i, tied ? extreme : 2));
        }
        for (const Record& r : cast_and_compare(board, scene, {.mode = mode})) {
          EXPECT_EQ(r.t, extreme);
          EXPECT_EQ(r.index, 9 * first + r.primary);
        }
      }
  }
}

/// A brute-force pass follows the object table, so a later object can have the lower index.
TEST(Reduction, EqualTInAnyOrder_KeepsTheLowestIndex) {
  Board board = Board::open(config_of(kMany));
  const std::vector<Triangle> equal(40, triangle_in(0));
  std::vector<Ray> rays(9, ray_in(0));
  rays[4] = ray_in(1);
  board.upload(equal);
  board.load(rays);
  for (const auto& [objects, lowest] :
       {std::pair{std::vector<Object>{{.first = 30, .count = 10}, {.first = 3, .count = 10}}, 3u},
        {std::vector<Object>{{.first = 3, .count = 10}, {.first = 30, .count = 10}}, 3u},
        {std::vector<Object>{{.first = 9, .count = 1},
                             {.first = 8, .count = 1},
                             {.first = 7, .count = 1},
                             {.first = 8, .count = 1}},
         7u}}) {
    board.set_objects(objects);
    for (const Mode mode : {Mode::kNearest, Mode::kFarthest}) {
      for (const Record& r : board.run({.mode = mode, .pair = Pair::kRayTriangle})) {
        EXPECT_EQ(r.f, r.primary != 4);
        EXPECT_EQ(r.index, r.primary != 4 ? lowest : ~0u) << name_of(mode);
      }
    }
  }
}

/// Rays that start in the planes of triangles, seen from both sides: T is zero. Zeros of both signs
/// tie.
TEST(Reduction, ZerosOfBothSigns_Tie) {
  Board board = Board::open(small_config());
  RayScene scene;
  for (const float dz : {1.0f, -1.0f, 0.5f})
    for (int i = 0; i < 5; ++i)
      scene.rays.push_back({.o = {0.25f, 0.25f, 1}, .d = {0.125f * static_cast<float>(i), 0, dz}});
  const Triangle front = triangle_in(0), back{front.v0, front.v2, front.v1};
  for (const bool begin : {false, true}) {
    scene.triangles.clear();
    for (int i = 0; i < 6; ++i) scene.triangles.push_back((i % 2 != 0) == begin ? front : back);
    for (const Record& r : cast_and_compare(board, scene, {.mode = Mode::kAll})) {
      ASSERT_TRUE(r.f && r.t == 0);
      EXPECT_FALSE(std::signbit(r.t)) << "ray " << r.primary;
    }
    for (const Mode mode : {Mode::kNearest, Mode::kFarthest})
      for (const Record& r : cast_and_compare(board, scene, {.mode = mode}))
        EXPECT_EQ(r.index, 0u) << name_of(mode) << ", ray " << r.primary;
  }
}

/// Spheres that touch have the signed distance -0: below any positive distance, above any negative
/// one.
TEST(Reduction, TouchingSpheres_RankBetweenApartAndDeep) {
  BoardConfig config;
  config.lanes = 8;
  config.ddr_slots = 1000;
  config.sram_records = 64;
  config.pairs = {Pair::kSphereSphere};
  config.swap = config.normals = true;
  Board board = Board::open(config);
  const auto at = [](float x) { return Sphere{{x, 0, 0}, 1}; };
  const std::vector<Sphere> one{at(0)};
  board.load_shapes(std::span<const Sphere>(one));
  constexpr float kDeep = 1.5f, kTouching = 2, kApart = 2.5f;
  std::vector<float> order{kDeep, kTouching, kApart};
  do {
    std::vector<Sphere> many;
    for (const float x : order) many.push_back(at(x));
    board.upload_shapes(std::span<const Sphere>(many));
    const auto kept = [&](Mode mode) { return order.at(board.run({.mode = mode}).at(0).index); };
    EXPECT_EQ(kept(Mode::kNearest), kDeep);
    EXPECT_EQ(kept(Mode::kFarthest), kApart);
    for (const float without : {kDeep, kApart}) {
      many.clear();
      std::vector<float> two;
      for (const float x : order)
        if (x != without) many.push_back(at(x)), two.push_back(x);
      board.upload_shapes(std::span<const Sphere>(many));
      const auto records = board.run({.mode = without == kDeep ? Mode::kNearest : Mode::kFarthest});
      EXPECT_EQ(two.at(records.at(0).index), kTouching);
      EXPECT_TRUE(records[0].f);
      EXPECT_EQ(records[0].t, 0);
    }
  } while (std::next_permutation(order.begin(), order.end()));
}

}  // namespace
}  // namespace cde::testing
