// SPDX-License-Identifier: Apache-2.0
// Cards with pipes other than ray-triangle, and with several pipes. Every record is bit-identical
// to the mirror references: in every mode, with swapped roles and with normals. The pipes run one
// after the other without loading again.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "../printed.hpp"
#include "cde/card/board.hpp"
#include "cde/support/error.hpp"
#include "pair_records.hpp"

namespace cde {
namespace {

using namespace testing;

constexpr unsigned kSeed = 7;

template <class A, class B>
void check_all_modes(Board& board, Pair pair, const std::vector<A>& a, const std::vector<B>& b,
                     bool swap, bool normals, const PairIterations& iterations = {}) {
  const std::vector<PairResult> results = all_pairs(pair, a, b, swap, iterations);
  const std::vector<bool> bad = load_shapes(board, a, b, swap);
  const std::vector<std::uint32_t> slots = in_order(swap ? a.size() : b.size());
  for (const Mode mode : {Mode::kNearest, Mode::kFarthest, Mode::kAny, Mode::kAll, Mode::kHits}) {
    Query query{
        .mode = mode, .pair = pair, .swap = swap, .normals = normals, .iterations = iterations};
    compare(board.run(query), expected(pair, results, slots, bad, mode, normals), mode);
  }
}

struct SolidScene {
  std::vector<Sphere> few, many;
  std::vector<Ray> rays;
  std::vector<Triangle> triangles;
};

SolidScene scene() {
  SolidScene s;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> at(-4, 4), size(0.1f, 1.5f);
  const auto point = [&] { return Eigen::Vector3f(at(random), at(random), at(random)); };
  for (int i = 0; i < 40; ++i) s.few.push_back({point(), size(random)});
  for (int i = 0; i < 97; ++i) s.many.push_back({point(), size(random)});
  for (int i = 0; i < 40; ++i) s.rays.push_back({point(), point()});
  for (int i = 0; i < 61; ++i) s.triangles.push_back({point(), point(), point()});
  s.few[11].r = -1;
  s.many[5].r = 0;
  s.many[2].r = -1;  // its words would be a good ray
  s.many[60].c.x() = std::numeric_limits<float>::quiet_NaN();
  s.rays[3].d.setZero();
  s.triangles[7].v1.y() = std::numeric_limits<float>::infinity();
  return s;
}

BoardConfig small(Arithmetic arithmetic) {
  BoardConfig c;
  c.lanes = arithmetic == Arithmetic::kRtl ? 2 : 8;  // gates take longer to build
  c.arithmetic = arithmetic;
  c.ddr_slots = 1000;
  c.sram_records = 64;
  return c;
}

class Solids : public ::testing::TestWithParam<Arithmetic> {};

TEST_P(Solids, SwappedSpheresWithNormals_EqualTheReference) {
  BoardConfig config = small(GetParam());
  config.pairs = {Pair::kSphereSphere};
  config.swap = config.normals = true;
  Board board = Board::open(config);
  const SolidScene s = scene();
  for (const bool swap : {false, true})
    for (const bool normals : {false, true})
      check_all_modes(board, Pair::kSphereSphere, s.few, s.many, swap, normals);
}

TEST_P(Solids, PipesOneAfterTheOther_EqualTheReference) {
  BoardConfig config = small(GetParam());
  config.pairs = {Pair::kRayTriangle, Pair::kSphereSphere};
  Board board = Board::open(config);
  const SolidScene s = scene();
  check_all_modes(board, Pair::kRayTriangle, s.rays, s.triangles, false, false);
  check_all_modes(board, Pair::kSphereSphere, s.few, s.many, false, false);
  check_all_modes(board, Pair::kRayTriangle, s.rays, s.triangles, false, false);
}

std::vector<Cylinder> cylinders(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> at(-2, 2), size(0.2f, 1.0f);
  const auto point = [&] { return Eigen::Vector3f(at(random), at(random), at(random)); };
  std::vector<Cylinder> all;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3f c = point(), axis = point().cast<double>().normalized().cast<float>();
    const float half = size(random);
    all.push_back({c, axis, half, size(random)});
  }
  return all;
}

/// An iterative pipeline: rows wait at its input port. Each row takes one cycle per iteration, and
/// the query sets the iterations.
TEST_P(Solids, Cylinders_UseTheQuerysIterations) {
  BoardConfig config = small(GetParam());
  const bool gates = GetParam() == Arithmetic::kRtl;
  config.pairs = {Pair::kCylinderCylinder};
  config.normals = true;
  if (gates) config.lanes = 1;  // one lane of an iterative pipeline takes a minute to build
  Board board = Board::open(config);
  std::vector<Cylinder> few = cylinders(gates ? 5 : 19, 1), many = cylinders(gates ? 7 : 43, 2);
  few[2].radius = -1;
  many[4].axis *= 2;
  for (const PairIterations iterations :
       {PairIterations{}, PairIterations{4, 2, 2}, PairIterations{4, 0, 0}})
    check_all_modes(board, Pair::kCylinderCylinder, few, many, false, true, iterations);
  EXPECT_THROW((void)board.run({.iterations = {5, 1, 1}}), Error);
  if (gates) return;
  // 14 + 2 K1 + 3 K2 evaluations and 9 loops for the witness points, over all rows in flight.
  Counters counters;
  const std::vector<Cylinder> lots = cylinders(800, 3), row = cylinders(8, 4);
  board.upload_shapes(std::span<const Cylinder>(lots));
  board.load_shapes(std::span<const Cylinder>(row));
  (void)board.run({.iterations = {8, 8, 8}}, &counters);
  const double per_row = static_cast<double>(counters.cycles) / 800;
  EXPECT_GE(per_row, 63);
  EXPECT_LE(per_row, 63 * 1.2) << "at most 20% for the last loop of the pipeline";
  EXPECT_EQ(counters.rows, 800u);
  EXPECT_GT(counters.stalls, 0u);
}

std::vector<Obb> boxes(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> at(-2, 2), size(0.2f, 1.0f);
  const auto point = [&] { return Eigen::Vector3f(at(random), at(random), at(random)); };
  std::vector<Obb> all;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3f c = point(), half(size(random), size(random), size(random));
    const Eigen::Quaterniond turn(at(random), at(random), at(random), at(random));
    all.push_back({c, half, turn.normalized().toRotationMatrix().cast<float>()});
  }
  return all;
}

Board board_of_boxes(Arithmetic arithmetic, unsigned interval) {
  BoardConfig config = small(arithmetic);
  config.pairs = {Pair::kSphereSphere, Pair::kObbObb};
  config.normals = true;
  config.sat_interval = interval;
  if (arithmetic == Arithmetic::kRtl) config.lanes = 1;  // takes a minute to build
  return Board::open(config);
}

/// With SAT_II > 1 the candidate axes share hardware: the same records, three cycles per row,
/// counted as stalls.
TEST(SolidsSatInterval, SharedCandidateAxes_TakeThreeCyclesPerRow) {
  std::vector<Obb> few = boxes(19, 1), many = boxes(43, 2);
  few[2].half.x() = -1;
  many[4].rotation *= 2;
  std::vector<Counters> counters;
  std::vector<std::vector<Record>> records;
  for (const unsigned interval : {1u, 3u}) {
    Board board = board_of_boxes(Arithmetic::kHost, interval);
    check_all_modes(board, Pair::kObbObb, few, many, false, true);
    records.push_back(
        board.run({.pair = Pair::kObbObb, .normals = true}, &counters.emplace_back()));
  }
  compare(records[1], records[0], Mode::kNearest);
  const std::uint64_t rows = 3 * many.size();
  EXPECT_EQ(counters[0].rows, rows);
  EXPECT_EQ(counters[1].rows, rows);
  EXPECT_EQ(counters[0].stalls, 0u);
  EXPECT_EQ(counters[1].stalls, 2 * (rows - 1)) << "two cycles after every row except the last";
  EXPECT_EQ(counters[1].bubbles, counters[0].bubbles) << "idle until the first box arrives";
  EXPECT_EQ(counters[1].cycles - counters[0].cycles, 2 * (rows - 1) + 3)
      << "the pipe latency grows by three cycles";
}

TEST_P(Solids, SharedCandidateAxes_DelayOnlyTheirPairs) {
  Board board = board_of_boxes(GetParam(), 3);
  const bool gates = GetParam() == Arithmetic::kRtl;
  const std::vector<Obb> few = boxes(gates ? 6 : 19, 1), many = boxes(gates ? 9 : 43, 2);
  const SolidScene s = scene();
  for (int round = 0; round < 2; ++round) {
    Counters counters;
    check_all_modes(board, Pair::kObbObb, few, many, false, true);
    (void)board.run({.pair = Pair::kObbObb}, &counters);
    EXPECT_EQ(counters.stalls, 2 * (counters.rows - 1));
    check_all_modes(board, Pair::kSphereSphere, s.few, s.many, false, false);
    (void)board.run({.pair = Pair::kSphereSphere}, &counters);
    EXPECT_EQ(counters.stalls, 0u);
  }
}

TEST(SolidsIterativePipe, IterationsOutOfRange_AreRefused) {
  BoardConfig config = small(Arithmetic::kHost);
  config.pairs = {Pair::kCylinderCylinder};
  config.normals = true;
  Board board = Board::open(config);
  const std::vector<Cylinder> some = cylinders(3, 1);
  board.upload_shapes(std::span<const Cylinder>(some));
  board.load_shapes(std::span<const Cylinder>(some));
  (void)board.run({});
  const auto refused = [&](std::uint64_t iterations) {
    board.write_register(card::kRegControl, card::kControlClear);
    board.write_register(card::kRegIterations, iterations);
    board.write_register(card::kRegControl, card::kControlGo);
    return (board.read_register(card::kRegStatus) >> card::kStatusCommandError & 1) != 0;
  };
  for (const std::uint64_t iterations : {0x080800u, 0x080805u, 0x084108u, 0x410808u, 0xffffffffu})
    EXPECT_TRUE(refused(iterations)) << std::hex << iterations;
  EXPECT_TRUE(refused(std::uint64_t{1} << 32 | 0x080808));
  EXPECT_FALSE(refused(0x404010)) << "the most iterations";
  board.wait(1000000);
  board.write_register(card::kRegControl, card::kControlAbort | card::kControlClear);
  EXPECT_EQ(board.run({}).size(), some.size());
}

/// The same with other pipes: after a register, one cycle before its operands.
TEST(SolidsIterativePipe, BesideAnotherPipe_EqualsTheReference) {
  BoardConfig config = small(Arithmetic::kHost);
  config.pairs = {Pair::kSphereSphere, Pair::kCylinderCylinder};
  Board board = Board::open(config);
  const SolidScene s = scene();
  const std::vector<Cylinder> few = cylinders(20, 1), many = cylinders(30, 2);
  for (int round = 0; round < 2; ++round) {
    check_all_modes(board, Pair::kCylinderCylinder, few, many, false, false, {4, 1, 1});
    check_all_modes(board, Pair::kSphereSphere, s.few, s.many, false, false);
  }
}

/// Rays and spheres meet a mesh in one pass, each in its own pipe. The records equal the records
/// of two passes, and the cycles equal the longer one.
TEST_P(Solids, TwoParallelPipes_EqualTwoPasses) {
  BoardConfig config = small(GetParam());
  config.pairs = {Pair::kRayTriangle, Pair::kTriangleSphere};
  config.swap = config.parallel = true;
  Board board = Board::open(config);
  const SolidScene s = scene();
  const std::span<const Ray> rays(s.rays);
  for (const std::size_t spheres : {s.few.size(), std::size_t{3}, s.many.size()}) {
    const std::vector<Sphere> balls(s.many.begin(),
                                    s.many.begin() + static_cast<std::ptrdiff_t>(spheres));
    board.upload_shapes(std::span<const Triangle>(s.triangles), false);
    for (const Mode mode : {Mode::kNearest, Mode::kFarthest, Mode::kAny}) {
      Counters of_rays, of_spheres, together;
      Query query{.mode = mode, .pair = Pair::kRayTriangle};
      query.stencil.set(2);
      board.load(rays);
      std::vector<Record> expected = board.run(query, &of_rays);
      query.pair = Pair::kTriangleSphere;
      query.swap = true;
      board.load_shapes(std::span<const Sphere>(balls), false);
      for (Record r : board.run(query, &of_spheres)) {
        r.primary += static_cast<std::uint32_t>(rays.size());
        expected.push_back(r);
      }
      board.load(rays);
      board.load_second_shapes(std::span<const Sphere>(balls), false);
      query = {.mode = mode,
               .pair = Pair::kRayTriangle,
               .second = SecondPair{Pair::kTriangleSphere, true}};
      query.stencil.set(2).set(rays.size() + 2);
      compare(board.run(query, &together), expected, mode);
      EXPECT_EQ(together.bad_primaries, of_rays.bad_primaries + of_spheres.bad_primaries);
      if (mode == Mode::kAny) continue;  // a pass ends when the last primary has its hit
      EXPECT_EQ(together.rows, of_rays.rows + of_spheres.rows);
      // Rows run side by side. The deeper pipe drains last, unless its last row came earlier.
      const auto rest = [](const Counters& c) { return c.cycles - c.rows; };
      EXPECT_GE(together.cycles, std::max(of_rays.cycles, of_spheres.cycles));
      EXPECT_LE(together.cycles, std::max(of_rays.rows, of_spheres.rows) +
                                     std::max(rest(of_rays), rest(of_spheres)));
    }
    // The first pair alone still works.
    EXPECT_EQ(board.run({.pair = Pair::kRayTriangle}).size(), rays.size());
  }
}

INSTANTIATE_TEST_SUITE_P(Arithmetic, Solids, ::testing::Values(Arithmetic::kHost, Arithmetic::kRtl),
                         [](const auto& info) {
                           return info.param == Arithmetic::kHost ? "host" : "rtl";
                         });

TEST(SolidsDriver, UnfittingRequests_AreRefused) {
  BoardConfig config = small(Arithmetic::kHost);
  config.pairs = {Pair::kRayTriangle, Pair::kSphereSphere};
  Board board = Board::open(config);
  const SolidScene s = scene();
  const auto message = [&](const Query& query) -> std::string {
    try {
      (void)board.run(query);
    } catch (const Error& e) {
      return e.what();
    }
    return "no error";
  };
  board.upload(s.many.empty() ? std::vector<Triangle>{} : std::vector<Triangle>{s.triangles[0]});
  board.load(s.rays);
  EXPECT_NE(message({}).find("must name its pair"), std::string::npos);
  EXPECT_NE(message({.pair = Pair::kObbObb}).find("no pipe for obb-obb"), std::string::npos);
  EXPECT_NE(message({.pair = Pair::kSphereSphere}).find("needs loaded spheres"), std::string::npos);
  EXPECT_NE(message({.pair = Pair::kRayTriangle, .swap = true}).find("exchange"),
            std::string::npos);
  EXPECT_NE(message({.pair = Pair::kRayTriangle, .normals = true}).find("normals"),
            std::string::npos);
  EXPECT_EQ(board.run({.pair = Pair::kRayTriangle}).size(), s.rays.size());
  EXPECT_NE(message({.pair = Pair::kRayTriangle, .second = SecondPair{Pair::kSphereSphere}})
                .find("one pair at a time"),
            std::string::npos);
  EXPECT_THROW(board.load_second_shapes(std::span<const Sphere>(s.few)), Error);
  EXPECT_THROW(board.load_shapes(std::span<const Obb>(std::vector<Obb>(1))), Error);
  EXPECT_THROW(board.upload_shapes(std::span<const Sphere>(s.many)), Error) << "a bad sphere";
}

TEST(SolidsDriver, ShapesOutOfContract_AreErrorsOfEveryLoad) {
  BoardConfig config = small(Arithmetic::kHost);
  config.pairs = {Pair::kRayTriangle, Pair::kTriangleSphere};
  config.swap = config.parallel = true;
  Board board = Board::open(config);
  const SolidScene s = scene();
  board.upload(std::vector<Triangle>(s.triangles.begin(), s.triangles.begin() + 5));
  std::vector<Sphere> balls(4, Sphere{{1, 2, 3}, 1});
  balls[2].r = -1;
  const Query query{.pair = Pair::kTriangleSphere, .swap = true};
  const auto refused = [](const char* what, const std::function<void()>& call) {
    SCOPED_TRACE(what);
    try {
      call();
      ADD_FAILURE() << "not refused";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::kBadInput);
      EXPECT_EQ(std::string(e.what()).find("sphere 2: "), 0u) << e.what();
    }
  };
  refused("load_shapes", [&] { board.load_shapes<Sphere>(balls); });
  refused("cast_shapes", [&] { (void)board.cast_shapes<Sphere>(balls, query, [](auto) {}); });
  board.load(s.rays);
  refused("load_second_shapes", [&] { board.load_second_shapes<Sphere>(balls); });
  board.load_shapes<Sphere>(balls, false);
  const std::vector<Record> records = board.run(query);
  ASSERT_EQ(records.size(), balls.size());
  for (std::size_t i = 0; i < records.size(); ++i) EXPECT_EQ(records[i].bad, i == 2);
}

TEST(SolidsDriver, UnfittingSecondPairs_AreRefused) {
  BoardConfig config = small(Arithmetic::kHost);
  config.pairs = {Pair::kRayTriangle, Pair::kTriangleSphere};
  config.swap = config.parallel = true;
  Board board = Board::open(config);
  const SolidScene s = scene();
  const std::vector<Sphere> balls(s.few.begin(), s.few.begin() + 4);
  const auto refused = [&](const Query& query, const char* why) {
    try {
      (void)board.run(query);
      ADD_FAILURE() << "not refused: " << why;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::kUsage);
      EXPECT_NE(std::string(e.what()).find(why), std::string::npos) << e.what();
    }
  };
  board.upload(std::vector<Triangle>(s.triangles.begin(), s.triangles.begin() + 5));
  EXPECT_THROW(board.load_second_shapes(std::span<const Sphere>(balls)), Error) << "no first";
  board.load(s.rays);
  Query query{.pair = Pair::kRayTriangle, .second = SecondPair{Pair::kTriangleSphere, true}};
  refused(query, "no primaries were loaded for the second");
  EXPECT_THROW(board.load_second_shapes(std::span<const Sphere>(std::vector<Sphere>(250))), Error)
      << "more than the card holds";
  board.load_second_shapes(std::span<const Sphere>(balls));
  EXPECT_EQ(board.run(query).size(), s.rays.size() + balls.size());
  query.mode = Mode::kAll;
  refused(query, "nearest, farthest or any");
  query.mode = Mode::kNearest;
  query.second->swap = false;
  refused(query, "needs loaded triangles");
  query.second = SecondPair{Pair::kRayTriangle};
  refused(query, "not two");
  query.second = SecondPair{Pair::kObbObb};
  refused(query, "no pipe for obb-obb");
  // The card itself refuses commands that a driver could get wrong.
  const auto command = [&](std::uint64_t split, std::uint64_t bits) {
    board.write_register(card::kRegControl, card::kControlClear);
    board.write_register(card::kRegPrimCount, 44);
    board.write_register(card::kRegPrimSplit, split);
    board.write_register(card::kRegSecFirst, 0);
    board.write_register(card::kRegSecCount, 5);
    board.write_register(card::kRegCommand, bits | card::kCommandSecond);
    board.write_register(card::kRegControl, card::kControlGo);
    return (board.read_register(card::kRegStatus) >> card::kStatusCommandError & 1) != 0;
  };
  const std::uint64_t good =
      card::kCommandSecondSwap | card::kCommandSecondPair(Pair::kTriangleSphere);
  for (const std::uint64_t split : {0u, 7u, 44u, 48u, ~0u})
    EXPECT_TRUE(command(split, good)) << split;
  EXPECT_TRUE(command(40, good | card::kModeAll));
  EXPECT_TRUE(command(40, card::kCommandSecondSwap | card::kCommandSecondPair(Pair::kSphereSphere)))
      << "no such pipe";
  EXPECT_TRUE(command(40, card::kCommandSecondPair(Pair::kTriangleSphere)))
      << "the pairs have different secondaries";
  EXPECT_FALSE(command(40, good));
  board.wait(100000);
}

}  // namespace
}  // namespace cde
