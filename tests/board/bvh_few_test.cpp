// SPDX-License-Identifier: Apache-2.0
// Passes with few primaries, which go on while their leaves are tested (bvh_pkg::AHEAD).
// Records equal the reference and the card's own brute-force pass, however late memory
// answers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "bvh_cards.hpp"
#include "cde/support/error.hpp"
#include "hard_solids.hpp"
#include "hard_spheres.hpp"

namespace cde::testing {
namespace {

using namespace through;
using hard::aabbs_of;
using hard::cloud_of;
using hard::kScenes;
using hard::obbs_of;

constexpr std::size_t kFew = 16;

template <class P, class Secondary>
std::vector<P> hard_few(const std::vector<Secondary>& all, std::size_t count) {
  const TriangleScene corners = hard::corners_of(all);
  if constexpr (std::is_same_v<P, Ray>) {
    return hard_rays(corners, count);
  } else {
    hard::Solids draws(corners, 7);
    std::vector<P> primaries;
    for (std::size_t i = 0; i < count; ++i) primaries.push_back(draws.draw<P>(i));
    return primaries;
  }
}

/// Passes of 1 to 17 primaries, `count` in all, or ten times as many with CDE_FULL=1. The last
/// primaries wait for their leaves.
template <class P, class Secondary>
void expect_few(Board& board, const std::vector<Secondary>& all, std::size_t count,
                [[maybe_unused]] Algorithm algorithm = Algorithm::kMoller) {
  if (std::getenv("CDE_FULL") != nullptr) count *= 10;
  const Bvh bvh = Bvh::build(all, {.leaf = all.size() % 3 == 0 ? 1u : 2u});
  board.upload(all, bvh);
  const auto fresh = [&] {
    if constexpr (std::is_same_v<Secondary, Triangle>)
      return reference::Traversal(all, bvh, algorithm);
    else
      return reference::Traversal(all, bvh);
  }();
  const std::vector<P> primaries = hard_few<P>(all, count);
  std::size_t found = 0;
  for (const Mode mode : kModes) {
    if (mode == Mode::kFarthest && !std::is_same_v<P, Ray>) continue;  // no solid is farthest
    SCOPED_TRACE(name_of(mode));
    for (std::size_t first = 0, n = 1; first < count; first += n, n = n % (kFew + 1) + 1) {
      n = std::min(n, count - first);
      const auto begin = primaries.begin() + static_cast<std::ptrdiff_t>(first);
      const std::vector<P> some(begin, begin + static_cast<std::ptrdiff_t>(n));
      Counters c;
      const auto records = cast(board, some, query_of<P, Secondary>(mode, Through::kBvh), &c);
      found += expect_same(records, expected(fresh, some, mode));
      if (n == 1 && mode != Mode::kOccluded)
        expect_same(records, cast(board, some, query_of<P, Secondary>(mode, Through::kBruteForce)));
      if (mode != Mode::kNearest) continue;
      reference::Traversal traversal = fresh;
      for (std::uint32_t i = 0; i < n; ++i) (void)traversal.trace(some[i], i, mode);
      expect_read(c, traversal.counts(), n);
    }
  }
  EXPECT_GT(found, count / 4);
}

class BvhSmallBatchCards : public ::testing::TestWithParam<Card> {};
const Card kFewSolids{"solids", solids_config}, kFewMeshes{"meshes", meshes_config},
    kFewSpheres{"spheres", spheres_config}, kFewBoxes{"boxes", boxes_config},
    kFewBoxesDdr{"boxes_ddr", boxes_config, {.memory = Memory::kCycle}},
    kFewSpheresGates{"spheres_gates", spheres_gates_config};
INSTANTIATE_TEST_SUITE_P(Cards, BvhSmallBatchCards,
                         ::testing::Values(kFast, kDdr, kGates, kLate, kWatertight, kFewSolids,
                                           kFewMeshes, kFewSpheres, kFewBoxes, kFewBoxesDdr,
                                           kFewSpheresGates, kCached),
                         [](const auto& card) { return std::string(card.param.name); });

TEST_P(BvhSmallBatchCards, PassesOfFewPrimaries_EqualReferenceAndBruteForce) {
  const BoardConfig config = GetParam().config();
  const bool gates = config.arithmetic == Arithmetic::kRtl;
  const std::size_t count = gates ? 8 : GetParam().name == kLate.name ? 30 : 80;
  Board board = Board::open(config, GetParam().options);
  const auto has = [&](Pair pair) {
    return std::find(config.pairs.begin(), config.pairs.end(), pair) != config.pairs.end();
  };
  for (const auto& one : kScenes) {
    const TriangleScene scene = one.make();
    if (scene.size() > (gates ? 100 : 2000)) continue;
    SCOPED_TRACE(one.name);
    if (has(Pair::kRayTriangle)) expect_few<Ray>(board, scene, count, config.algorithm);
    if (has(Pair::kTriangleTriangle)) expect_few<Triangle>(board, scene, count);
    if (has(Pair::kTriangleSphere)) expect_few<Sphere>(board, scene, count);
    if (has(Pair::kTriangleObb)) expect_few<Obb>(board, scene, count);
    if (has(Pair::kTriangleAabb)) expect_few<Triangle>(board, aabbs_of(scene), count);
    if (has(Pair::kObbObb)) expect_few<Obb>(board, obbs_of(scene), count);
    if (has(Pair::kSphereObb)) expect_few<Sphere>(board, obbs_of(scene), count);
    if (has(Pair::kRaySphere)) expect_few<Ray>(board, cloud_of(scene), count);
    if (has(Pair::kSphereSphere)) expect_few<Sphere>(board, cloud_of(scene), count);
  }
}

/// A pass is aborted while its leaves are outstanding: the next pass does not see them.
TEST(BvhSmallBatch, AbortWithOutstandingLeaves_NextPassIsClean) {
  Board board = Board::open(boxes_config(), {.memory = Memory::kCycle});
  const auto boxes = obbs_of(kScenes[6].make());
  const Bvh bvh = Bvh::build(boxes);
  board.upload(boxes, bvh);
  const auto primaries = hard_few<Obb>(boxes, 3);
  Query query = query_of<Obb, Obb>(Mode::kHits, Through::kBvh);
  const auto should = expected(reference::Traversal(boxes, bvh), primaries, Mode::kHits);
  ASSERT_FALSE(should.empty());
  unsigned left = 0;
  for (std::uint64_t cycles = 20; cycles < 900; cycles += 11) {
    query.deadline_cycles = cycles;
    try {
      (void)cast(board, primaries, query);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::kTimeout);
      ++left;
    }
    query.deadline_cycles = 0;
    ASSERT_EQ(expect_same(cast(board, primaries, query), should), should.size()) << cycles;
  }
  EXPECT_GT(left, 20u);
}

/// Abort in any cycle, including the cycle of a leaf request: no memory response reaches the next
/// pass, by BVH or brute force.
TEST(BvhSmallBatch, AbortAtAnyCycle_NextPassIsClean) {
  Board board = Board::open(spheres_config(), {.memory = Memory::kCycle});
  const auto cloud = cloud_of(kScenes[6].make());
  board.upload(cloud, Bvh::build(cloud));
  Query through = query_of<Sphere, Sphere>(Mode::kNearest, Through::kBvh);
  const Query brute_force = query_of<Sphere, Sphere>(Mode::kNearest, Through::kBruteForce);
  const std::vector<Sphere> three(cloud.begin(), cloud.begin() + 3);
  const auto should = cast(board, three, brute_force);
  hard::Draw draw(3);
  unsigned left = 0;
  for (unsigned i = 0; i < 3000; ++i) {
    through.deadline_cycles = 1 + draw.below(300);
    const auto first = cloud.begin() + draw.below(cloud.size() - 16);
    const std::vector<Sphere> some(first, first + 1 + draw.below(16));
    try {
      (void)cast(board, some, through);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::kTimeout);
      ++left;
    }
    through.deadline_cycles = 100'000;
    const auto records = cast(board, three, i % 2 == 0 ? brute_force : through);
    ASSERT_TRUE(std::ranges::equal(records, should, same_bits)) << i;
  }
  EXPECT_GT(left, 500u);
}

}  // namespace
}  // namespace cde::testing
