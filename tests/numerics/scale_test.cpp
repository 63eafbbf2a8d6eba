// SPDX-License-Identifier: Apache-2.0
// The range of lengths of the contract (docs/reference/pairs.md). Every pair, scaled by a power of
// two, gives the same answer scaled, bit by bit. Words outside the range are bad input.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "cde/fp/scalars.hpp"
#include "cde/geometry/length_range.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/oracle/certificate.hpp"
#include "cde/reference/pairs.hpp"
#include "cde/reference/pipes/scale.hpp"
#include "printed.hpp"
#include "scaled_cases.hpp"

namespace cde::testing {
namespace {

constexpr std::uint64_t kSeed = 20261122;
constexpr std::size_t kCases = 4000;

struct Parameter {
  Pair pair;
  Algorithm algorithm;
  PlaneSide plane;
  FpFormat format;
};

void PrintTo(const Parameter& p, std::ostream* out) {
  *out << name(p.pair) << ' ' << p.format.name();
}

/// Separated solids have a positive distance.
bool agree(const PairResult& r, FpFormat format) {
  return r.f || format.decode(r.t) > 0;
}

class Scaling : public ::testing::TestWithParam<Parameter> {};

TEST_P(Scaling, PowerOfTwo_ScalesExactly) {
  const auto [pair, algorithm, plane, format] = GetParam();
  const Shape a = primary_shape(pair), b = secondary_shape(pair);
  const double least = std::ldexp(1, 2 - (1 << (format.exp_bits - 1)));
  std::mt19937_64 random(kSeed);
  std::vector<std::uint64_t> words_a, words_b;
  struct From {
    std::size_t base;
    int j, m;
    std::uint64_t index;
  };
  std::vector<From> from;
  for (std::uint64_t i = 0; i < kCases; ++i) {
    const oracle::Case c =
        oracle::generate(static_cast<oracle::Pair>(pair), kSeed, i,
                         {.exp_bits = format.exp_bits, .man_bits = format.man_bits});
    const LengthRange length = scale_range(c, a, b, Kind::kLength, exact_range(pair, format));
    const LengthRange direction =
        a == Shape::kRay ? scale_range(c, a, b, Kind::kDirection, exact_range(pair, format))
                         : LengthRange{0, 0};
    if (length.low > length.high || direction.low > direction.high) continue;
    const auto between = [&](LengthRange r) {
      return r.low + static_cast<int>(random() % static_cast<unsigned>(r.high - r.low + 1));
    };
    const int start = std::clamp(0, length.low, length.high);
    const int start_m = std::clamp(0, direction.low, direction.high);
    const std::size_t base = from.size();
    const std::pair<int, int> by[] = {{start, start_m},
                                      {length.low, direction.low},
                                      {length.high, direction.high},
                                      {length.low, direction.high},
                                      {length.high, direction.low},
                                      {between(length), between(direction)}};
    for (const auto& [j, m] : by) {
      std::vector<std::uint64_t> x, y;
      if (!scaled_words(c.a, a, format, j, m, x) || !scaled_words(c.b, b, format, j, m, y)) {
        if (from.size() == base) break;
        continue;
      }
      words_a.insert(words_a.end(), x.begin(), x.end());
      words_b.insert(words_b.end(), y.begin(), y.end());
      from.push_back({base, j, m, i});
    }
  }
  std::vector<PairResult> results(from.size());
  reference::test_pairs(pair, algorithm, format, words_a, words_b, results, plane);
  std::size_t compared = 0, hits = 0, wrong = 0, bad = 0, out = 0, infinite = 0, disagree = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const PairResult& was = results[from[i].base];
    const PairResult& is = results[i];
    if (from[i].base == i || was.bad) continue;
    bad += is.bad;
    ++compared;
    hits += is.f;
    if (is.f)
      infinite += !std::isfinite(format.decode(is.t)) || !std::isfinite(format.decode(is.cp[0]));
    const int j = from[i].j - from[from[i].base].j;
    const int t_by = a == Shape::kRay ? j - (from[i].m - from[from[i].base].m) : j;
    disagree += is_solid(pair) && !(agree(was, format) && agree(is, format));
    bool same = is.f == was.f && std::equal(is.n, is.n + 3, was.n);
    const auto look = [&](std::uint64_t now, std::uint64_t before, int by) {
      const double x = format.decode(before), y = format.decode(now), expected = std::ldexp(x, by);
      if (std::isnan(y)) return false;
      // The smallest number also stands for all smaller ones.
      if (std::abs(expected) < least || std::abs(x) <= least) {
        out += expected != y;
        return std::abs(expected - y) <= least * std::ldexp(1., std::max(0, by));
      }
      if (!std::isfinite(format.decode(format.encode(expected)))) {
        ++out;
        return true;
      }
      return y == expected;
    };
    same = same && look(is.t, was.t, t_by);
    for (int k = 0; k < 3; ++k) same = same && look(is.cp[k], was.cp[k], j);
    if (!same && ++wrong <= 3)
      ADD_FAILURE() << name(pair) << " case " << from[i].index << " by 2^" << from[i].j << ", d 2^"
                    << from[i].m << ": F " << was.f << " " << is.f << " T " << format.decode(was.t)
                    << " " << format.decode(is.t) << " CP " << format.decode(was.cp[0]) << " "
                    << format.decode(is.cp[0]);
  }
  std::printf("%s %s: %zu compared, %zu hits, %zu wrong, %zu bad, %zu words under or over\n",
              std::string(name(pair)).c_str(), format.name().c_str(), compared, hits, wrong, bad,
              out);
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(bad, 0u);
  EXPECT_EQ(infinite, 0u);
  EXPECT_EQ(disagree, 0u) << "F and T";
  EXPECT_GE(compared, 3 * kCases);
  EXPECT_GE(hits, compared / 4);
}

/// Sizes and coordinates with every ratio that the range allows, in a pair of solids. Answers meet
/// the contract of the convex pairs: 16 u S, and 16 u S + 4 u L for the witness points.
TEST_P(Scaling, SizesOfAnyRatio_MeetTheContract) {
  const auto [pair, algorithm, plane, format] = GetParam();
  if (!is_solid(pair) || plane == PlaneSide::kHalfSpace) return;
  const auto [low, high] = LengthRange::of(format.exp_bits, format.man_bits);
  const double u = std::ldexp(1, -format.man_bits - 1);
  const oracle::Format rounded{.exp_bits = format.exp_bits, .man_bits = format.man_bits};
  std::size_t failed = 0, hits = 0, judged = 0;
  for (std::uint64_t i = 0; i < kCases / 4; ++i) {
    oracle::Case c = oracle::generate(static_cast<oracle::Pair>(pair), kSeed, i, rounded);
    std::mt19937_64 random(kSeed + i);
    const auto between = [&](int from, int to) {
      const double fraction = 1 + static_cast<double>(random() >> 12) * 0x1p-52;
      return std::ldexp(fraction,
                        from + static_cast<int>(random() % static_cast<unsigned>(to - from)));
    };
    const int least = low + static_cast<int>(random() % static_cast<unsigned>(high - low));
    std::vector<std::uint64_t> a, b;
    const auto change = [&](Shape shape, std::vector<double>& words,
                            std::vector<std::uint64_t>& to) {
      for (std::size_t k = 0; k < words.size(); ++k) {
        if (kind(shape, k) == Kind::kLength)
          words[k] = between(is_size(shape, k) ? low : least - 8, least + 1) *
                     (is_size(shape, k) || random() % 2 == 0 ? 1 : -1);
      }
      if (shape == Shape::kAabb)
        for (std::size_t k = 0; k < 3; ++k)
          if (words[k] > words[k + 3]) std::swap(words[k], words[k + 3]);
      for (double& w : words) to.push_back(format.encode(w)), w = format.decode(to.back());
    };
    change(primary_shape(pair), c.a, a);
    change(secondary_shape(pair), c.b, b);
    PairResult r;
    reference::test_pairs(pair, algorithm, format, a, b, std::span(&r, 1), plane);
    if (r.bad) continue;
    ++judged, hits += r.f;
    EXPECT_TRUE(agree(r, format)) << "F " << r.f << " T " << format.decode(r.t) << "\n"
                                  << c.describe();
    const auto vector = [&](const std::uint64_t* w) {
      return oracle::Vec(format.decode(w[0]), format.decode(w[1]), format.decode(w[2]));
    };
    const oracle::Vec cp = vector(r.cp), n = vector(r.n);
    const double t = format.decode(r.t);
    if (!std::isfinite(t) || !cp.allFinite() || !n.allFinite()) {
      if (++failed <= 3) ADD_FAILURE() << "not finite: " << c.describe();
      continue;
    }
    if (format.man_bits == 52) continue;  // the oracle itself computes in binary64
    const oracle::Decision v =
        oracle::check(c.shape_a(), c.shape_b(), {r.f, t, cp, n},
                      {.u = u, .distance = {}, .lower_bound = has_iterations(pair)});
    if (!v.ok() && ++failed <= 3) ADD_FAILURE() << v.describe() << '\n' << c.describe();
  }
  std::printf("%s %s: %zu judged, %zu hits, %zu failed\n", std::string(name(pair)).c_str(),
              format.name().c_str(), judged, hits, failed);
  EXPECT_EQ(failed, 0u);
  EXPECT_GT(judged, kCases / 5);
}

std::vector<Parameter> parameters() {
  std::vector<Parameter> all;
  for (const FpFormat format : kPairFormats)
    for (unsigned p = 0; p < kPairs; ++p)
      for (unsigned a = 0; a < 4; ++a) {
        const auto pair = static_cast<Pair>(p);
        const auto algorithm = static_cast<Algorithm>(a);
        if (!reference::has_pair(pair, algorithm)) continue;
        all.push_back({pair, algorithm, PlaneSide::kSurface, format});
        if (secondary_shape(pair) == Shape::kPlane)
          all.push_back({pair, algorithm, PlaneSide::kHalfSpace, format});
      }
  return all;
}

std::string label(const ::testing::TestParamInfo<Parameter>& info) {
  std::ostringstream text;
  text << name(info.param.pair);
  if (info.param.pair == Pair::kRayTriangle) text << '_' << name(info.param.algorithm);
  if (info.param.plane == PlaneSide::kHalfSpace) text << "_half_space";
  text << '_' << info.param.format.name();
  std::string result = text.str();
  std::replace(result.begin(), result.end(), '-', '_');
  return result;
}

INSTANTIATE_TEST_SUITE_P(Pairs, Scaling, ::testing::ValuesIn(parameters()), label);

/// Touching pairs in fp16, whose T is below the normal numbers: F = 1, or T is not zero.
TEST(Touching, FAndT_Agree) {
  constexpr FpFormat kFp16{5, 10};
  struct Touching {
    Pair pair;
    std::vector<double> a, b;
  };
  const Touching all[] = {{Pair::kObbObb,
                           {0, 0, 0, 0.75, 0.875, 1, 1, 0, 0, 0, 1, 0, 0, 0, 1},
                           {0, 1, -2, 2, 0.125, 1.375, 1, 0, 0, 0, 1, 0, 0, 0, 1}},
                          {Pair::kTriangleTriangle,
                           {1, -3, 4, -6, 4, 6, 3, -4, 0},
                           {-.25, -1.5, 3.5, -.25, -2.5, .5, -.25, -4.5, 6.5}}};
  for (const Touching& t : all) {
    std::vector<std::uint64_t> a, b;
    for (const double w : t.a) a.push_back(kFp16.encode(w));
    for (const double w : t.b) b.push_back(kFp16.encode(w));
    PairResult r;
    reference::test_pairs(t.pair, Algorithm{}, kFp16, a, b, std::span(&r, 1));
    EXPECT_FALSE(r.bad);
    EXPECT_TRUE(agree(r, kFp16)) << name(t.pair) << ": F " << r.f << " T " << kFp16.decode(r.t);
  }
}

/// Pairs far from size one whose answers are known in closed form.
TEST(Range, KnownPairs_HaveTheirAnswers) {
  struct Known {
    Pair pair;
    FpFormat format;
    std::vector<double> a, b;
    bool f;
    double t;
  };
  constexpr FpFormat kFp32{8, 23}, kFp16{5, 10};
  const double inf = std::numeric_limits<double>::infinity();
  const Known all[] = {
      {Pair::kTriangleSphere,
       kFp32,
       {0, 0, 0, 3e-10, 0, 0, 0, 3e-10, 0},
       {1e-10, 1e-10, .5e-10, 1e-10},
       true,
       .5e-10},
      {Pair::kTriangleSphere,
       kFp32,
       {0, 0, 0, 3e11, 0, 0, 0, 3e11, 0},
       {1e11, 1e11, 2e11, 1e11},
       false,
       1e11},
      {Pair::kRaySphere, kFp16, {0, 0, -60, 0, 0, 20, 0, inf}, {0, 0, 0, 20}, true, 2},
      {Pair::kRayTriangle,
       kFp16,
       {10, 10, -90, 0, 0, 1, 0, inf},
       {0, 0, 0, 60, 0, 0, 0, 60, 0},
       true,
       90},
      {Pair::kRayTriangle,
       kFp16,
       {10, 10, -100, 0, 0, 0x1p-7, 0, inf},
       {0, 0, 100, 60, 0, 100, 0, 60, 100},
       true,
       25600},
  };
  for (const Known& k : all) {
    std::vector<std::uint64_t> a, b;
    for (const double w : k.a) a.push_back(k.format.encode(w));
    for (const double w : k.b) b.push_back(k.format.encode(w));
    PairResult r;
    reference::test_pairs(k.pair, Algorithm::kMoller, k.format, a, b, std::span(&r, 1));
    EXPECT_EQ(r.f, k.f) << name(k.pair);
    EXPECT_FALSE(r.bad);
    EXPECT_NEAR(k.format.decode(r.t), k.t, k.t * std::ldexp(4, -k.format.man_bits));
  }
}

}  // namespace
}  // namespace cde::testing
