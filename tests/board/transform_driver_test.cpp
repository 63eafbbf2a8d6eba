// SPDX-License-Identifier: Apache-2.0
// The driver's objects: uploads, refusals, and shapes that violate their contract after a
// transform.
#include <cstring>

#include "../expect_error.hpp"
#include "moving_cases.hpp"

namespace cde::testing {
namespace {

using namespace card;

/// Words that only the transform makes too large: the check comes after the transformer.
TEST(ObjectDriver, MovedOutOfRange_IsBadInput) {
  Board board = Board::open(config_of(kSlowHost));
  Random random;
  MovingRays scene = rays(random, 9, 12);
  scene.secondaries[4].v1.x() = 0x1p40f;
  scene.primaries[2].o.x() = -0x1p40f;
  Transform there, back;
  there.translation.x() = 0x1p40f;
  back.translation.x() = -0x1p40f;
  const std::vector<Object> moving{{0, 12, back}, {3, 3, there}};
  board.upload(scene.secondaries);
  board.load(scene.primaries);
  board.set_objects(moving);
  for (const Transform& transform : {there, back, there}) {
    const std::vector<Object> posing{{1, 3, transform}};
    board.set_primary_objects(posing);
    check_pass(board, Pair::kRayTriangle, false, scene.primaries, scene.secondaries, posing,
               moving);
    Counters c;
    (void)board.run({}, &c);
    EXPECT_EQ(c.bad_secondaries, 1u) << "slot 4, where the triangle continues";
    EXPECT_EQ(c.bad_primaries, transform.translation.x() < 0 ? 1u : 0u);
  }
}

/// Far from the origin the corners of a small box coincide: bad input.
TEST(ObjectDriver, BoxesThatVanish_AreBadInput) {
  Board board = Board::open(config_of(kBoxes));
  Random random;
  const auto mesh = shapes<Triangle>(random, 10);
  const std::vector<Aabb> boxes{{{0, 0, 0}, {1, 1, 1}}, {{0, 0, 0}, {3e8f, 3e8f, 3e8f}}};
  for (int axis = 0; axis < 3; ++axis) {
    SCOPED_TRACE(axis);
    Transform far;
    far.translation[axis] = 1e9f;
    const std::vector<Object> moving{{0, 2, far}, {0, 2, {}}};
    board.upload_shapes(std::span<const Aabb>(boxes));
    board.load_shapes(std::span<const Triangle>(mesh));
    board.set_objects(moving);
    check_pass(board, Pair::kTriangleAabb, false, mesh, boxes, {}, moving);
    Counters c;
    (void)board.run({}, &c);
    EXPECT_EQ(c.bad_secondaries, 1u);
  }
}

/// A pass with another shape does not use the posed primaries of the first.
TEST(ObjectDriver, AnotherPair_PosesPrimariesAgain) {
  Board board = Board::open(config_of(kMany));
  Random random;
  const std::vector<Object> posing{{2, 3, motion(random)}};
  for (int round = 0; round < 2; ++round) {
    const auto some = shapes<Ray>(random, 12);
    const auto mesh = shapes<Triangle>(random, 30);
    board.upload(mesh, false);
    board.load(some);
    board.set_primary_objects(posing);
    check_pass(board, Pair::kRayTriangle, false, some, mesh, posing, {});
    const auto boxes = shapes<Obb>(random, 9);
    const auto planes = shapes<Plane>(random, 30);
    board.upload_shapes(std::span<const Plane>(planes), false);
    board.load_shapes(std::span<const Obb>(boxes), false);
    check_pass(board, Pair::kObbPlane, false, boxes, planes, posing, {});
  }
}

/// Primaries of two pairs in one pass, each posed as its own shape. The second pair's primaries use
/// later rows of their own.
TEST(ObjectDriver, PrimariesOfBothPairs_Move) {
  BoardConfig config = config_of(kParallel);
  config.parallel = true;
  Board board = Board::open(config);
  Random random;
  const auto mesh = shapes<Triangle>(random, 40);
  const auto some = shapes<Ray>(random, 13);
  const auto balls = shapes<Sphere>(random, 21);
  board.upload(mesh, false);
  for (const std::size_t n : {std::size_t{21}, std::size_t{9}}) {
    const std::vector<Sphere> behind(balls.begin(), balls.begin() + static_cast<std::ptrdiff_t>(n));
    board.set_primary_objects({});
    board.load(some);
    board.load_second_shapes(std::span<const Sphere>(behind), false);
    std::vector<Object> posing{{2, 8, motion(random)}, {14, 6, motion(random)}};
    const auto moving = objects(random, 40, 7, false);
    board.set_objects(moving);
    board.set_primary_objects(posing);
    for (int frame = 0; frame < 3; ++frame) {
      const auto tested = reference::pass_secondaries(mesh, moving);
      const auto of_rays = reference::posed(std::span<const Ray>(some), std::span(posing).first(1));
      Object shifted = posing[1];
      shifted.first -= 13;
      const auto of_balls =
          reference::posed(std::span<const Sphere>(behind), std::span<const Object>(&shifted, 1));
      std::vector<bool> bad_rays, bad_balls;
      for (const Ray& p : of_rays) bad_rays.push_back(defect(p).has_value());
      for (const Sphere& p : of_balls) bad_balls.push_back(defect(p).has_value());
      auto wanted =
          expected(Pair::kRayTriangle, all_pairs(Pair::kRayTriangle, of_rays, tested.shapes, false),
                   tested.slots, bad_rays, Mode::kNearest, false);
      for (Record r : expected(Pair::kTriangleSphere,
                               all_pairs(Pair::kTriangleSphere, tested.shapes, of_balls, true),
                               tested.slots, bad_balls, Mode::kNearest, false)) {
        r.primary += 13;
        wanted.push_back(r);
      }
      const Query query{.pair = Pair::kRayTriangle,
                        .second = SecondPair{Pair::kTriangleSphere, true}};
      compare(board.run(query), wanted, Mode::kNearest);
      for (std::size_t i = 0; i < 2; ++i) {
        posing[i].transform = motion(random);
        board.move_primary_object(i, posing[i].transform);
      }
    }
    try {
      board.set_primary_objects(std::array{Object{12, 2, {}}});
      ADD_FAILURE() << "no error";
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find("primaries of both pairs"), std::string::npos);
    }
  }
}

TEST(ObjectDriver, Move_UploadsTwelveWords) {
  Board board = Board::open(config_of(kMany));
  Random random;
  const MovingRays scene = rays(random, 40, 60);
  board.upload(scene.secondaries);
  board.load(scene.primaries);
  std::vector<Object> moving = objects(random, 60, 6, false),
                      posing = objects(random, 40, 6, false);
  board.set_objects(moving);
  board.set_primary_objects(posing);
  for (std::size_t i = 0; i < 6; ++i) {
    const std::uint64_t words = board.words_uploaded(), start = board.time_ps();
    moving[i].transform = motion(random);
    posing[i].transform = motion(random);
    board.move_object(i, moving[i].transform);
    EXPECT_EQ(board.words_uploaded() - words, 12u);
    board.move_primary_object(i, posing[i].transform);
    EXPECT_EQ(board.words_uploaded() - words, 24u);
    EXPECT_LE(board.time_ps() - start, 4'000'000u)
        << "two short transfers with a read of the status each";
    check_pass(board, Pair::kRayTriangle, false, scene.primaries, scene.secondaries, posing,
               moving);
    EXPECT_EQ(board.words_uploaded() - words, 24u) << "a pass uploads nothing";
  }
}

/// Any range, including ranges that begin or end within a beat of DDR; neighbours stay unchanged.
TEST(ObjectDriver, PartOfTheSecondaries_IsUploadedAgain) {
  Board board = Board::open(config_of(kMany));
  Random random;
  const auto primaries = shapes<Ray>(random, 8);
  auto mesh = shapes<Triangle>(random, 41);
  board.upload(mesh, false);
  board.load(primaries);
  for (int round = 0; round < 30; ++round) {
    const std::uint32_t first = random.below(41), count = random.below(42 - first);
    const auto some = shapes<Triangle>(random, count);
    std::copy(some.begin(), some.end(), mesh.begin() + first);
    const std::uint64_t words = board.words_uploaded();
    board.update_shapes(first, std::span<const Triangle>(some), false);
    EXPECT_LE(board.words_uploaded() - words, 9 * count + 2);
    check_pass(board, Pair::kRayTriangle, false, primaries, mesh, {}, {}, {Mode::kAll});
  }
  auto boxes = shapes<Obb>(random, 7);
  const auto planes = shapes<Plane>(random, 5);
  board.upload_shapes(std::span<const Obb>(boxes), false);
  board.load_shapes(std::span<const Plane>(planes), false);
  boxes[3] = shape<Obb>(random);
  board.update_shapes(3, std::span<const Obb>(boxes).subspan(3, 1));
  check_pass(board, Pair::kObbPlane, true, planes, boxes, {}, {}, {Mode::kAll});
}

TEST(ObjectDriver, InvalidRequests_AreRefused) {
  BoardConfig config = config_of(kMany);
  config.objects = 8;
  EXPECT_THROW((void)config_of(kMany, Transformer::kNone).parameters().at(99), std::out_of_range);
  config.objects = 1;
  expect_error(ErrorCode::kUsage, "objects is 1", [&] { (void)config.parameters(); });
  Board board = Board::open(config_of(kMany));
  Random random;
  const MovingRays scene = rays(random, 10, 20);
  board.upload(scene.secondaries);
  board.load(scene.primaries);
  const auto set = [&](const Object& object) {
    return [&board, object] { board.set_objects(std::array{Object{0, 1, {}}, object}); };
  };
  const std::uint64_t words = board.words_uploaded();
  expect_error(ErrorCode::kUsage, "object 1 of secondaries: its range is empty", set({3, 0, {}}));
  expect_error(ErrorCode::kUsage, "slots 15 to 20 exceed the 20 uploaded", set({15, 6, {}}));
  expect_error(ErrorCode::kUsage, "exceed the 20 uploaded", set({0xffffffff, 2, {}}));
  Transform bad;
  bad.rotation(0, 1) = 1e-5f;
  expect_error(ErrorCode::kBadInput, "object 1 of secondaries: rotation is not orthonormal",
               set({0, 1, bad}));
  bad = {};
  bad.translation.y() = std::numeric_limits<float>::quiet_NaN();
  expect_error(ErrorCode::kBadInput, "translation.y is nan", set({0, 1, bad}));
  bad = {};
  bad.rotation(1, 1) = std::numeric_limits<float>::infinity();
  expect_error(ErrorCode::kBadInput, "rotation[1][1] is inf", set({0, 1, bad}));
  expect_error(ErrorCode::kUsage, "1025 objects of secondaries do not fit the card's table of 1024",
               [&] {
                 board.set_objects(std::vector<Object>(1025, {0, 1, {}}));
               });
  expect_error(ErrorCode::kUsage, "slots 9 to 10 exceed the 10 loaded", [&] {
    board.set_primary_objects(std::array{Object{9, 2, {}}});
  });
  EXPECT_EQ(board.words_uploaded(), words) << "refused before any word was sent";
  board.set_objects(std::array{Object{12, 8, motion(random)}});
  expect_error(ErrorCode::kUsage, "there is no object 1",
               [&] { board.move_object(1, Transform{}); });
  expect_error(ErrorCode::kBadInput, "not orthonormal",
               [&] { board.move_object(0, Transform{Eigen::Matrix3f::Zero()}); });
  board.upload(std::span(scene.secondaries).first(15));
  expect_error(ErrorCode::kUsage, "slots 12 to 19 exceed the 15 uploaded",
               [&] { (void)board.run({.pair = Pair::kRayTriangle}); });
  board.set_objects({});
  EXPECT_EQ(board.run({.pair = Pair::kRayTriangle}).size(), 10u);
  expect_error(ErrorCode::kUsage, "no spheres were uploaded",
               [&] { board.update_shapes(0, std::span<const Sphere>()); });
  expect_error(ErrorCode::kUsage, "triangles 10 to 16 are not among the 15 uploaded", [&] {
    board.update_shapes(10, std::span<const Triangle>(scene.secondaries).first(7));
  });
}

TEST(ObjectDriver, RotatedAabbs_AreRefused) {
  Board board = Board::open(config_of(kBoxes));
  Random random;
  const auto mesh = shapes<Triangle>(random, 10);
  const std::vector<Aabb> boxes{shape<Aabb>(random), shape<Aabb>(random)};
  const std::string text = "an AABB cannot be rotated on the card";
  board.upload_shapes(std::span<const Aabb>(boxes));
  board.load_shapes(std::span<const Triangle>(mesh));
  board.set_objects(std::array{Object{0, 2, {}}});
  expect_error(ErrorCode::kUsage, text, [&] { board.move_object(0, motion(random)); });
  board.set_primary_objects(std::array{Object{0, 10, motion(random)}});  // triangles turn
  EXPECT_EQ(board.run({}).size(), 10u);
  // The transform was set for triangles, then boxes are loaded.
  board.upload_shapes(std::span<const Triangle>(mesh), false);
  board.load_shapes(std::span<const Aabb>(boxes), false);
  board.set_objects({});
  board.set_primary_objects(std::array{Object{0, 1, {}}});
  expect_error(ErrorCode::kUsage, text, [&] { board.move_primary_object(0, motion(random)); });
  // The card itself also refuses.
  const auto turned = to_words(motion(random));
  std::array<std::uint64_t, 6> beats;
  std::memcpy(beats.data(), turned.data(), sizeof beats);
  board.bus_write(kSpaceReg, kPrimObjectTable + 8, beats);
  expect_error(ErrorCode::kDevice, "command refused", [&] { (void)board.run({.swap = true}); });
}

TEST(ObjectDriver, CardsWithoutATransformer_Refuse) {
  Random random;
  const MovingRays scene = rays(random, 10, 20);
  for (const Transformer transform : {Transformer::kNone, Transformer::kSecondaries}) {
    Board board =
        transform == Transformer::kNone
            ? Board::open(small_config())
            : Board::open(config_of({"", Arithmetic::kHost, {Pair::kRayTriangle}, 8}, transform));
    board.upload(scene.secondaries);
    board.load(scene.primaries);
    const auto refused = [&](std::uint32_t offset) {
      board.write_register(offset, 1);
      const bool error = (board.read_register(kRegStatus) >> kStatusBusError & 1) != 0;
      EXPECT_EQ(error && board.read_register(kRegFaultAddr) == offset, error);
      board.write_register(kRegControl, kControlClear);
      return error;
    };
    const bool none = transform == Transformer::kNone;
    EXPECT_EQ(refused(kRegObjectCount), none);
    EXPECT_EQ(refused(kObjectTable), none);
    EXPECT_TRUE(refused(kRegPrimObjectCount));
    EXPECT_TRUE(refused(kPrimObjectTable));
    EXPECT_TRUE(refused(kObjectTable + 1024 * 64));
    const std::array some{Object{3, 9, motion(random)}};
    const std::string text = "this card has no transformer for ";
    expect_error(ErrorCode::kUsage, text + "primaries", [&] { board.set_primary_objects(some); });
    expect_error(ErrorCode::kUsage, text + "primaries", [&] { board.move_primary_object(0, {}); });
    if (none) {
      expect_error(ErrorCode::kUsage, text + "secondaries", [&] { board.set_objects(some); });
      expect_error(ErrorCode::kUsage, text + "secondaries", [&] { board.move_object(0, {}); });
      EXPECT_EQ(board.run({}).size(), 10u);
    } else {
      board.set_objects(some);
      check_pass(board, Pair::kRayTriangle, false, scene.primaries, scene.secondaries, {}, some);
      board.reset();
      board.load(scene.primaries);
      check_pass(board, Pair::kRayTriangle, false, scene.primaries, scene.secondaries, {}, {});
    }
  }
}

/// The reference cast supports objects.
TEST(ObjectDriver, CastsWithObjects_AreChecked) {
  Board board = Board::open(config_of(kSlowHost));
  Random random;
  const MovingRays scene = rays(random, 600, 50);
  const auto moving = objects(random, 50, 12, false);
  board.upload(scene.secondaries);
  board.set_objects(moving);
  for (const Mode mode : {Mode::kNearest, Mode::kAny, Mode::kAll, Mode::kHits}) {
    reference::Checker checker(scene.primaries, scene.secondaries, mode, {}, board.primaries(), "",
                               moving);
    board.cast(scene.primaries, {.mode = mode},
               [&](std::span<const Record> r) { checker.check(r); });
    checker.finish();
    EXPECT_GE(checker.compared(), 50u);
  }
  reference::Checker wrong(scene.primaries, scene.secondaries, Mode::kAll, {}, board.primaries(),
                           "", std::span(moving).first(11));
  expect_error(ErrorCode::kMismatch, "differs", [&] {
    board.cast(scene.primaries, {.mode = Mode::kAll},
               [&](std::span<const Record> r) { wrong.check(r); });
  });
}

}  // namespace
}  // namespace cde::testing
