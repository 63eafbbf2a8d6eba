// SPDX-License-Identifier: Apache-2.0
// Certified filters (docs/background/certified_filters.md). For any proposal, every certain answer
// is true, and the rounding of the deciding value is within its bound.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <limits>
#include <random>
#include <vector>

#include "cde/accuracy/filter_pairs.hpp"
#include "cde/oracle/families.hpp"
#include "cde/oracle/oracle.hpp"
#include "cde/reference/filter/proposal.hpp"
#include "counted.hpp"
#include "in_docs.hpp"
#include "operators.hpp"

namespace cde::reference::filter {
namespace {

constexpr double kU = 0x1p-24;
constexpr std::uint64_t kSeed = 20261125;

template <class P>
P shape_of(const std::vector<double>& words) {
  std::array<typename P::Scalar, P::kWords> of;
  std::ranges::transform(words, of.begin(),
                         [](double x) { return static_cast<typename P::Scalar>(x); });
  return from_words<P>(of);
}

template <template <class> class A_, template <class> class B_, Pair kPair_>
struct Bodies {
  template <class S>
  using A = A_<S>;
  template <class S>
  using B = B_<S>;
  static constexpr Pair kPair = kPair_;
};
using AllBodies = ::testing::Types<Bodies<BasicSphere, BasicSphere, Pair::kSphereSphere>,
                                   Bodies<BasicSphere, BasicObb, Pair::kSphereObb>,
                                   Bodies<BasicTriangle, BasicSphere, Pair::kTriangleSphere>,
                                   Bodies<BasicTriangle, BasicAabb, Pair::kTriangleAabb>,
                                   Bodies<BasicTriangle, BasicObb, Pair::kTriangleObb>,
                                   Bodies<BasicTriangle, BasicCylinder, Pair::kTriangleCylinder>,
                                   Bodies<BasicObb, BasicObb, Pair::kObbObb>,
                                   Bodies<BasicObb, BasicCylinder, Pair::kObbCylinder>,
                                   Bodies<BasicCylinder, BasicCylinder, Pair::kCylinderCylinder>>;

/// Proposed normals and points: near the true ones by all magnitudes, random ones, and NaNs.
class Proposals {
 public:
  Proposal<float> next(const oracle::SignedDistance& distance, double size) {
    Proposal<float> p;
    const double far = std::exp2(-30 * share_(random_));
    for (int k = 0; k < 3; ++k) {
      p.n[k] = static_cast<float>(distance.n[k] + far * noise_(random_));
      p.point[k] = static_cast<float>(size * far * noise_(random_));
    }
    p.weight[0] = static_cast<float>(share_(random_) * 1.1 - 0.05);
    p.weight[1] = static_cast<float>((1 - p.weight[0]) * (share_(random_) * 1.1));
    constexpr float kOdd[] = {0,
                              -0.0F,
                              1e-42F,
                              3e38F,
                              std::numeric_limits<float>::infinity(),
                              std::numeric_limits<float>::quiet_NaN()};
    if (share_(random_) < 0.2) p.n[axis_(random_)] = kOdd[odd_(random_)];
    if (share_(random_) < 0.2) p.point[axis_(random_)] = kOdd[odd_(random_)];
    if (share_(random_) < 0.1) p.weight[axis_(random_) % 2] = kOdd[odd_(random_)];
    if (share_(random_) < 0.1) p.n *= std::exp2(static_cast<float>(40 * noise_(random_)));
    return p;
  }

 private:
  std::mt19937_64 random_{kSeed};
  std::uniform_real_distribution<double> share_{0, 1};
  std::normal_distribution<double> noise_;
  std::uniform_int_distribution<int> axis_{0, 2}, odd_{0, 5};
};

template <class>
class CertifiedFilter : public ::testing::Test {};
TYPED_TEST_SUITE(CertifiedFilter, AllBodies);

TYPED_TEST(CertifiedFilter, AnyProposal_GivesOnlyTrueCertainties) {
  using A = typename TypeParam::template A<float>;
  using B = typename TypeParam::template B<float>;
  Proposals proposals;
  int misses = 0, hits = 0;
  for (std::uint64_t i = 0; i < 4000; ++i) {
    const oracle::Case c = oracle::generate(TypeParam::kPair, kSeed, i);
    const A a = shape_of<A>(c.a);
    const B b = shape_of<B>(c.b);
    if (reference::bad(a) || reference::bad(b)) continue;
    const oracle::SignedDistance distance = oracle::signed_distance(c.shape_a(), c.shape_b());
    const double size = size_of_pair(Body(a), Body(b));
    for (int k = 0; k < 20; ++k) {
      const Certain certain = certify(a, b, proposals.next(distance, size));
      misses += certain == Certain::kMiss, hits += certain == Certain::kHit;
      ASSERT_FALSE(certain == Certain::kMiss && distance.hi < 0) << c.describe();
      ASSERT_FALSE(certain == Certain::kHit && distance.lo > 0) << c.describe();
    }
  }
  EXPECT_GT(misses, 1000);
  EXPECT_GT(hits, 300);
}

/// The signed distance along n in binary32 and binary64 on the same words.
TYPED_TEST(CertifiedFilter, Rounding_IsWithinItsBound) {
  using A = typename TypeParam::template A<float>;
  using B = typename TypeParam::template B<float>;
  using WideA = typename TypeParam::template A<double>;
  using WideB = typename TypeParam::template B<double>;
  std::mt19937_64 random(kSeed);
  std::normal_distribution<double> noise;
  double most = 0;
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const oracle::Case c = oracle::generate(TypeParam::kPair, kSeed, i);
    const A a = shape_of<A>(c.a);
    const B b = shape_of<B>(c.b);
    if (reference::bad(a) || reference::bad(b)) continue;
    Vector<float> n(static_cast<float>(noise(random)), static_cast<float>(noise(random)),
                    static_cast<float>(noise(random)));
    n *= 1.1F / n.norm();
    const Vector<double> wide_n = n.cast<double>();
    const double narrow = distance_along(Body(a), Body(b), n, dot<float>(n, n));
    const double wide = distance_along(Body(shape_of<WideA>(c.a)), Body(shape_of<WideB>(c.b)),
                                       wide_n, dot<double>(wide_n, wide_n));
    most = std::max(most, std::abs(narrow - wide) / (kU * size_of_pair(Body(a), Body(b))));
  }
  std::cout << fmt::format("distance along n: at most {:.2f} u S off\n", most);
  EXPECT_LT(most, 9.2);
  EXPECT_GT(most, 0.1);
}

TYPED_TEST(CertifiedFilter, Operators_EqualTheDocs) {
  using cde::testing::Counted;
  const oracle::Case c = oracle::generate(TypeParam::kPair, kSeed, 2);
  const auto count = [&](auto decide) {
    Counted::tally = {};
    decide();
    const cde::testing::Tally t = Counted::tally;
    return std::pair{
        fmt::format("{} | {} | {} | {}", t.add + t.sub, t.mul, t.sqrt, t.cmp + t.minmax),
        t.add + t.sub + t.mul + t.sqrt + t.cmp + t.minmax};
  };
  const auto [text, sum] = count([&] {
    (void)certify(shape_of<typename TypeParam::template A<Counted>>(c.a),
                  shape_of<typename TypeParam::template B<Counted>>(c.b), Proposal<Counted>{});
  });
  std::string pipe = "iterative";
  if (!has_iterations(TypeParam::kPair)) {
    const cde::testing::Tally t = cde::testing::operators(TypeParam::kPair);
    pipe = fmt::format("{}", t.add + t.sub + t.mul + t.div + t.sqrt + t.cmp + t.minmax);
  }
  cde::testing::expect_in_docs(
      "tables/certified_filters.md",
      {fmt::format("| {} | {} | {} | {} |", name(TypeParam::kPair), text, sum, pipe)});
}

TYPED_TEST(CertifiedFilter, RandomPairs_AreMostlyCertain) {
  std::vector<std::uint64_t> a, b;
  std::size_t count = 0;
  for (const oracle::Family& family : oracle::families(TypeParam::kPair)) {
    if (family.name != "random") continue;
    for (std::uint64_t i = 0; i < 4000; ++i, ++count) {
      const oracle::Case c = family.at(TypeParam::kPair, kSeed, i, oracle::Format{});
      for (const double x : c.a) a.push_back(FpFormat::parse("fp32").encode(x));
      for (const double x : c.b) b.push_back(FpFormat::parse("fp32").encode(x));
    }
  }
  ASSERT_EQ(count, 4000U);
  std::vector<Certain> certain(count);
  const PairIterations least{4, 2, 2};
  cde::accuracy::test_certain(TypeParam::kPair, FpFormat::parse("fp16"), least, a, b, certain);
  EXPECT_LT(std::ranges::count(certain, Certain::kNeither), 4000 * 0.012);
}

}  // namespace
}  // namespace cde::reference::filter
