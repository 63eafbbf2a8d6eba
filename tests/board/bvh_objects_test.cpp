// SPDX-License-Identifier: Apache-2.0
// Rays against a BVH over moving objects. Records equal a brute-force pass, and the
// reference over the moved triangles.
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <limits>

#include "bvh_cards.hpp"
#include "cde/reference/pipes/transform.hpp"
#include "expect_error.hpp"

namespace cde::testing {
namespace {

using namespace through;
using Eigen::Vector3f;
using hard::kScenes;

const Card kObjectsDdr{"objects_ddr", objects_config, {.memory = Memory::kCycle}};

Transform pose(hard::Draw& draw, float size, float far) {
  Transform t;
  t.rotation = Eigen::Quaternionf(draw(-1, 1), draw(-1, 1), draw(-1, 1), draw(-1, 1))
                   .normalized()
                   .toRotationMatrix();
  t.translation = draw.point() * size + Vector3f::Constant(far);
  return t;
}

/// Ranges of triangles that move. Some triangles between the ranges belong to no object.
struct Moving {
  Moving(TriangleScene all, std::uint32_t count, float far = 0) : scene(std::move(all)), far(far) {
    const auto each = static_cast<std::uint32_t>(scene.size()) / count;
    for (std::uint32_t k = 0; k < count; ++k)
      objects.push_back({k * each + (k % 3 == 1 ? 1 : 0), each - 1, {}});
    for (std::size_t k = 0; k < objects.size(); ++k) move(k);
  }
  void move(std::size_t k) { objects[k].transform = pose(draw, 1.5f, far); }

  /// The moved triangles in the order of a pass, and the secondary number of each.
  [[nodiscard]] reference::PassSecondaries<Triangle> pass_secondaries() const {
    return reference::pass_secondaries(scene, objects);
  }
  [[nodiscard]] Bvh bvh() const { return bvh_of(scene, objects); }
  [[nodiscard]] std::vector<Record> expected(const std::vector<Ray>& rays, Mode mode) const {
    const auto all = pass_secondaries();
    std::vector<Record> records = through::expected(all.shapes, Bvh::build(all.shapes), rays, mode);
    for (Record& r : records)
      if (r.f && mode != Mode::kOccluded) r.index = all.slots[r.index];
    return records;
  }

  TriangleScene scene;
  float far;
  std::vector<Object> objects;
  hard::Draw draw{11};
};

class BvhObjectCards : public ::testing::TestWithParam<Card> {};
INSTANTIATE_TEST_SUITE_P(Cards, BvhObjectCards,
                         ::testing::Values(kObjects, kObjectsDdr, kGates, kSlow, kLate, kCached),
                         [](const auto& card) { return std::string(card.param.name); });

/// CDE_FULL=1: a million rays with host arithmetic.
TEST_P(BvhObjectCards, MovingObjects_EqualBruteForceAndReference) {
  const BoardConfig config = GetParam().config();
  Board board = Board::open(config, GetParam().options);
  const bool gates = config.arithmetic == Arithmetic::kRtl, slow = config.latency.add > 1,
             full = std::getenv("CDE_FULL") != nullptr;
  const std::size_t count = full ? (gates ? 300 : slow ? 3'000 : 36'000) : gates || slow ? 30 : 200;
  std::size_t hits = 0;
  for (const auto& one : kScenes) {
    SCOPED_TRACE(one.name);
    TriangleScene triangles = one.make();
    if (triangles.size() < 4) continue;
    if (gates && triangles.size() > 600) triangles.resize(600);
    for (const float far : {0.0f, 1e5f}) {
      if (far != 0 && gates) continue;
      // Entries of the table reach addresses that look like registers.
      const std::uint32_t most = far == 0 && !slow ? 7 : 75;
      Moving world(triangles, std::min<std::uint32_t>(most, triangles.size() / 4), far);
      board.upload(world.scene);
      board.set_objects(world.objects);
      Bvh bvh = world.bvh();
      board.upload(bvh);
      for (int frame = 0; frame < 2; ++frame) {
        const std::vector<Ray> rays = hard_rays(world.pass_secondaries().shapes, count);
        for (const Mode mode : kModes) {
          SCOPED_TRACE(name_of(mode));
          Query query{.mode = mode, .pair = Pair::kRayTriangle, .through = Through::kBvh};
          const std::vector<Record> found = board.cast(rays, query);
          hits += expect_same(found, world.expected(rays, mode));
          query.through = Through::kBruteForce;
          if (mode == Mode::kNearest || !(full || slow))
            expect_same(found, board.cast(rays, query));
        }
        for (const std::size_t k : {1u, 4u}) {
          if (k >= world.objects.size()) continue;
          world.move(k);
          board.move_object(k, world.objects[k].transform);
        }
        if (board.refits()) {
          board.refit();
        } else {
          bvh.refit(world.pass_secondaries().shapes);
          board.upload(bvh);
        }
      }
    }
  }
  EXPECT_GT(hits, count);
}

TEST(BvhOverObjects, InvalidTransform_BuildsNoBvh) {
  Moving world(kScenes[6].make(), 4);
  world.objects[2].transform.rotation(0, 1) += 0.25f;
  expect_error(ErrorCode::kBadInput, "object 2: ", [&] { (void)world.bvh(); });
}

TEST(BvhOverObjects, WhyNotTraversable_NamesTheReason) {
  Board board = Board::open(objects_config());
  Moving world(kScenes[6].make(), 4);
  const auto why = [&] { return board.why_not_traversable({}).value_or(""); };
  board.upload(world.scene);
  board.set_objects(world.objects);
  expect_error(ErrorCode::kUsage, "of objects", [&] { board.upload(Bvh::build(world.scene)); });
  board.upload(world.bvh());
  EXPECT_EQ(why(), "");
  board.move_object(2, world.objects[1].transform);
  EXPECT_EQ(why(), "objects or their triangles have moved since the last refit(); call refit()");
  board.refit();
  EXPECT_EQ(why(), "");
  board.update_shapes<Triangle>(0, std::span(world.scene).first(3));
  EXPECT_EQ(why(), "objects or their triangles have moved since the last refit(); call refit()");
  board.refit();
  EXPECT_EQ(why(), "");

  std::vector<Object> others = world.objects;
  others[3].count -= 2;
  board.set_objects(others);
  EXPECT_EQ(why(), "object 3 of the BVH differs from the card's");
  expect_error(ErrorCode::kUsage, "object 3 of the BVH differs", [&] { board.refit(); });
  expect_error(ErrorCode::kUsage, "of objects", [&] { board.upload(world.bvh()); });
  others[3].count += 2;
  std::swap(others[0].count, others[1].count);
  others[1].count += 1;
  others[3].count -= 1;
  board.set_objects(others);
  expect_error(ErrorCode::kUsage, "does not match the 4 objects of the card",
               [&] { board.upload(world.bvh()); });
  board.set_objects({});
  EXPECT_EQ(why(), "the BVH is over objects, and the card has no objects now");
  expect_error(ErrorCode::kUsage, "a BVH of 4 objects",
               [&] { board.upload(world.pass_secondaries().shapes, world.bvh()); });
  // The same objects again, after a reset that drops them.
  board.upload(world.scene);
  board.set_objects(world.objects);
  board.upload(world.bvh());
  board.reset();
  EXPECT_EQ(why(), "the BVH is over objects, and the card has no objects now");
  board.set_objects(world.objects);
  board.refit();
  EXPECT_EQ(why(), "");
  // Objects that share secondaries, or stand in another order: a brute-force pass keeps their
  // order.
  others = world.objects;
  std::swap(others[0], others[1]);
  board.set_objects(others);
  board.upload(bvh_of(world.scene, others));
  EXPECT_EQ(why(), "object 1 overlaps or precedes object 0");
}

/// Over objects, a BVH without parts is refitted as a whole. A BVH with parts is refitted where it
/// moved.
TEST(BvhOverObjects, MovedObjects_AreRefitted) {
  Board board = Board::open(objects_config());
  Moving world(hard::triangles_of(make_terrain({.quads_x = 50, .quads_y = 50})), 8);
  const std::vector<Ray> rays = hard_rays(world.pass_secondaries().shapes, 300);
  board.upload(world.scene);
  board.set_objects(world.objects);
  board.upload(Bvh::build(world.pass_secondaries().shapes));
  EXPECT_TRUE(Bvh::build(world.pass_secondaries().shapes).parts().empty());
  world.move(3);
  board.move_object(3, world.objects[3].transform);
  const std::uint64_t whole = board.refit().cycles;
  const Query on{.through = Through::kBvh};
  expect_same(board.cast(rays, on), world.expected(rays, Mode::kNearest));
  board.upload(world.bvh());
  for (const std::size_t k : {0u, 5u, 7u}) {
    world.move(k);
    board.move_object(k, world.objects[k].transform);
    EXPECT_LT(board.refit().cycles, whole / 3) << k;
    expect_same(board.cast(rays, on), world.expected(rays, Mode::kNearest));
  }
}

/// Triangles that a transform moves beyond 2^40 have no box: the refit fails, and a brute-force
/// pass still works.
TEST(BvhOverObjects, TriangleWithoutBox_RefitIsRefused) {
  Board board = Board::open(objects_config());
  TriangleScene wide = kScenes[6].make();
  for (Triangle& t : wide)
    for (Vector3f* v : {&t.v0, &t.v1, &t.v2}) *v = *v * 0x1p27f + Vector3f::Constant(0x1p38f);
  Moving world(wide, 3);
  board.upload(world.scene);
  board.set_objects(world.objects);
  board.upload(world.bvh());
  Transform beyond;
  beyond.translation = {0x1p40f, 0, 0};
  world.objects[1].transform = beyond;
  board.move_object(1, beyond);
  expect_error(ErrorCode::kBadInput, "exceeds 2^40", [&] { board.refit(); });
  EXPECT_EQ(*board.why_not_traversable({}),
            "objects or their triangles have moved since the last refit(); call refit()");
  expect_error(ErrorCode::kBadInput, "part 1: secondary 0", [&] { (void)world.bvh(); });
  const std::vector<Ray> rays = hard_rays(world.scene, 60);
  EXPECT_EQ(board.cast(rays).size(), rays.size());
  world.move(1);
  board.move_object(1, world.objects[1].transform);
  board.refit();
  expect_same(board.cast(rays, {.through = Through::kBvh}), world.expected(rays, Mode::kNearest));
}

/// Object tables lie above the registers in the same address space.
TEST(BvhOverObjects, TableEntries_AliasNoRegister) {
  Board board = Board::open(slow_config());
  const std::array<std::uint32_t, 8> registers = {
      card::kRegNodeFlip, card::kRegRoot,      card::kRegRoot + 24, card::kRegNodeCount,
      card::kRegRayCount, card::kRegSlotCount, card::kRegNodeFirst, card::kRegCommand};
  std::array<std::uint64_t, 8> before{};
  for (std::size_t i = 0; i < registers.size(); ++i) before[i] = board.read_register(registers[i]);
  Moving world(kScenes[6].make(), 100);
  board.upload(world.scene);
  board.set_objects(world.objects);
  for (std::size_t i = 0; i < registers.size(); ++i)
    EXPECT_EQ(board.read_register(registers[i]), before[i]) << registers[i];
}

TEST(BvhOverObjects, MalformedMemory_GivesAnError) {
  Board board = Board::open(objects_config());
  Moving world(kScenes[6].make(), 3);
  const std::vector<Ray> rays = hard_rays(world.pass_secondaries().shapes, 300);
  board.upload(world.scene);
  board.set_objects(world.objects);
  const Bvh bvh = world.bvh();
  board.upload(bvh);
  const Query on{.through = Through::kBvh};
  const std::uint32_t objects_at = 4 * 8 * 1024;  // after the slots of 1,024 nodes
  const std::vector<std::uint64_t> none(bvh.order().size() / 2, 3 | std::uint64_t{3} << 32);
  board.bus_write(card::kSpaceSlots, objects_at, none);
  expect_error(ErrorCode::kDevice, "has an object above the 3 of the card",
               [&] { (void)board.cast(rays, on); });
  expect_error(ErrorCode::kDevice, "has an object above the 3 of the card", [&] {
    board.move_object(0, world.objects[0].transform);
    board.refit();
  });
  board.bus_write(card::kSpaceSlots, 2 * objects_at, {});
  const std::vector<std::uint64_t> beat(1, 0);
  board.bus_write(card::kSpaceSlots, 2 * objects_at, beat);
  EXPECT_TRUE(board.read_register(card::kRegStatus) >> card::kStatusBusError & 1);
  board.write_register(card::kRegControl, card::kControlClear);
  board.upload(bvh);
  expect_same(board.cast(rays, on), world.expected(rays, Mode::kNearest));
}

}  // namespace
}  // namespace cde::testing
