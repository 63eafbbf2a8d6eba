// SPDX-License-Identifier: Apache-2.0
// The statistics of `cde accuracy`: quantiles, intervals, ulps, and counts for answers that are
// known to be right or wrong.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "cde/accuracy/error_counts.hpp"
#include "cde/accuracy/tally.hpp"
#include "cde/oracle/oracle.hpp"
#include "cde/oracle/random.hpp"

namespace cde::accuracy {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr FpFormat kFp32{8, 23}, kFp16{5, 10}, kFp64{11, 52};

ErrorCounts counts(const std::vector<double>& sizes) {
  ErrorCounts all;
  for (const double size : sizes) all.add(size);
  return all;
}

TEST(ErrorCountsTest, Quantiles_AreRoundedUpByAtMostAThirtySecond) {
  oracle::Random random(1, 2, 3);
  std::vector<double> sizes;
  for (int i = 0; i < 5000; ++i) sizes.push_back(random.decades(1e-30, 1e30));
  const ErrorCounts all = counts(sizes);
  std::ranges::sort(sizes);
  for (const double share : {0.001, 0.25, 0.5, 0.9, 0.99, 0.999, 1.0}) {
    const double exact = sizes[static_cast<std::size_t>(std::ceil(share * 5000)) - 1];
    EXPECT_GE(all.quantile(share), exact) << share;
    EXPECT_LE(all.quantile(share), exact * (1 + 1 / 32.0)) << share;
  }
  EXPECT_EQ(all.largest(), sizes.back()) << "the largest error is exact";
  EXPECT_EQ(all.quantile(1), sizes.back());
}

TEST(ErrorCountsTest, ZerosAndInfinities_AreCounted) {
  const ErrorCounts none, zeros = counts({0, 0, 0}), mixed = counts({0, 0, 3, kInf});
  EXPECT_EQ(none.quantile(0.5), 0);
  EXPECT_EQ(zeros.quantile(1), 0);
  EXPECT_EQ(zeros.largest(), 0);
  EXPECT_EQ(mixed.quantile(0.5), 0);
  EXPECT_EQ(mixed.quantile(0.75), 3);
  EXPECT_EQ(mixed.quantile(0.99), kInf);
  EXPECT_EQ(mixed.largest(), kInf);
  EXPECT_EQ(mixed.count(), 4u);
}

TEST(ErrorCountsTest, Parts_AddUpAndReadBackFromJson) {
  const std::vector<double> one = {0, 1e-3, 0.7, 12}, two = {5e-324, 0.7, kInf};
  std::vector<double> both = one;
  both.insert(both.end(), two.begin(), two.end());
  ErrorCounts sum = counts(one);
  sum.add(counts(two));
  EXPECT_EQ(sum.to_json(), counts(both).to_json());
  const auto again = ErrorCounts::from_json(nlohmann::ordered_json::parse(sum.to_json().dump()));
  EXPECT_EQ(again.to_json(), sum.to_json());
  EXPECT_EQ(again.count(), 7u);
  EXPECT_EQ(again.quantile(0.5), sum.quantile(0.5));
}

/// Values of Wilson's interval from published tables.
TEST(WilsonInterval, Intervals_EqualPublishedTables) {
  EXPECT_NEAR(wilson(10, 100).low, 0.0552, 1e-4);
  EXPECT_NEAR(wilson(10, 100).high, 0.1744, 1e-4);
  EXPECT_EQ(wilson(0, 100).low, 0);
  EXPECT_NEAR(wilson(0, 100).high, 0.0370, 1e-4);
  EXPECT_NEAR(wilson(100, 100).low, 1 - wilson(0, 100).high, 1e-12);
  EXPECT_EQ(wilson(100, 100).high, 1);
  EXPECT_EQ(wilson(0, 0).low, 0);
  EXPECT_EQ(wilson(0, 0).high, 1);
}

/// Two spheres at a distance of 2, for possible answers of a pipe.
oracle::Case apart_by_two() {
  return {Pair::kSphereSphere, 0, 0, "", {0, 0, 0, 1}, {4, 0, 0, 1}};
}
PairResult answer(FpFormat format, bool f, double t) {
  PairResult r;
  r.f = f;
  r.t = format.encode(t);
  const double cp[3] = {2, 0, 0}, n[3] = {1, 0, 0};
  for (int k = 0; k < 3; ++k) r.cp[k] = format.encode(cp[k]), r.n[k] = format.encode(n[k]);
  return r;
}
Tally judged(FpFormat format, const PairResult& r) {
  Tally tally;
  judge(tally, {.pair = Pair::kSphereSphere, .format = format}, apart_by_two(), r);
  return tally;
}

TEST(AnswerCheck, ExactAnswer_HasNoError) {
  for (const FpFormat format : {kFp16, kFp32}) {
    const Tally t = judged(format, answer(format, false, 2));
    EXPECT_EQ(t.t.largest(), 0);
    EXPECT_EQ(t.t_ulps.largest(), 0);
    EXPECT_LT(t.cp.largest(), 1e-5);
    EXPECT_LT(t.n.largest(), 1e-5);
    EXPECT_EQ(t.false_hits + t.false_misses + t.undecided, 0u);
  }
}

TEST(AnswerCheck, OneUlp_CountsAsOne) {
  for (const FpFormat format : {kFp16, kFp32}) {
    const double ulp = std::ldexp(1, 1 - format.man_bits);  // of 2
    const Tally t = judged(format, answer(format, false, 2 + ulp));
    EXPECT_NEAR(t.t_ulps.largest(), 1, 1e-5);
    // S = 4 + 1 + 1, u half an ulp of 1.
    EXPECT_NEAR(t.t.largest(), ulp / (std::ldexp(1, -1 - format.man_bits) * 6), 1e-5);
  }
}

TEST(AnswerCheck, WrongDecision_CountsOnItsSide) {
  EXPECT_EQ(judged(kFp32, answer(kFp32, true, 2)).false_hits, 1u);
  Tally tally;
  oracle::Case deep = apart_by_two();
  deep.b[0] = 1;
  judge(tally, {.pair = Pair::kSphereSphere, .format = kFp32}, deep, answer(kFp32, false, 1));
  EXPECT_EQ(tally.false_misses, 1u);
  EXPECT_EQ(tally.false_hits, 0u);
  oracle::Case touching = apart_by_two();
  touching.b[0] = 2;
  tally = {};
  judge(tally, {.pair = Pair::kSphereSphere, .format = kFp32}, touching, answer(kFp32, false, 0));
  EXPECT_EQ(tally.undecided, 1u);
  EXPECT_EQ(tally.false_hits + tally.false_misses, 0u);
}

TEST(AnswerCheck, RefusedOrNonFiniteAnswers_AreCounted) {
  PairResult bad;
  bad.bad = true;
  EXPECT_EQ(judged(kFp32, bad).refused, 1u);
  EXPECT_EQ(judged(kFp32, bad).t.count(), 0u);
  const Tally t = judged(kFp32, answer(kFp32, false, kInf));
  EXPECT_EQ(t.not_numbers, 1u);
  EXPECT_EQ(t.t.largest(), kInf);
}

/// All formats get the same cases, each rounded to the format.
TEST(DrawnCases, Formats_GetTheSameCases) {
  for (const oracle::Family& family : oracle::families(Pair::kTriangleSphere)) {
    const DrawnCases wide = drawn({.pair = Pair::kTriangleSphere, .format = kFp64}, family, 9, 3),
                     narrow = drawn({.pair = Pair::kTriangleSphere, .format = kFp16}, family, 9, 3);
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < wide.cases[i].a.size(); ++k)
        EXPECT_EQ(oracle::Format({5, 10}).round(wide.cases[i].a[k]), narrow.cases[i].a[k])
            << family.name;
  }
}

TEST(CaseFamilies, Names_AreUniqueAndMatchTheCases) {
  for (const oracle::Pair pair : oracle::kPairs) {
    std::set<std::string> names;
    for (const oracle::Family& family : oracle::families(pair)) {
      EXPECT_TRUE(names.insert(family.name).second) << family.name;
      EXPECT_EQ(family.name.find(' '), std::string::npos);
      const std::string first = family.at(pair, 5, 0, {}).family;
      // A flat view replaces a case that has no direction.
      for (std::uint64_t i = 1; i < 4 && family.name != "everyday-flat"; ++i)
        EXPECT_EQ(family.at(pair, 5, i, {}).family, first) << family.name;
    }
    EXPECT_GE(names.size(), 20u);
  }
}

/// Watertight does not leak, while Moeller's rays show that these cases can leak.
TEST(Leaks, Icosphere_LeaksOnlyWithoutWatertight) {
  const auto leaks = [](Algorithm algorithm, const std::string& family) {
    return measured_leaks({.algorithm = algorithm, .format = kFp32}, family, 1, 0, 150);
  };
  std::uint64_t moller = 0;
  for (const std::string& family : leak_families()) {
    const Tally tight = leaks(Algorithm::kWatertight, family);
    EXPECT_EQ(tight.leaks, 0u) << family;
    EXPECT_GT(tight.leak_rays, 100u) << family;
    moller += leaks(Algorithm::kMoller, family).leaks;
  }
  EXPECT_GT(moller, 0u);
}

}  // namespace
}  // namespace cde::accuracy
