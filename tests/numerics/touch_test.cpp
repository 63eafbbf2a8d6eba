// SPDX-License-Identifier: Apache-2.0
// F and T of two solids agree in every format: never F = 0 with T = 0.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <vector>

#include "cde/fp/number_text.hpp"
#include "cde/fp/scalars.hpp"
#include "cde/geometry/operand_line.hpp"
#include "cde/oracle/cases.hpp"
#include "cde/reference/pairs.hpp"

namespace cde {
namespace {

/// How many of the pairs touch with T = 0; pairs that are apart with T = 0 are failures.
int touching(Pair pair, FpFormat format, const std::vector<std::uint64_t>& a,
             const std::vector<std::uint64_t>& b) {
  std::vector<PairResult> results(a.size() / primary_words(pair));
  reference::test_pairs(pair, Algorithm::kMoller, format, a, b, results, PlaneSide::kSurface,
                        {.samples = 4, .circle = 1, .free = 1});
  int touch = 0;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const PairResult& r = results[i];
    if (r.bad || format.decode(r.t) != 0) continue;
    EXPECT_TRUE(r.f) << name(pair) << " " << format.name() << " pair " << i << " is apart by 0";
    ++touch;
  }
  return touch;
}

TEST(Touch, NoPairIsApartByZero) {
  using Draw = oracle::Case (*)(Pair, std::uint64_t, std::uint64_t, const oracle::Format&);
  constexpr std::uint64_t kCases = 600, kSeed = 17;
  for (const FpFormat format : kPairFormats) {
    const oracle::Format like{format.exp_bits, format.man_bits};
    int touch = 0;
    for (const Pair pair : oracle::kPairs) {
      if (!is_solid(pair)) continue;
      std::vector<std::uint64_t> a, b;
      for (const Draw draw : {Draw(oracle::generate), Draw(oracle::everyday), Draw(oracle::hard)})
        for (std::uint64_t i = 0; i < kCases; ++i) {
          const oracle::Case one = draw(pair, kSeed, i, like);
          for (const double x : one.a) a.push_back(format.encode(x));
          for (const double x : one.b) b.push_back(format.encode(x));
        }
      touch += touching(pair, format, a, b);
    }
    EXPECT_GT(touch, 0) << format.name() << ": nothing touches, so nothing was shown";
  }
}

TEST(Touch, GapsThatVanishOnTheWayBack) {
  const FpFormat fp16 = FpFormat::parse("fp16");
  const std::pair<const char*, const char*> lines[] = {
      {"obb-obb", "0 0 0 0.75 0.875 1 1 0 0 0 1 0 0 0 1 | 0 1 -2 2 0.125 1.375 1 0 0 0 1 0 0 0 1"},
      {"triangle-triangle", "1 -3 4 -6 4 6 3 -4 0 | -.25 -1.5 3.5 -.25 -2.5 .5 -.25 -4.5 6.5"}};
  for (const auto& [pair, line] : lines) {
    std::vector<std::uint64_t> a, b;
    std::string why;
    ASSERT_EQ(read_operands(pair_in_any_order(pair), WordText(fp16), pair, line, a, b, why),
              OperandLine::kPair)
        << why;
    EXPECT_EQ(touching(*pair_named(pair), fp16, a, b), 1) << pair;
  }
}

}  // namespace
}  // namespace cde
