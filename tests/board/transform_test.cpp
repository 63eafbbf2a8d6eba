// Objects: the card's object tables and its transformer, every record against the reference that
// moves the shapes first.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "cases.hpp"
#include "cde/reference/transform.hpp"
#include "pair_records.hpp"

namespace cde::testing {
namespace {

using namespace card;

// ---- Boards ----

struct Kind {
  const char* name;
  Arithmetic arithmetic;
  std::vector<Pair> pairs;
  unsigned lanes;
  unsigned slower = 0;  ///< clocks more for an operator
};

BoardConfig config_of(const Kind& kind, Transformer transform = Transformer::kBoth) {
  BoardConfig c;
  c.lanes = kind.lanes;
  c.arithmetic = kind.arithmetic;
  c.pairs = kind.pairs;
  c.swap = true;
  c.transform = transform;
  c.latency_add += kind.slower;
  c.latency_mul += 2 * kind.slower;
  c.latency_compare += kind.slower;
  c.ddr_slots = 4000;
  c.sram_records = 1024;
  return c;
}

const Kind kMany{"Many",
                 Arithmetic::kHost,
                 {Pair::kRayTriangle, Pair::kSphereSphere, Pair::kRayCylinder, Pair::kObbPlane},
                 8};
const Kind kGates{"Gates", Arithmetic::kRtl, {Pair::kRayTriangle, Pair::kObbPlane}, 2};
const Kind kSlowGates{"SlowGates", Arithmetic::kRtl, {Pair::kRayTriangle}, 2, 1};
const Kind kSlowHost{"SlowHost", Arithmetic::kHost, {Pair::kRayTriangle}, 2, 1};
const Kind kParallel{"Parallel", Arithmetic::kHost, {Pair::kRayTriangle, Pair::kTriangleSphere}, 8};
const Kind kBoxes{"Boxes", Arithmetic::kHost, {Pair::kTriangleAabb}, 1};

// ---- Shapes and objects ----

Eigen::Matrix3f rotation(Random& random) {
  const Eigen::Vector3d axis = random.in_box(1).cast<double>().normalized();
  return Eigen::AngleAxisd(random.in(-3, 3), axis).toRotationMatrix().cast<float>();
}

Transform motion(Random& random) {
  return {rotation(random), random.in_box(3)};
}

Eigen::Vector3f direction(Random& random) {
  return random.in_box(1).cast<double>().normalized().cast<float>();
}

template <class P>
P shape(Random& random);
template <>
Ray shape(Random& random) {
  return {random.in_box(4), random.in_box(2), -1, random.in(1, 9)};
}
template <>
Triangle shape(Random& random) {
  return {random.in_box(4), random.in_box(4), random.in_box(4)};
}
template <>
Sphere shape(Random& random) {
  return {random.in_box(4), random.in(0.1f, 2)};
}
template <>
Cylinder shape(Random& random) {
  return {random.in_box(4), direction(random), random.in(0.2f, 3), random.in(0.2f, 2)};
}
template <>
Plane shape(Random& random) {
  return {direction(random), random.in(-4, 4)};
}
template <>
Obb shape(Random& random) {
  return {random.in_box(4),
          {random.in(0.1f, 1), random.in(0.1f, 1), random.in(0.1f, 1)},
          rotation(random)};
}
template <>
Aabb shape(Random& random) {
  const Eigen::Vector3f low = random.in_box(3);
  return {low, low + Eigen::Vector3f(random.in(0.1f, 2), random.in(0.1f, 2), random.in(0.1f, 2))};
}

/// Random shapes, some out of contract, some that only leave it when they move: a word so large
/// that a translation by 1e38 overflows.
template <class P>
std::vector<P> shapes(Random& random, std::size_t count) {
  std::vector<P> all;
  for (std::size_t i = 0; i < count; ++i) {
    auto words = to_words(shape<P>(random));
    const float odd[] = {std::numeric_limits<float>::quiet_NaN(),
                         -std::numeric_limits<float>::infinity(), 3.3e38f, -0.0f};
    if (random.below(16) == 0)
      words[random.below(static_cast<std::uint32_t>(words.size()))] = odd[random.below(4)];
    all.push_back(from_words<P>(words));
  }
  return all;
}

/// Ranges anywhere in `slots`, overlapping, many of one slot.
std::vector<Object> objects(Random& random, std::uint32_t slots, std::size_t count, bool boxes) {
  std::vector<Object> all;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t first = random.below(slots);
    const std::uint32_t most = random.below(2) == 0 ? 1 : slots - first;
    Transform transform = motion(random);
    if (boxes) transform.rotation.setIdentity();
    if (random.below(16) == 0) transform.translation.x() = 1e38f;
    all.push_back({first, 1 + random.below(most), transform});
  }
  return all;
}

/// What a pass over objects answers, all modes, against the reference.
template <class P, class S>
void check_pass(Board& board, Pair pair, bool swap, const std::vector<P>& primaries,
                const std::vector<S>& secondaries, std::span<const Object> of_primaries,
                std::span<const Object> of_secondaries,
                std::initializer_list<Mode> modes = {Mode::kNearest, Mode::kFarthest, Mode::kAny,
                                                     Mode::kAll, Mode::kHits}) {
  const auto swept = reference::swept(secondaries, of_secondaries);
  const std::vector<P> posed = reference::posed(std::span<const P>(primaries), of_primaries);
  std::vector<PairResult> results;
  if constexpr (std::is_same_v<P, S>) {
    results = swap ? all_pairs(pair, swept.shapes, posed, true)
                   : all_pairs(pair, posed, swept.shapes, false);
  } else {
    if (swap) results = all_pairs(pair, swept.shapes, posed, true);
    if (!swap) results = all_pairs(pair, posed, swept.shapes, false);
  }
  std::vector<bool> bad;
  bad.reserve(posed.size());
  for (const P& p : posed) bad.push_back(defect(p).has_value());
  for (const Mode mode : modes) {
    SCOPED_TRACE(fmt::format("{}{}, {} over {}", name(pair), swap ? " swapped" : "",
                             of_primaries.size(), of_secondaries.size()));
    compare(board.run({.mode = mode, .pair = pair, .swap = swap}),
            expected(pair, results, swept.slots, bad, mode, false), mode);
  }
}

template <class P, class S>
void check_objects(Board& board, Pair pair, bool swap, Random& random) {
  const std::uint32_t n_primaries = 3 + random.below(40), n_secondaries = 20 + random.below(40);
  const auto primaries = shapes<P>(random, n_primaries);
  const auto secondaries = shapes<S>(random, n_secondaries);
  board.set_objects({});
  board.set_primary_objects({});
  board.upload_shapes(std::span<const S>(secondaries), false);
  board.load_shapes(std::span<const P>(primaries));
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

class Objects : public ::testing::TestWithParam<Kind> {};

/// Every shape as secondary and as primary: random ranges that overlap, single slots, bad input and
/// overflow.
TEST_P(Objects, EveryShapeInBothRoles) {
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
                         ::testing::Values(kMany, kGates, kSlowGates, kSlowHost, kBoxes),
                         [](const auto& info) { return info.param.name; });

struct Rays {
  std::vector<Ray> primaries;
  std::vector<Triangle> secondaries;
};
Rays rays(Random& random, std::size_t primaries, std::size_t secondaries) {
  Rays all;
  for (std::size_t i = 0; i < primaries; ++i) all.primaries.push_back(shape<Ray>(random));
  for (std::size_t i = 0; i < secondaries; ++i) all.secondaries.push_back(shape<Triangle>(random));
  return all;
}

TEST(ObjectClocks, AreThoseOfTheGates) {
  std::vector<Counters> counted;
  for (const Kind& kind : {kSlowHost, kSlowGates}) {
    Random random;
    const Rays scene = rays(random, 30, 200);
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

/// One row of primaries, so that every clock wants another secondary: objects of one slot are as
/// fast as one object of all of them.
TEST(ObjectClocks, NoneIsLostBetweenObjects) {
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
    const std::uint64_t swept = moving.size() == 333 ? 999 : 1000;
    EXPECT_EQ(c.secondaries, swept);
    EXPECT_EQ(c.rows, swept);
    EXPECT_EQ(c.bubbles, plain.bubbles);
    EXPECT_EQ(c.cycles - swept, plain.cycles - 1000);
  }
  EXPECT_LE(plain.bubbles, 20u) << "what the start of a pass does not hide of the memory's latency";
}

/// A still scene costs nothing; a moved primary object its slots, a changed range all primaries.
TEST(ObjectClocks, PrimariesArePosedWhenTheyMoved) {
  Board board = Board::open(config_of(kMany));
  Random random;
  const Rays scene = rays(random, 100, 50);
  board.upload(scene.secondaries);
  board.load(scene.primaries);
  std::vector<Object> posing{{10, 20, motion(random)}, {50, 7, motion(random)}};
  const auto clocks = [&] {
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
  const std::uint64_t still = clocks();
  EXPECT_EQ(still, never);
  EXPECT_GE(restored, still + 256 + 27);
  EXPECT_LE(restored, still + 256 + 27 + 20);
  posing[1].transform = motion(random);
  board.move_primary_object(1, posing[1].transform);
  const std::uint64_t moved = first_run();
  EXPECT_GE(moved, still + 27);
  EXPECT_LE(moved, still + 27 + 16);
  EXPECT_EQ(clocks(), still);
  board.load(scene.primaries);  // as they were written, so posed again
  EXPECT_EQ(first_run(), moved);
  EXPECT_EQ(clocks(), still);
  posing.pop_back();
  board.set_primary_objects(posing);
  EXPECT_GT(first_run(), still + 256);
  EXPECT_EQ(clocks(), still);
  posing.clear();
  board.set_primary_objects(posing);
  EXPECT_GT(first_run(), still + 256) << "all go back to where they were written";
  EXPECT_EQ(clocks(), still);
}

/// Words that only the transform makes infinite: the check stands behind it.
TEST(ObjectDriver, OverflowOnTheWayIsBadInput) {
  Board board = Board::open(config_of(kSlowHost));
  Random random;
  Rays scene = rays(random, 9, 12);
  scene.secondaries[4].v1.x() = 3.3e38f;
  scene.primaries[2].o.x() = -3.3e38f;
  Transform there, back;
  there.translation.x() = 1e38f;
  back.translation.x() = -1e38f;
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
    EXPECT_EQ(c.bad_secondaries, 1u) << "slot 4, where it goes on";
    EXPECT_EQ(c.bad_primaries, transform.translation.x() < 0 ? 1u : 0u);
  }
}

/// Far away the corners of a small box fall together: bad input too.
TEST(ObjectDriver, BoxesThatVanishAreBadInput) {
  Board board = Board::open(config_of(kBoxes));
  Random random;
  const auto mesh = shapes<Triangle>(random, 10);
  const std::vector<Aabb> boxes{{{0, 0, 0}, {1, 1, 1}}, {{0, 0, 0}, {3e8f, 3e8f, 3e8f}}};
  Transform far;
  far.translation.y() = 1e9f;
  const std::vector<Object> moving{{0, 2, far}, {0, 2, {}}};
  board.upload_shapes(std::span<const Aabb>(boxes));
  board.load_shapes(std::span<const Triangle>(mesh));
  board.set_objects(moving);
  check_pass(board, Pair::kTriangleAabb, false, mesh, boxes, {}, moving);
  Counters c;
  (void)board.run({}, &c);
  EXPECT_EQ(c.bad_secondaries, 1u);
}

/// A pass with another shape does not see what was posed for the first.
TEST(ObjectDriver, PrimariesOfAnotherPairArePosedAgain) {
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
    board.load_shapes(std::span<const Obb>(boxes));
    check_pass(board, Pair::kObbPlane, false, boxes, planes, posing, {});
  }
}

/// Primaries of two pairs in one pass, each posed as its own shape; the second's lie on rows of
/// their own, behind.
TEST(ObjectDriver, PrimariesOfBothPairsMove) {
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
    board.load_second_shapes(std::span<const Sphere>(behind));
    std::vector<Object> posing{{2, 8, motion(random)}, {14, 6, motion(random)}};
    const auto moving = objects(random, 40, 7, false);
    board.set_objects(moving);
    board.set_primary_objects(posing);
    for (int frame = 0; frame < 3; ++frame) {
      const auto swept = reference::swept(mesh, moving);
      const auto of_rays = reference::posed(std::span<const Ray>(some), std::span(posing).first(1));
      Object shifted = posing[1];
      shifted.first -= 13;
      const auto of_balls =
          reference::posed(std::span<const Sphere>(behind), std::span<const Object>(&shifted, 1));
      std::vector<bool> bad_rays, bad_balls;
      for (const Ray& p : of_rays) bad_rays.push_back(defect(p).has_value());
      for (const Sphere& p : of_balls) bad_balls.push_back(defect(p).has_value());
      auto wanted =
          expected(Pair::kRayTriangle, all_pairs(Pair::kRayTriangle, of_rays, swept.shapes, false),
                   swept.slots, bad_rays, Mode::kNearest, false);
      for (Record r : expected(Pair::kTriangleSphere,
                               all_pairs(Pair::kTriangleSphere, swept.shapes, of_balls, true),
                               swept.slots, bad_balls, Mode::kNearest, false)) {
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

TEST(ObjectDriver, AMoveUploadsTwelveWords) {
  Board board = Board::open(config_of(kMany));
  Random random;
  const Rays scene = rays(random, 40, 60);
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
    EXPECT_LE(board.time_ps() - start, 4'000'000u) << "a short transfer and the status, twice";
    check_pass(board, Pair::kRayTriangle, false, scene.primaries, scene.secondaries, posing,
               moving);
    EXPECT_EQ(board.words_uploaded() - words, 24u) << "a pass uploads nothing";
  }
}

/// Any range, also where it begins or ends within a beat of DDR; the neighbours stay.
TEST(ObjectDriver, PartOfTheSecondariesIsUploadedAgain) {
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
  board.load_shapes(std::span<const Plane>(planes));
  boxes[3] = shape<Obb>(random);
  board.update_shapes(3, std::span<const Obb>(boxes).subspan(3, 1));
  check_pass(board, Pair::kObbPlane, true, planes, boxes, {}, {}, {Mode::kAll});
}

template <class Statement>
void expect_error(ErrorCode code, const std::string& text, Statement statement) {
  try {
    statement();
    ADD_FAILURE() << "no error with '" << text << "'";
  } catch (const Error& e) {
    EXPECT_EQ(static_cast<int>(e.code()), static_cast<int>(code)) << e.what();
    EXPECT_NE(std::string(e.what()).find(text), std::string::npos) << e.what();
  }
}

TEST(ObjectDriver, RefusesWhatMakesNoSense) {
  BoardConfig config = config_of(kMany);
  config.objects = 8;
  EXPECT_THROW((void)config_of(kMany, Transformer::kNone).parameters().at(99), std::out_of_range);
  config.objects = 1;
  expect_error(ErrorCode::kUsage, "objects is 1", [&] { (void)config.parameters(); });
  Board board = Board::open(config_of(kMany));
  Random random;
  const Rays scene = rays(random, 10, 20);
  board.upload(scene.secondaries);
  board.load(scene.primaries);
  const auto set = [&](const Object& object) {
    return [&board, object] { board.set_objects(std::array{Object{0, 1, {}}, object}); };
  };
  const std::uint64_t words = board.words_uploaded();
  expect_error(ErrorCode::kUsage, "object 1 of secondaries: its range is empty", set({3, 0, {}}));
  expect_error(ErrorCode::kUsage, "slots 15 to 20 reach beyond the 20 uploaded", set({15, 6, {}}));
  expect_error(ErrorCode::kUsage, "beyond", set({0xffffffff, 2, {}}));
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
  expect_error(ErrorCode::kUsage, "slots 9 to 10 reach beyond the 10 loaded", [&] {
    board.set_primary_objects(std::array{Object{9, 2, {}}});
  });
  EXPECT_EQ(board.words_uploaded(), words) << "refused before the card was touched";
  board.set_objects(std::array{Object{12, 8, motion(random)}});
  expect_error(ErrorCode::kUsage, "there is no object 1",
               [&] { board.move_object(1, Transform{}); });
  expect_error(ErrorCode::kBadInput, "not orthonormal",
               [&] { board.move_object(0, Transform{Eigen::Matrix3f::Zero()}); });
  board.upload(std::span(scene.secondaries).first(15));
  expect_error(ErrorCode::kUsage, "slots 12 to 19 reach beyond the 15 uploaded",
               [&] { (void)board.run({.pair = Pair::kRayTriangle}); });
  board.set_objects({});
  EXPECT_EQ(board.run({.pair = Pair::kRayTriangle}).size(), 10u);
  expect_error(ErrorCode::kUsage, "no spheres were uploaded",
               [&] { board.update_shapes(0, std::span<const Sphere>()); });
  expect_error(ErrorCode::kUsage, "triangles 10 to 16 are not among the 15 uploaded", [&] {
    board.update_shapes(10, std::span<const Triangle>(scene.secondaries).first(7));
  });
}

TEST(ObjectDriver, AabbsAreNotRotated) {
  Board board = Board::open(config_of(kBoxes));
  Random random;
  const auto mesh = shapes<Triangle>(random, 10);
  const std::vector<Aabb> boxes{shape<Aabb>(random), shape<Aabb>(random)};
  const std::string text = "an AABB cannot be rotated on the card, it would become an OBB";
  board.upload_shapes(std::span<const Aabb>(boxes));
  board.load_shapes(std::span<const Triangle>(mesh));
  board.set_objects(std::array{Object{0, 2, {}}});
  expect_error(ErrorCode::kUsage, text, [&] { board.move_object(0, motion(random)); });
  board.set_primary_objects(std::array{Object{0, 10, motion(random)}});  // triangles turn
  EXPECT_EQ(board.run({}).size(), 10u);
  // Set for triangles, then there are boxes.
  board.upload_shapes(std::span<const Triangle>(mesh), false);
  board.load_shapes(std::span<const Aabb>(boxes));
  board.set_objects({});
  board.set_primary_objects(std::array{Object{0, 1, {}}});
  expect_error(ErrorCode::kUsage, text, [&] { board.move_primary_object(0, motion(random)); });
  // And the card by itself.
  const auto turned = to_words(motion(random));
  std::array<std::uint64_t, 6> beats;
  std::memcpy(beats.data(), turned.data(), sizeof beats);
  board.bus_write(kSpaceReg, kPrimObjectTable + 8, beats);
  expect_error(ErrorCode::kDevice, "command refused", [&] { (void)board.run({.swap = true}); });
}

TEST(ObjectDriver, CardsWithoutATransformerRefuse) {
  Random random;
  const Rays scene = rays(random, 10, 20);
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

/// The reference cast takes objects too.
TEST(ObjectDriver, CastsAreCheckedLikeOthers) {
  Board board = Board::open(config_of(kSlowHost));
  Random random;
  const Rays scene = rays(random, 600, 50);
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

// ---- The card over its bus ----

class ObjectTableBus : public ::testing::Test {
 protected:
  void SetUp() override {
    board_.upload(scene_.secondaries);
    board_.load(scene_.primaries);
    board_.write_register(kRegCommand, kModeNearest);
    board_.write_register(kRegPrimCount, scene_.primaries.size());
  }

  void write_range(std::uint32_t table, unsigned entry, std::uint32_t first, std::uint32_t count) {
    board_.write_register(table + entry * 64, std::uint64_t{count} << 32 | first);
  }
  void write_transform(std::uint32_t table, unsigned entry, const Transform& transform) {
    const auto words = to_words(transform);
    std::array<std::uint64_t, 6> beats;
    std::memcpy(beats.data(), words.data(), sizeof beats);
    board_.bus_write(kSpaceReg, table + entry * 64 + 8, beats);
  }
  /// Go at once: the verdict on the last transform may still be on its way.
  bool refused(std::uint64_t objects, std::uint64_t primary_objects = 0) {
    board_.write_register(kRegObjectCount, objects);
    board_.write_register(kRegPrimObjectCount, primary_objects);
    return go_is_refused();
  }
  bool go_is_refused() {
    board_.write_register(kRegControl, kControlGo);
    const std::uint64_t status = board_.read_register(kRegStatus);
    board_.write_register(kRegControl, kControlAbort | kControlClear);
    while ((board_.read_register(kRegStatus) & 1) != 0) {
    }
    board_.write_register(kRegControl, kControlAbort | kControlClear);
    return (status >> kStatusCommandError & 1) != 0;
  }

  Random random_;
  Rays scene_ = rays(random_, 20, 30);
  Board board_ = Board::open(config_of(kSlowHost));
};

TEST_F(ObjectTableBus, EntriesOutOfContractAreRefused) {
  EXPECT_TRUE(refused(0)) << "no range in the registers either";
  EXPECT_TRUE(refused(1)) << "never written";
  write_range(kObjectTable, 0, 0, 30);
  EXPECT_TRUE(refused(1)) << "no transform";
  write_transform(kObjectTable, 0, motion(random_));
  EXPECT_FALSE(refused(1));
  EXPECT_TRUE(refused(2));
  EXPECT_TRUE(refused(1025));
  EXPECT_TRUE(refused(~std::uint64_t{0}));
  EXPECT_TRUE(refused(std::uint64_t{1} << 32 | 1));
  write_transform(kObjectTable, 1, {});
  // 4,000 triangles fit DDR.
  struct Range {
    std::uint32_t first, count;
    bool fits;
  };
  for (const Range r : {Range{0, 4000, true},
                        {3999, 1, true},
                        {0, 4001, false},
                        {4000, 1, false},
                        {7, 0, false},
                        {0xffffffff, 1, false},
                        {0xffffffff, 2, false},
                        {0, 0xffffffff, false},
                        {0x80000000, 0x80000000, false}}) {
    write_range(kObjectTable, 1, r.first, r.count);
    EXPECT_EQ(refused(2), !r.fits) << r.first << " " << r.count;
  }
  write_range(kObjectTable, 1, 0, 1);
  // Go comes in the clock after the last word: it waits for the verdict.
  for (unsigned k = 0; k < 12; ++k) {
    for (const float x : {std::numeric_limits<float>::quiet_NaN(), 1.00001f, 3e38f}) {
      Transform transform = motion(random_);
      auto words = to_words(transform);
      words[k] = x;
      transform = from_words<Transform>(words);
      board_.write_register(kRegObjectCount, 2);
      write_transform(kObjectTable, 1, transform);
      EXPECT_EQ(go_is_refused(), defect(transform).has_value()) << k << " " << x;
      write_transform(kObjectTable, 1, {});
      EXPECT_FALSE(go_is_refused());
    }
  }
  // 256 primaries fit the register file.
  write_transform(kPrimObjectTable, 0, {});
  EXPECT_TRUE(refused(1, 1));
  write_range(kPrimObjectTable, 0, 255, 1);
  EXPECT_FALSE(refused(1, 1));
  write_range(kPrimObjectTable, 0, 255, 2);
  EXPECT_TRUE(refused(1, 1));
  EXPECT_FALSE(refused(1, 0));
}

TEST_F(ObjectTableBus, IsWrittenOnlyAndNotWhileBusy) {
  write_range(kObjectTable, 0, 0, 30);
  write_transform(kObjectTable, 0, {});
  const auto fault = [&] {
    const std::uint64_t status = board_.read_register(kRegStatus);
    const std::uint64_t address = board_.read_register(kRegFaultAddr);
    board_.write_register(kRegControl, kControlClear);
    return (status >> kStatusBusError & 1) != 0 ? address : 0;
  };
  EXPECT_EQ(board_.read_register(kObjectTable), 0u);
  EXPECT_EQ(fault(), kObjectTable);
  EXPECT_EQ(board_.read_register(kPrimObjectTable + 8), 0u);
  EXPECT_EQ(fault(), kPrimObjectTable + 8);
  for (const std::uint32_t offset :
       {kObjectTable + 1024 * 64, kPrimObjectTable + 64 * 64, kObjectTable - 8, kObjectTable + 4}) {
    board_.write_register(offset, 0);
    EXPECT_EQ(fault(), offset);
  }
  board_.write_register(kRegObjectCount, 1);
  board_.write_register(kRegControl, kControlGo);
  for (const std::uint32_t offset :
       {kObjectTable, kPrimObjectTable + 8, std::uint32_t{kRegObjectCount},
        std::uint32_t{kRegPrimObjectCount}}) {
    board_.write_register(offset, 0);
    EXPECT_EQ(fault(), offset);
  }
  EXPECT_EQ(board_.read_register(kRegStatus) & 1, 1u) << "the pass ended before the attack did";
  board_.wait(10000);
  EXPECT_EQ(board_.read_register(kRegRecords), 20u);
}

/// Whatever is written into the tables: the card answers, and the next scene is right.
TEST_F(ObjectTableBus, GarbageNeverHangsTheCard) {
  int started = 0;
  for (int round = 0; round < 200; ++round) {
    for (unsigned entry = 0; entry < 3; ++entry) {
      for (const std::uint32_t table : {kObjectTable, kPrimObjectTable}) {
        if (random_.below(4) != 0) write_transform(table, entry, motion(random_));
        if (random_.below(4) != 0) write_range(table, entry, random_.below(40), random_.below(30));
        if (random_.below(8) == 0) {
          const std::uint32_t beat = random_.below(8);
          board_.write_register(table + entry * 64 + beat * 8,
                                std::uint64_t{random_.bits()} << 32 | random_.bits());
        }
      }
    }
    board_.write_register(kRegObjectCount, random_.below(4));
    board_.write_register(kRegPrimObjectCount, random_.below(4));
    board_.write_register(kRegControl, kControlGo);
    board_.wait(random_.below(1500));
    started += (board_.read_register(kRegStatus) >> kStatusCommandError & 1) == 0 ? 1 : 0;
    board_.write_register(kRegControl, kControlAbort | kControlClear);
    for (int i = 0; i < 300 && (board_.read_register(kRegStatus) & 1) != 0; ++i) {
    }
    ASSERT_EQ(board_.read_register(kRegStatus) & 1, 0u);
    board_.write_register(kRegControl, kControlAbort | kControlClear);
  }
  EXPECT_GT(started, 20);
  const auto moving = objects(random_, 30, 5, false), posing = objects(random_, 20, 4, false);
  board_.set_objects(moving);
  board_.set_primary_objects(posing);
  check_pass(board_, Pair::kRayTriangle, false, scene_.primaries, scene_.secondaries, posing,
             moving);
}

/// Aborted in any clock of posing and sweeping, the next pass is right.
TEST_F(ObjectTableBus, AbortAtAnyTime) {
  std::vector<Object> moving = objects(random_, 30, 5, false),
                      posing = objects(random_, 20, 4, false);
  for (std::uint64_t clocks = 0; clocks < 700; clocks += clocks < 20 ? 1 : 23) {
    posing[1].transform = motion(random_);
    posing[2].count = 1;
    posing[2].first = random_.below(20);
    moving[3].transform = motion(random_);
    board_.set_objects(moving);
    board_.set_primary_objects(posing);
    board_.write_register(kRegObjectCount, moving.size());
    board_.write_register(kRegPrimObjectCount, posing.size());
    board_.write_register(kRegControl, kControlGo);
    board_.wait(clocks);
    board_.write_register(kRegControl, kControlAbort | kControlClear);
    while ((board_.read_register(kRegStatus) & 1) != 0) {
    }
    board_.write_register(kRegControl, kControlAbort | kControlClear);
    SCOPED_TRACE(clocks);
    check_pass(board_, Pair::kRayTriangle, false, scene_.primaries, scene_.secondaries, posing,
               moving, {Mode::kNearest, Mode::kAll});
  }
}

}  // namespace
}  // namespace cde::testing
