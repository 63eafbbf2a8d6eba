// SPDX-License-Identifier: Apache-2.0
// Rays and spheres against a card's BVH over spheres. Records equal the records of the card's own
// brute-force pass and of the reference.
#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>

#include "bvh_cards.hpp"
#include "cde/reference/pipes/transform.hpp"
#include "expect_error.hpp"
#include "hard_spheres.hpp"

namespace cde::testing {
namespace {

using namespace through;
using hard::Cloud;
using hard::cloud_of;
using hard::kScenes;

/// Hard primaries. Some of them are bad input.
template <class P>
std::vector<P> hard_ones(const Cloud& cloud, std::size_t count) {
  using Draws = std::conditional_t<std::is_same_v<P, Ray>, hard::CloudRays, hard::CloudSpheres>;
  Draws draw(cloud, 9);
  std::vector<P> all;
  for (std::size_t i = 0; i < count; ++i) {
    all.push_back(draw(static_cast<unsigned>(i % Draws::kKinds)));
    if (i % 61 != 7) continue;
    if constexpr (std::is_same_v<P, Ray>)
      all.back().d.setZero();
    else
      all.back().r = i % 2 == 0 ? -1 : std::numeric_limits<float>::quiet_NaN();
  }
  return all;
}

template <class P>
Query query_of(Mode mode, Through through) {
  Query query{.mode = mode,
              .pair = std::is_same_v<P, Ray> ? Pair::kRaySphere : Pair::kSphereSphere};
  query.through = through;
  return query;
}

constexpr Mode kSphereModes[] = {Mode::kNearest, Mode::kAny, Mode::kHits, Mode::kOccluded};

/// `brute_force` adds large scenes and the card's own brute-force passes, which are slow with
/// gates.
template <class P>
void expect_all(Board& board, std::size_t count, bool brute_force) {
  std::size_t found = 0;
  for (const auto& one : kScenes) {
    SCOPED_TRACE(one.name);
    const Cloud cloud = cloud_of(one.make());
    if (cloud.size() > (brute_force ? board.capacity(Shape::kSphere) : 300)) continue;
    const Bvh bvh = Bvh::build(cloud, {.leaf = cloud.size() % 3 == 0 ? 1u : 2u});
    board.upload(cloud, bvh);
    const std::vector<P> primaries = hard_ones<P>(cloud, count);
    for (const Mode mode : std::is_same_v<P, Ray> ? std::span<const Mode>(kModes)
                                                  : std::span<const Mode>(kSphereModes)) {
      SCOPED_TRACE(name_of(mode));
      Counters c;
      const std::vector<Record> records =
          cast(board, primaries, query_of<P>(mode, Through::kBvh), &c);
      found += expect_same(records, expected(reference::Traversal(cloud, bvh), primaries, mode));
      EXPECT_EQ(c.secondaries, 0u);
      if (mode == Mode::kNearest) {
        reference::Traversal traversal(cloud, bvh);
        for (std::uint32_t i = 0; i < primaries.size(); ++i)
          (void)traversal.trace(primaries[i], i, mode);
        expect_read(c, traversal.counts(), primaries.size());
      }
      if (brute_force || cloud.size() < 100)
        expect_same(records, cast(board, primaries, query_of<P>(mode, Through::kBruteForce)));
    }
  }
  EXPECT_GT(found, 2 * count);
}

bool full() {
  return std::getenv("CDE_FULL") != nullptr;
}

const Card kSpheres{"host", spheres_config}, kSpheresGates{"gates", spheres_gates_config},
    kSpheresLate{"late", spheres_config, {.ddr_latency = 300}};

class BvhSphereCards : public ::testing::TestWithParam<Card> {};
INSTANTIATE_TEST_SUITE_P(Cards, BvhSphereCards,
                         ::testing::Values(kSpheres, kSpheresGates, kSpheresLate),
                         [](const auto& card) { return std::string(card.param.name); });

/// CDE_FULL=1: 80,000 rays and 80,000 spheres in all on the first card, 8,000 of each on the other
/// cards.
TEST_P(BvhSphereCards, RaysAndSpheres_EqualBruteForceAndReference) {
  Board board = Board::open(GetParam().config(), GetParam().options);
  const bool fast = GetParam().name == kSpheres.name, gates = GetParam().name == kSpheresGates.name;
  const std::size_t count = fast ? (full() ? 10'000 : 500) : full() ? 1000 : gates ? 30 : 60;
  expect_all<Ray>(board, count, !gates);
  expect_all<Sphere>(board, count, !gates);
}

TEST(BvhOverSpheres, MovedSpheres_AreRefitted) {
  Board board = Board::open(spheres_config());
  Cloud cloud = cloud_of(kScenes[0].make());
  Bvh bvh = Bvh::build(cloud);
  board.upload(cloud, bvh);
  hard::Draw draw(3);
  const Query query = query_of<Sphere>(Mode::kNearest, Through::kBvh);
  for (int frame = 0; frame < 3; ++frame) {
    for (Sphere& s : cloud) s.c += draw.point() * 0.1f;
    board.update_shapes<Sphere>(0, cloud);
    EXPECT_EQ(board.why_not_traversable(query),
              "secondaries were uploaded or moved after their BVH; upload a new BVH");
    bvh.refit(cloud);
    board.upload(bvh);
    const std::vector<Sphere> spheres = hard_ones<Sphere>(cloud, 300);
    expect_same(cast(board, spheres, query),
                expected(reference::Traversal(cloud, bvh), spheres, Mode::kNearest));
  }
  expect_error(ErrorCode::kUsage, "Bvh::refit()", [&] { (void)board.refit(); });
}

TEST(BvhOverSpheres, MovingObjects_EqualBruteForce) {
  Board board = Board::open(spheres_config());
  const Cloud cloud = cloud_of(kScenes[0].make());
  std::vector<Object> objects = {{.first = 0, .count = 500}, {.first = 500, .count = 780}};
  hard::Draw draw(3);
  for (int frame = 0; frame < 3; ++frame) {
    Transform& pose = objects[1].transform;
    pose.rotation = Eigen::Quaternionf(draw(-1, 1), draw(-1, 1), draw(-1, 1), draw(-1, 1))
                        .normalized()
                        .toRotationMatrix();
    pose.translation = draw.point() * 3 + Eigen::Vector3f::Constant(frame == 1 ? 1e5f : 0);
    board.upload_shapes<Sphere>(cloud);
    board.set_objects(objects);
    board.upload(bvh_of(cloud, objects));
    const Cloud moved = reference::pass_secondaries(cloud, objects).shapes;
    const Bvh bvh = Bvh::build(moved);
    const std::vector<Ray> rays = hard_ones<Ray>(moved, 300);
    const std::vector<Sphere> spheres = hard_ones<Sphere>(moved, 300);
    for (const Mode mode : kSphereModes) {
      SCOPED_TRACE(name_of(mode));
      expect_same(cast(board, rays, query_of<Ray>(mode, Through::kBvh)),
                  expected(reference::Traversal(moved, bvh), rays, mode));
      expect_same(cast(board, spheres, query_of<Sphere>(mode, Through::kBvh)),
                  expected(reference::Traversal(moved, bvh), spheres, mode));
    }
  }
}

TEST(BvhOverSpheres, WithNormals_EqualsBruteForce) {
  Board board = Board::open(spheres_config());
  const Cloud cloud = cloud_of(kScenes[5].make());
  board.upload(cloud, Bvh::build(cloud));
  const std::vector<Sphere> spheres = hard_ones<Sphere>(cloud, 400);
  for (const Mode mode : kSphereModes) {
    Query query = query_of<Sphere>(mode, Through::kBruteForce);
    query.normals = true;
    const std::vector<Record> brute_force = cast(board, spheres, query);
    query.through = Through::kBvh;
    expect_same(cast(board, spheres, query), brute_force);
  }
}

TEST(BvhOverSpheres, WhyNotTraversable_NamesTheReason) {
  Board board = Board::open(spheres_config());
  const Cloud cloud = {{{0, 0, 0}, 1}, {{3, 0, 0}, 1}};
  expect_error(ErrorCode::kUsage, "a BVH of 2 secondaries does not match 1 sphere",
               [&] { board.upload(std::span(cloud).first(1), Bvh::build(cloud)); });
  board.upload(cloud, Bvh::build(cloud));
  const auto why = [&](const Query& query) {
    return board.why_not_traversable(query).value_or("");
  };
  Query query = query_of<Ray>(Mode::kFarthest, Through::kAuto);
  EXPECT_EQ(why(query), "");
  query.mode = Mode::kAll;
  EXPECT_NE(why(query).find("mode all"), std::string::npos);
  query = query_of<Sphere>(Mode::kFarthest, Through::kAuto);
  EXPECT_NE(why(query).find("farthest"), std::string::npos);
  const TriangleScene triangles = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
  board.upload(triangles, Bvh::build(triangles));
  EXPECT_EQ(why(query_of<Ray>(Mode::kAny, Through::kAuto)), "the BVH is over triangles");
}

}  // namespace
}  // namespace cde::testing
