// SPDX-License-Identifier: Apache-2.0
// Objects: the card's object tables and its transformer. Every record equals the reference, which
// moves the shapes first.
#include "moving_cases.hpp"

namespace cde::testing {
namespace {

template <class P, class S>
void check_objects(Board& board, Pair pair, bool swap, Random& random) {
  const std::uint32_t n_primaries = 3 + random.below(40), n_secondaries = 20 + random.below(40);
  const auto primaries = shapes<P>(random, n_primaries);
  const auto secondaries = shapes<S>(random, n_secondaries);
  board.set_objects({});
  board.set_primary_objects({});
  board.upload_shapes(std::span<const S>(secondaries), false);
  board.load_shapes(std::span<const P>(primaries), false);
  for (const std::size_t n : {std::size_t{0}, std::size_t{1}, std::size_t{9}}) {
    const auto moving = objects(random, n_secondaries, n, std::is_same_v<S, Aabb>);
    const auto posing = objects(random, n_primaries, n / 2, std::is_same_v<P, Aabb>);
    board.set_objects(moving);
    board.set_primary_objects(posing);
    check_pass(board, pair, swap, primaries, secondaries, posing, moving);
  }
}

template <class A, class B>
void check_both_roles(Board& board, Pair pair, Random& random) {
  for (int round = 0; round < 3; ++round) {
    check_objects<A, B>(board, pair, false, random);
    check_objects<B, A>(board, pair, true, random);
  }
}

class Objects : public ::testing::TestWithParam<MovingBoard> {};

/// Every shape as secondary and as primary: random overlapping ranges, single slots, bad input and
/// overflow.
TEST_P(Objects, EveryShapeInBothRoles_EqualsTheReference) {
  Board board = Board::open(config_of(GetParam()));
  Random random;
  for (const Pair pair : GetParam().pairs) {
    if (pair == Pair::kRayTriangle) check_both_roles<Ray, Triangle>(board, pair, random);
    if (pair == Pair::kSphereSphere) check_both_roles<Sphere, Sphere>(board, pair, random);
    if (pair == Pair::kRayCylinder) check_both_roles<Ray, Cylinder>(board, pair, random);
    if (pair == Pair::kObbPlane) check_both_roles<Obb, Plane>(board, pair, random);
    if (pair == Pair::kTriangleAabb) check_both_roles<Triangle, Aabb>(board, pair, random);
  }
}

INSTANTIATE_TEST_SUITE_P(Boards, Objects,
                         ::testing::Values(kMany, kMovingGates, kSlowGates, kSlowHost, kBoxes),
                         [](const auto& info) { return info.param.name; });

TEST(ObjectCycles, HostArithmetic_TakesTheCyclesOfGates) {
  std::vector<Counters> counted;
  for (const MovingBoard& kind : {kSlowHost, kSlowGates}) {
    Random random;
    const MovingRays scene = rays(random, 30, 200);
    Board board = Board::open(config_of(kind));
    board.upload(scene.secondaries);
    board.load(scene.primaries);
    board.set_objects(objects(random, 200, 40, false));
    board.set_primary_objects(objects(random, 30, 5, false));
    for (int pass = 0; pass < 2; ++pass) {
      counted.emplace_back();
      (void)board.run({.pair = Pair::kRayTriangle}, &counted.back());
    }
  }
  for (int pass = 0; pass < 2; ++pass) {
    EXPECT_EQ(counted[pass].cycles, counted[2 + pass].cycles);
    EXPECT_EQ(counted[pass].bubbles, counted[2 + pass].bubbles);
  }
}

/// With one row of primaries every cycle needs another secondary. Objects of one slot are as fast
/// as one object with all slots.
TEST(ObjectCycles, ManyObjects_LoseNoCycle) {
  Board board = Board::open(config_of(kMany));
  Random random;
  std::vector<Sphere> few, many;
  for (int i = 0; i < 8; ++i) few.push_back(shape<Sphere>(random));
  for (int i = 0; i < 1000; ++i) many.push_back(shape<Sphere>(random));
  board.upload_shapes(std::span<const Sphere>(many));
  board.load_shapes(std::span<const Sphere>(few));
  const Query query{.pair = Pair::kSphereSphere};
  std::vector<Object> one{{0, 1000, motion(random)}}, singles, threes;
  for (std::uint32_t i = 0; i < 1000; ++i) singles.push_back({i, 1, motion(random)});
  for (std::uint32_t i = 0; i < 333; ++i) threes.push_back({3 * i, 3, motion(random)});
  Counters plain;
  (void)board.run(query, &plain);
  for (const auto& moving : {one, singles, threes}) {
    Counters c;
    board.set_objects(moving);
    check_pass(board, Pair::kSphereSphere, false, few, many, {}, moving,
               {Mode::kAny, Mode::kNearest});
    (void)board.run(query, &c);
    const std::uint64_t tested = moving.size() == 333 ? 999 : 1000;
    EXPECT_EQ(c.secondaries, tested);
    EXPECT_EQ(c.rows, tested);
    EXPECT_EQ(c.bubbles, plain.bubbles);
    EXPECT_EQ(c.cycles - tested, plain.cycles - 1000);
  }
  EXPECT_LE(plain.bubbles, 20u) << "memory latency at the start of a pass";
}

/// An unchanged scene costs no cycles. A moved primary object costs its slots, and a changed range
/// costs all primaries.
TEST(ObjectCycles, MovedPrimaries_ArePosedAgain) {
  Board board = Board::open(config_of(kMany));
  Random random;
  const MovingRays scene = rays(random, 100, 50);
  board.upload(scene.secondaries);
  board.load(scene.primaries);
  std::vector<Object> posing{{10, 20, motion(random)}, {50, 7, motion(random)}};
  const auto cycles = [&] {
    Counters c;
    check_pass(board, Pair::kRayTriangle, false, scene.primaries, scene.secondaries, posing, {},
               {Mode::kNearest});
    (void)board.run({.pair = Pair::kRayTriangle}, &c);
    return c.cycles;
  };
  const auto first_run = [&] {
    Counters c;
    (void)board.run({.pair = Pair::kRayTriangle}, &c);
    return c.cycles;
  };
  const std::uint64_t never = first_run();
  board.set_primary_objects(posing);
  const std::uint64_t restored = first_run();
  const std::uint64_t still = cycles();
  EXPECT_EQ(still, never);
  EXPECT_GE(restored, still + 256 + 27);
  EXPECT_LE(restored, still + 256 + 27 + 20);
  posing[1].transform = motion(random);
  board.move_primary_object(1, posing[1].transform);
  const std::uint64_t moved = first_run();
  EXPECT_GE(moved, still + 27);
  EXPECT_LE(moved, still + 27 + 16);
  EXPECT_EQ(cycles(), still);
  board.load(scene.primaries);  // as they were written, so posed again
  EXPECT_EQ(first_run(), moved);
  EXPECT_EQ(cycles(), still);
  posing.pop_back();
  board.set_primary_objects(posing);
  EXPECT_GT(first_run(), still + 256);
  EXPECT_EQ(cycles(), still);
  posing.clear();
  board.set_primary_objects(posing);
  EXPECT_GT(first_run(), still + 256) << "all primaries are posed again";
  EXPECT_EQ(cycles(), still);
}

}  // namespace
}  // namespace cde::testing
