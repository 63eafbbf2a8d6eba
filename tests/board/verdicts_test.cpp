// SPDX-License-Identifier: Apache-2.0
// Cards whose narrow lanes prove misses (BoardConfig::verdicts): records are those of the reference
// in every mode, and what the wide lane took is what the mirror of the narrow lanes leaves open.
#include <gtest/gtest.h>

#include <random>
#include <span>
#include <vector>

#include "cde/fp/scalars.hpp"
#include "cde/reference/verdict/proposal.hpp"
#include "pair_records.hpp"

namespace cde::testing {
namespace {

using reference::Vector;

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

template <class T>
class Verdicts : public ::testing::Test {
 public:
  using A = typename T::A;
  using B = typename T::B;
  std::vector<A> a = std::vector<A>(37);
  std::vector<B> b = std::vector<B>(61);

  Verdicts() {
    Shapes shapes(1);
    for (A& x : a) shapes.next(x);
    for (B& x : b) shapes.next(x);
  }

  static BoardConfig config(Arithmetic arithmetic, unsigned lanes) {
    BoardConfig c{.lanes = lanes, .arithmetic = arithmetic, .pairs = {T::kPair}};
    c.verdicts = FpFormat::parse("fp16");
    c.ddr_slots = 1000;
    c.sram_records = 64;
    return c;
  }

  std::uint64_t left_open() const {
    using N = Fp16;
    std::uint64_t open = 0;
    for (const A& x : a)
      for (const B& y : b) {
        if (defect(x) || defect(y)) continue;
        const auto claim = reference::verdict::propose<N>(x, y, reference::verdict::FreePipe());
        open += reference::verdict::separates(reference::verdict::Body(x),
                                              reference::verdict::Body(y), claim.n)
                    ? 0
                    : 1;
      }
    return open;
  }

  void check(Board& board) {
    const std::vector<PairResult> results = all_pairs(T::kPair, a, b, false);
    std::vector<bool> bad;
    for (const A& x : a) bad.push_back(defect(x).has_value());
    board.upload_shapes(std::span<const B>(b), false);
    board.load_shapes(std::span<const A>(a));
    const std::vector<std::uint32_t> slots = in_order(b.size());
    std::uint64_t good = 0;
    for (const A& x : a)
      for (const B& y : b) good += !defect(x) && !defect(y);
    for (const Mode mode :
         {Mode::kHits, Mode::kAny, Mode::kNearest, Mode::kFarthest, Mode::kAll, Mode::kHits}) {
      Counters counters;
      const auto records = board.run({.mode = mode, .pair = T::kPair}, &counters);
      compare(records, expected(T::kPair, results, slots, bad, mode, false), mode);
      if (mode == Mode::kHits)
        EXPECT_EQ(counters.open, left_open());
      else if (mode != Mode::kAny)
        EXPECT_EQ(counters.open, good);
    }
  }
};
TYPED_TEST_SUITE(Verdicts, All);

TYPED_TEST(Verdicts, RecordsAreThoseOfWideLanes) {
  Board board = Board::open(this->config(Arithmetic::kHost, 8));
  this->check(board);
}

using OfSpheres = Verdicts<Bodies<Sphere, Sphere, Pair::kSphereSphere>>;
TEST_F(OfSpheres, GatesAnswerTheSame) {
  Board board = Board::open(config(Arithmetic::kRtl, 4));
  check(board);
}

}  // namespace
}  // namespace cde::testing
