// SPDX-License-Identifier: Apache-2.0
// Cards with a certified filter. Records equal the reference in every mode. The wide lane gets
// exactly the pairs that the mirror of the filter leaves uncertain.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <span>
#include <vector>

#include "cde/fp/scalars.hpp"
#include "cde/reference/filter/proposal.hpp"
#include "pair_records.hpp"

namespace cde::testing {
namespace {

class Shapes {
 public:
  explicit Shapes(unsigned seed) : random_(seed) {}
  void next(Sphere& x) { x = {point(), size_(random_)}; }
  void next(Triangle& x) {
    const Eigen::Vector3f at = point();
    const auto corner = [&] { return Eigen::Vector3f(at + 0.3f * point()); };
    x = {corner(), corner(), corner()};
  }
  void next(Aabb& x) {
    const Eigen::Vector3f low = point();
    x = {low, low + Eigen::Vector3f(size_(random_), size_(random_), size_(random_))};
  }
  void next(Obb& x) {
    const Eigen::Vector3f c = point(), half(size_(random_), size_(random_), size_(random_));
    const Eigen::Quaterniond turn(at_(random_), at_(random_), at_(random_), at_(random_));
    x = {c, half, turn.normalized().toRotationMatrix().cast<float>()};
  }

 private:
  Eigen::Vector3f point() { return {at_(random_), at_(random_), at_(random_)}; }
  std::mt19937 random_;
  std::uniform_real_distribution<float> at_{-4, 4}, size_{0.1f, 1.5f};
};

template <class A_, class B_, Pair kPair_>
struct Bodies {
  using A = A_;
  using B = B_;
  static constexpr Pair kPair = kPair_;
};
using All = ::testing::Types<
    Bodies<Sphere, Sphere, Pair::kSphereSphere>, Bodies<Triangle, Sphere, Pair::kTriangleSphere>,
    Bodies<Sphere, Obb, Pair::kSphereObb>, Bodies<Triangle, Aabb, Pair::kTriangleAabb>,
    Bodies<Triangle, Obb, Pair::kTriangleObb>, Bodies<Obb, Obb, Pair::kObbObb>>;

constexpr Pair kSpheres = Pair::kSphereSphere;

/// A card with fp16 filter lanes before an fp32 lane.
BoardConfig narrow_first(Arithmetic arithmetic, unsigned lanes, std::vector<Pair> pairs) {
  BoardConfig c{.lanes = lanes, .arithmetic = arithmetic, .pairs = std::move(pairs)};
  c.filter = FpFormat::parse("fp16");
  c.ddr_slots = 1000;
  c.sram_records = 64;
  return c;
}

/// With operators of several cycles.
BoardConfig slow(BoardConfig c) {
  c.latency.add = c.latency.compare = 2;
  c.latency.mul = 3;
  c.latency.div = 9;
  return c;
}

template <class P>
std::vector<P> shapes(std::size_t count, unsigned seed) {
  Shapes random(seed);
  std::vector<P> all(count);
  for (P& x : all) random.next(x);
  return all;
}

/// Pairs with valid operands, and the uncertain pairs among them.
struct Pairs {
  std::uint64_t good = 0, uncertain = 0;
};
template <class A, class B>
Pairs pairs_of(const std::vector<A>& a, const std::vector<B>& b) {
  Pairs pairs;
  for (const A& x : a)
    for (const B& y : b) {
      if (defect(x) || defect(y)) continue;
      const auto claim = reference::filter::propose<Fp16>(x, y, reference::filter::FreePipe());
      const reference::filter::Body body_a(x);
      const reference::filter::Body body_b(y);
      const bool miss = reference::filter::separates(
          body_a, body_b, claim.n, reference::filter::size_of_pair(body_a, body_b));
      ++pairs.good;
      pairs.uncertain += miss ? 0 : 1;
    }
  return pairs;
}

/// Every mode. Modes that need misses run before and after modes that do not.
constexpr Mode kModes[] = {Mode::kHits,     Mode::kAny, Mode::kNearest,
                           Mode::kFarthest, Mode::kAll, Mode::kHits};

/// Loads the shapes, also with swapped roles, and compares every record and REG_UNCERTAIN with the
/// references.
template <class A, class B>
void check(Board& board, Pair pair, const std::vector<A>& a, const std::vector<B>& b,
           Query query = {}) {
  const std::vector<PairResult> results = all_pairs(pair, a, b, query.swap);
  const std::vector<bool> bad = load_shapes(board, a, b, query.swap);
  const std::vector<std::uint32_t> slots = in_order(query.swap ? a.size() : b.size());
  const Pairs pairs = pairs_of(a, b);
  query.pair = pair;
  for (const Mode mode : kModes) {
    SCOPED_TRACE(name_of(mode));
    Counters counters;
    query.mode = mode;
    const auto records = board.run(query, &counters);
    compare(records, expected(pair, results, slots, bad, mode, query.normals), mode);
    if (mode != Mode::kAny) {  // kAny stops testing a primary after its first hit
      EXPECT_EQ(counters.uncertain, mode == Mode::kHits ? pairs.uncertain : pairs.good);
    }
  }
}

template <class T>
class CertifiedFilter : public ::testing::Test {};
TYPED_TEST_SUITE(CertifiedFilter, All);

TYPED_TEST(CertifiedFilter, AllModes_EqualWideLanes) {
  Board board = Board::open(narrow_first(Arithmetic::kHost, 8, {TypeParam::kPair}));
  check(board, TypeParam::kPair, shapes<typename TypeParam::A>(37, 1),
        shapes<typename TypeParam::B>(61, 2));
}

std::vector<Sphere> spheres(std::size_t count, unsigned seed) {
  std::vector<Sphere> all = shapes<Sphere>(count, seed);
  all[count / 2].r = -1;
  all[count / 3].c.x() = std::numeric_limits<float>::infinity();
  return all;
}

TEST(CertifiedFilterCards, Gates_AnswerTheSame) {
  Board board = Board::open(narrow_first(Arithmetic::kRtl, 2, {kSpheres}));
  check(board, kSpheres, spheres(37, 1), spheres(61, 2));
}

TEST(CertifiedFilterCards, SlowOperators_EqualTheReference) {
  for (const Arithmetic arithmetic : {Arithmetic::kHost, Arithmetic::kRtl}) {
    Board board = Board::open(slow(narrow_first(arithmetic, 2, {kSpheres})));
    check(board, kSpheres, spheres(37, 1), spheres(61, 2));
  }
}

/// Several pairs, swapped roles, normals, and a record ring that is drained slowly. 200 secondaries
/// whose pairs are all uncertain fill the slots where rows wait for the wide lane.
TEST(CertifiedFilterCards, SeveralPairsUnderPressure_EqualTheReference) {
  BoardConfig config = slow(narrow_first(Arithmetic::kHost, 8, {kSpheres, Pair::kSphereObb}));
  config.pairs.push_back(Pair::kRayTriangle);
  config.swap = config.normals = true;
  Board board = Board::open(config);
  const std::vector<Sphere> few = spheres(90, 1), many = spheres(200, 2);
  const std::vector<Obb> boxes = shapes<Obb>(50, 3);
  for (const std::uint32_t drain : {1u, 64u})
    for (const bool swap : {false, true}) {
      check(board, kSpheres, few, many, {.swap = swap, .normals = swap, .drain_records = drain});
      check(board, Pair::kSphereObb, few, boxes,
            {.swap = swap, .normals = !swap, .drain_records = drain});
    }
}

/// Below 2^length_low the filter does not scale a pair up, and the wide pipe treats small lengths
/// as zero. It then finds hits where the filter would prove a miss.
TEST(CertifiedFilterCards, TooSmallPairs_ProveNothing) {
  constexpr Pair kPair = Pair::kTriangleAabb;
  Board board = Board::open(narrow_first(Arithmetic::kHost, 8, {kPair}));
  for (const int exponent : {-30, -34, -40, -100, -127, -135}) {
    SCOPED_TRACE(exponent);
    std::vector<Triangle> a = shapes<Triangle>(37, 1);
    std::vector<Aabb> b = shapes<Aabb>(61, 2);
    const float scale = std::ldexp(1.0f, exponent);
    for (Triangle& x : a) x = {x.v0 * scale, x.v1 * scale, x.v2 * scale};
    for (Aabb& x : b) x = {x.min * scale, x.max * scale};
    check(board, kPair, a, b);
  }
}

/// The slowest adders make the filter, its proof and the wide pipe as deep as possible.
TEST(CertifiedFilterCards, SlowAdders_EqualTheReference) {
  BoardConfig config = narrow_first(Arithmetic::kHost, 2, {Pair::kTriangleObb});
  config.latency.add = 16;
  Board board = Board::open(config);
  check(board, Pair::kTriangleObb, shapes<Triangle>(9, 1), shapes<Obb>(150, 2));
}

/// Two such pairs in one pass have the records of two passes.
TEST(CertifiedFilterCards, TwoParallelPairs_EqualTwoPasses) {
  BoardConfig config =
      narrow_first(Arithmetic::kHost, 8, {kSpheres, Pair::kSphereObb, Pair::kTriangleSphere});
  config.swap = config.parallel = true;
  Board board = Board::open(config);
  const std::vector<Sphere> primaries = spheres(40, 1), secondaries = spheres(150, 2);
  const std::vector<Triangle> triangles = shapes<Triangle>(30, 3);
  board.upload_shapes(std::span<const Sphere>(secondaries), false);
  for (const Mode mode : {Mode::kNearest, Mode::kFarthest, Mode::kAny}) {
    SCOPED_TRACE(name_of(mode));
    Counters alone, other, together;
    board.load_shapes(std::span<const Sphere>(primaries), false);
    std::vector<Record> wanted = board.run({.mode = mode, .pair = kSpheres}, &alone);
    board.load_shapes(std::span<const Triangle>(triangles), false);
    for (Record r : board.run({.mode = mode, .pair = Pair::kTriangleSphere}, &other)) {
      r.primary += static_cast<std::uint32_t>(primaries.size());
      wanted.push_back(r);
    }
    board.load_shapes(std::span<const Sphere>(primaries), false);
    board.load_second_shapes(std::span<const Triangle>(triangles), false);
    compare(
        board.run(
            {.mode = mode, .pair = kSpheres, .second = SecondPair{Pair::kTriangleSphere, false}},
            &together),
        wanted, mode);
    if (mode != Mode::kAny) {
      EXPECT_EQ(together.uncertain, alone.uncertain + other.uncertain);
    }
  }
}

/// Masked primaries are not tested, so their pairs are not uncertain.
TEST(CertifiedFilterCards, MaskedPrimaries_AreNotUncertain) {
  Board board = Board::open(narrow_first(Arithmetic::kHost, 8, {kSpheres}));
  const std::vector<Sphere> few = shapes<Sphere>(37, 1), many = shapes<Sphere>(61, 2);
  board.upload_shapes(std::span<const Sphere>(many));
  board.load_shapes(std::span<const Sphere>(few));
  Query query{.mode = Mode::kAll, .pair = kSpheres};
  for (std::size_t i = 1; i < few.size(); ++i) query.stencil.set(i);
  Counters counters;
  EXPECT_EQ(board.run(query, &counters).size(), many.size());
  EXPECT_EQ(counters.uncertain, many.size());
}

}  // namespace
}  // namespace cde::testing
