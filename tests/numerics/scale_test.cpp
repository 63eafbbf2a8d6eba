// The range of lengths that the contract promises (docs/pairs.md): every pair, scaled by a power of
// two, gives the same answer scaled, bit by bit; what lies outside the range is bad input.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "cde/fp.hpp"
#include "cde/fp_format.hpp"
#include "cde/length_range.hpp"
#include "cde/pair.hpp"
#include "cde/reference/pairs.hpp"
#include "cde/reference/scale.hpp"
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

class Scaling : public ::testing::TestWithParam<Parameter> {};

TEST_P(Scaling, ByAPowerOfTwoIsExact) {
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
    const LengthRange length = room(c, a, b, Kind::kLength, exact_range(pair, format));
    const LengthRange direction = a == Shape::kRay
                                      ? room(c, a, b, Kind::kDirection, exact_range(pair, format))
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
  std::size_t compared = 0, hits = 0, wrong = 0, bad = 0, out = 0, infinite = 0;
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
    bool same = is.f == was.f && std::equal(is.n, is.n + 3, was.n);
    const auto look = [&](std::uint64_t now, std::uint64_t before, int by) {
      const double x = format.decode(before), y = format.decode(now), expected = std::ldexp(x, by);
      if (std::isnan(y)) return false;
      if (std::abs(expected) < least || std::abs(x) < least) {
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
  EXPECT_GE(compared, 3 * kCases);
  EXPECT_GE(hits, compared / 4);
}

std::vector<Parameter> parameters() {
  std::vector<Parameter> all;
  for (const FpFormat format :
       {FpFormat{5, 10}, FpFormat{8, 7}, FpFormat{7, 16}, FpFormat{8, 23}, FpFormat{11, 52}})
    for (unsigned p = 0; p < kPairs; ++p)
      for (unsigned a = 0; a < 4; ++a) {
        const auto pair = static_cast<Pair>(p);
        const auto algorithm = static_cast<Algorithm>(a);
        if (!reference::has_pair(pair, algorithm)) continue;
        all.push_back({pair, algorithm, PlaneSide::kSurface, format});
        if (pair == Pair::kObbPlane)
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

}  // namespace
}  // namespace cde::testing
