// SPDX-License-Identifier: Apache-2.0
// Spheres, boxes and triangles against a card's BVH over boxes. Also a BVH over spheres and over
// triangles with the roles of each pair swapped. Records equal the card's own brute-force
// pass and of the reference.
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <limits>

#include "bvh_cards.hpp"
#include "cde/reference/pipes/transform.hpp"
#include "expect_error.hpp"
#include "hard_solids.hpp"
#include "hard_spheres.hpp"

namespace cde::testing {
namespace {

using namespace through;
using hard::aabbs_of;
using hard::cloud_of;
using hard::kScenes;
using hard::obbs_of;

constexpr Mode kSolidModes[] = {Mode::kNearest, Mode::kAny, Mode::kHits, Mode::kOccluded};

/// The first count, or the second one with CDE_FULL=1.
std::size_t some(std::size_t quick, std::size_t thorough) {
  return std::getenv("CDE_FULL") != nullptr ? thorough : quick;
}

/// Hard primaries near the secondaries. Some of them are bad input.
template <class P, class Secondary>
std::vector<P> hard_ones(const std::vector<Secondary>& all, std::size_t count) {
  const TriangleScene corners = hard::corners_of(all);
  hard::Solids draws(corners, 7);
  std::vector<P> primaries;
  for (std::size_t i = 0; i < count; ++i) {
    primaries.push_back(draws.draw<P>(i));
    if (i % 61 != 7) continue;
    if constexpr (std::is_same_v<P, Sphere>)
      primaries.back().r = -1;
    else if constexpr (std::is_same_v<P, Triangle>)
      primaries.back().v1.x() = std::numeric_limits<float>::quiet_NaN();
    else if constexpr (std::is_same_v<P, Aabb>)
      std::swap(primaries.back().min, primaries.back().max);
    else
      primaries.back().rotation(1, 2) += 0.25f;
  }
  return primaries;
}

/// All modes: the card's records and counters equal the reference traversal and the card's own
/// brute-force pass.
template <class P, class Secondary>
void expect_same_as_all(Board& board, const std::vector<Secondary>& all, std::size_t count) {
  const Bvh bvh = Bvh::build(all, {.leaf = all.size() % 3 == 0 ? 1u : 2u});
  board.upload(all, bvh);
  const std::vector<P> primaries = hard_ones<P>(all, count);
  std::size_t found = 0;
  for (const Mode mode : kSolidModes) {
    SCOPED_TRACE(name_of(mode));
    Counters c;
    const auto records = cast(board, primaries, query_of<P, Secondary>(mode, Through::kBvh), &c);
    found += expect_same(records, expected(reference::Traversal(all, bvh), primaries, mode));
    EXPECT_EQ(c.secondaries, 0u);
    if (mode == Mode::kNearest) {
      reference::Traversal traversal(all, bvh);
      for (std::uint32_t i = 0; i < primaries.size(); ++i)
        (void)traversal.trace(primaries[i], i, mode);
      expect_read(c, traversal.counts(), primaries.size());
    }
    expect_same(records,
                cast(board, primaries, query_of<P, Secondary>(mode, Through::kBruteForce)));
  }
  EXPECT_GT(found, count / 2);
}

/// Calls `test` with each scene of at most `most` triangles.
template <class Test>
void in_scenes(std::size_t most, const Test& test) {
  for (const auto& one : kScenes) {
    const TriangleScene scene = one.make();
    if (scene.size() > most) continue;
    SCOPED_TRACE(one.name);
    test(scene);
  }
}

/// CDE_FULL=1: 20,000 primaries of each shape.
TEST(BvhOverBoxes, AllPrimaries_EqualBruteForceAndReference) {
  Board board = Board::open(boxes_config());
  in_scenes(2000, [&](const TriangleScene& scene) {
    const auto boxes = obbs_of(scene);
    expect_same_as_all<Sphere>(board, boxes, some(100, 2500));
    expect_same_as_all<Obb>(board, boxes, some(60, 2500));
    expect_same_as_all<Triangle>(board, aabbs_of(scene), some(60, 2500));
    expect_same_as_all<Obb>(board, cloud_of(scene), some(60, 2500));
    expect_same_as_all<Aabb>(board, scene, some(60, 2500));
  });
}

TEST(BvhOverBoxes, SpherePrimaries_EqualBruteForceAndReference) {
  Board board = Board::open(sphere_pairs_config());
  in_scenes(2000, [&](const TriangleScene& scene) {
    expect_same_as_all<Sphere>(board, obbs_of(scene), 100);
  });
}

TEST(BvhOverBoxes, SwappedRoles_EqualBruteForceAndReference) {
  Board board = Board::open(solids_config());
  in_scenes(400, [&](const TriangleScene& scene) {
    expect_same_as_all<Triangle>(board, obbs_of(scene), some(60, 2500));
    expect_same_as_all<Triangle>(board, cloud_of(scene), some(60, 2500));
    expect_same_as_all<Sphere>(board, scene, some(60, 2500));
  });
}

/// Boxes take two beats of memory and spheres take one. Check bits, slow operators.
TEST(BvhOverBoxes, InGates_EqualsBruteForceAndReference) {
  Board board = Board::open(spheres_gates_config());
  in_scenes(100, [&](const TriangleScene& scene) {
    const auto boxes = obbs_of(scene);
    expect_same_as_all<Sphere>(board, boxes, some(8, 60));
    expect_same_as_all<Obb>(board, cloud_of(scene), some(8, 60));
  });
}

/// Memory that answers late, and DDR.
TEST(BvhOverBoxes, LateOrCycleMemory_EqualsBruteForceAndReference) {
  for (const OpenOptions& options :
       {OpenOptions{.ddr_latency = 300}, OpenOptions{.memory = Memory::kCycle}}) {
    Board board = Board::open(boxes_config(), options);
    const TriangleScene scene = kScenes[2].make();
    expect_same_as_all<Sphere>(board, obbs_of(scene), 60);
    expect_same_as_all<Triangle>(board, aabbs_of(scene), 20);
  }
}

TEST(BvhOverBoxes, WithNormals_EqualsBruteForce) {
  Board board = Board::open(boxes_config());
  const auto boxes = obbs_of(kScenes[5].make());
  board.upload(boxes, Bvh::build(boxes));
  const auto compare = [&]<class P>(const std::vector<P>& primaries) {
    for (const Mode mode : kSolidModes) {
      Query query = query_of<P, Obb>(mode, Through::kBruteForce);
      query.normals = true;
      const auto brute_force = cast(board, primaries, query);
      query.through = Through::kBvh;
      expect_same(cast(board, primaries, query), brute_force);
    }
  };
  compare(hard_ones<Sphere>(boxes, 200));
  compare(hard_ones<Obb>(boxes, 60));
}

TEST(BvhOverBoxes, MovedBoxes_AreRefitted) {
  Board board = Board::open(boxes_config());
  auto boxes = obbs_of(kScenes[0].make());
  Bvh bvh = Bvh::build(boxes);
  board.upload(boxes, bvh);
  hard::Draw draw(3);
  for (int frame = 0; frame < 2; ++frame) {
    for (Obb& b : boxes) b.c += draw.point() * 0.1f;
    board.update_shapes<Obb>(0, boxes);
    bvh.refit(boxes);
    board.upload(bvh);
    const auto spheres = hard_ones<Sphere>(boxes, 100);
    expect_same(cast(board, spheres, query_of<Sphere, Obb>(Mode::kNearest, Through::kBvh)),
                expected(reference::Traversal(boxes, bvh), spheres, Mode::kNearest));
  }
  expect_error(ErrorCode::kUsage, "for obbs call Bvh::refit()", [&] { (void)board.refit(); });
}

TEST(BvhOverBoxes, MovingObjects_EqualBruteForce) {
  Board board = Board::open(boxes_config());
  const auto boxes = obbs_of(kScenes[0].make());
  const auto half = static_cast<std::uint32_t>(boxes.size() / 2);
  std::vector<Object> objects = {
      {.first = 0, .count = half},
      {.first = half, .count = static_cast<std::uint32_t>(boxes.size()) - half}};
  Transform& pose = objects[1].transform;
  pose.rotation = Eigen::Quaternionf(1, 2, 3, 4).normalized().toRotationMatrix();
  pose.translation = {1, -2, 0.5f};
  board.upload_shapes<Obb>(boxes);
  board.set_objects(objects);
  board.upload(bvh_of(boxes, objects));
  const auto moved = reference::pass_secondaries(boxes, objects).shapes;
  board.move_object(1, pose);
  EXPECT_EQ(board.why_not_traversable(query_of<Sphere, Obb>(Mode::kAny, Through::kAuto)),
            "objects or their shapes have moved after the upload of their BVH; upload a new BVH");
  board.upload(bvh_of(boxes, objects));
  const auto spheres = hard_ones<Sphere>(moved, 200);
  const auto turned = hard_ones<Obb>(moved, 60);
  for (const Mode mode : kSolidModes) {
    SCOPED_TRACE(name_of(mode));
    expect_same(cast(board, spheres, query_of<Sphere, Obb>(mode, Through::kBvh)),
                expected(reference::Traversal(moved, Bvh::build(moved)), spheres, mode));
    expect_same(cast(board, turned, query_of<Obb, Obb>(mode, Through::kBvh)),
                cast(board, turned, query_of<Obb, Obb>(mode, Through::kBruteForce)));
  }
}

/// A fault can end a pass between the two beats of a box. The next pass then reads its own boxes.
TEST(BvhOverBoxes, AbortBetweenTwoBeats_NextPassIsClean) {
  Board board = Board::open(sphere_pairs_config(), {.memory = Memory::kCycle});
  const auto boxes = obbs_of(kScenes[0].make());
  const Bvh bvh = Bvh::build(boxes);
  board.upload(boxes, bvh);
  const auto spheres = hard_ones<Sphere>(boxes, 60);
  const Query query = query_of<Sphere, Obb>(Mode::kHits, Through::kBvh);
  const auto should = expected(reference::Traversal(boxes, bvh), spheres, Mode::kHits);
  const auto write = [&](std::uint32_t number, const bvh::Node& node) {
    std::array<std::uint64_t, 8> front{};
    for (unsigned k = 0; k < 8; ++k)
      front.at(k) = node.words.at(2 * k) | std::uint64_t{node.words.at(2 * k + 1)} << 32;
    board.bus_write(card::kSpaceNodes, 64 * number, front);
  };
  unsigned faults = 0;
  for (std::uint32_t n = 0; n < std::min<std::size_t>(bvh.nodes().size(), 20); ++n) {
    bvh::Node node = bvh.nodes()[n];
    node.set_first_node(5'000);
    write(n, node);
    try {
      (void)cast(board, spheres, query);  // no primary reaches the node, or no nodes lie below it
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::kDevice);
      ++faults;
    }
    write(n, bvh.nodes()[n]);
    ASSERT_EQ(expect_same(cast(board, spheres, query), should), should.size()) << "node " << n;
  }
  EXPECT_GT(faults, 8u);
}

TEST(BvhOverBoxes, BadObjectsOrRequests_AreNamed) {
  const std::vector<Aabb> two = {{{0, 0, 0}, {1, 1, 1}}, {{2, 2, 2}, {3, 3, 3}}};
  std::vector<Object> turned = {{.first = 0, .count = 2}};
  turned[0].transform.rotation = Eigen::Quaternionf(0, 1, 0, 0).toRotationMatrix();
  expect_error(ErrorCode::kUsage, "object 0: AABBs cannot be rotated",
               [&] { (void)bvh_of(two, turned); });
  std::vector<Obb> boxes = obbs_of(kScenes[2].make());
  boxes[1].rotation(0, 1) += 0.5f;
  expect_error(ErrorCode::kBadInput, "obb 1: ", [&] { (void)Bvh::build(boxes); });
  std::vector<Aabb> along = aabbs_of(kScenes[2].make());
  along[2].max.x() = along[2].min.x();
  expect_error(ErrorCode::kBadInput, "aabb 2: ", [&] { (void)Bvh::build(along); });
  along[2].max.x() = 0x1p41f;
  expect_error(ErrorCode::kBadInput, "2^40", [&] { (void)Bvh::build(along); });

  Board board = Board::open(boxes_config());
  boxes[1] = boxes[0];
  board.upload(boxes, Bvh::build(boxes));
  const auto why = [&](const Query& query) {
    return board.why_not_traversable(query).value_or("");
  };
  EXPECT_EQ(why(query_of<Sphere, Obb>(Mode::kNearest, Through::kAuto)), "");
  EXPECT_EQ(why(query_of<Triangle, Aabb>(Mode::kNearest, Through::kAuto)), "the BVH is over obbs");
  EXPECT_EQ(why(query_of<Triangle, Obb>(Mode::kNearest, Through::kAuto)),
            "the card has no pipe for triangle-obb");
  Query query = query_of<Obb, Obb>(Mode::kNearest, Through::kAuto);
  query.swap = true;
  EXPECT_EQ(why(query), "obb-obb with its roles swapped cannot traverse a BVH");
}

}  // namespace
}  // namespace cde::testing
