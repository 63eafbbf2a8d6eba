// SPDX-License-Identifier: Apache-2.0
// Pipes whose candidate-axis (SAT) units are shared, with one row per three cycles. Every result is
// bit-identical to the mirror reference, and every cycle is checked.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <numeric>
#include <random>
#include <string>

#include "cde/card/pair_unit.hpp"
#include "cde/oracle/cases.hpp"
#include "cde/reference/pairs.hpp"
#include "cde/support/error.hpp"
#include "pair_failure.hpp"
#include "printed.hpp"

namespace cde {
namespace {

constexpr std::uint64_t kSeed = 20261121;
constexpr unsigned kInterval = 3;

struct Operands {
  std::vector<std::uint64_t> a, b;
};

/// Half of the pairs are near the decision. Every sixteenth pair has some random words.
Operands operands(Pair pair, std::size_t count) {
  Operands o;
  std::mt19937_64 random(kSeed);
  for (std::size_t i = 0; i < count; ++i) {
    const oracle::Case c = oracle::generate(static_cast<oracle::Pair>(pair), kSeed, i);
    const auto push = [&](std::vector<std::uint64_t>& to, const std::vector<double>& from) {
      for (const double x : from) {
        const bool any = i % 16 == 15 && random() % 8 == 0;
        to.push_back(any ? random() & 0xffffffff
                         : std::bit_cast<std::uint32_t>(static_cast<float>(x)));
      }
    };
    push(o.a, c.a);
    push(o.b, c.b);
  }
  return o;
}

struct Parameter {
  Pair pair;
  Arithmetic arithmetic;
  unsigned latency;  ///< cycles of the pipe with operators of one cycle

  /// Including the cycles that scale the pair and its result.
  [[nodiscard]] unsigned cycles() const { return latency + 3; }
  [[nodiscard]] bool gates() const { return arithmetic == Arithmetic::kRtl; }
  friend void PrintTo(const Parameter& p, std::ostream* out) { *out << name(p.pair); }
};

class SatInterval : public ::testing::TestWithParam<Parameter> {};

TEST_P(SatInterval, SharedAxes_TakeARowPerThreeCycles) {
  const Parameter p = GetParam();
  // The gates of more lanes take minutes to build.
  const PairConfig config{.pair = p.pair,
                          .lanes = p.gates() ? 1u : 8u,
                          .arithmetic = p.arithmetic,
                          .sat_interval = kInterval};
  const std::size_t count = p.gates() ? 2000 : 20000, rows = count / config.lanes;
  PairUnit unit(config);
  EXPECT_EQ(unit.latency(), p.cycles());
  const Operands o = operands(p.pair, count);
  std::vector<PairResult> expected(count), got(count);
  reference::test_pairs(p.pair, config.algorithm, config.format, o.a, o.b, expected);
  const auto hits = static_cast<std::size_t>(
      std::count_if(expected.begin(), expected.end(), [](const PairResult& r) { return r.f; }));
  const auto bad =
      std::count_if(expected.begin(), expected.end(), [](const PairResult& r) { return r.bad; });
  EXPECT_GE(hits, count * 3 / 10);
  EXPECT_LE(hits, count * 7 / 10);
  EXPECT_GT(bad, 0);

  EXPECT_EQ(unit.test(o.a, o.b, got), (rows - 1) * kInterval + p.cycles());
  const auto differs = static_cast<std::size_t>(
      std::mismatch(got.begin(), got.end(), expected.begin()).first - got.begin());
  EXPECT_EQ(differs, count) << "first pair that differs:\n"
                            << testing::failure_report({config, o.a, o.b, differs});

  // Rows that come too early wait at the input port; late rows leave idle cycles.
  std::mt19937 random(1);
  std::vector<unsigned> gaps(rows);
  for (unsigned& gap : gaps) gap = random() % 3 == 0 ? 0 : random() % 7;
  const std::uint64_t entered = std::accumulate(
      gaps.begin() + 1, gaps.end(), std::uint64_t{gaps[0]},
      [](std::uint64_t t, unsigned gap) { return t + std::max(kInterval, gap + 1); });
  std::vector<PairResult> spaced(count);
  std::size_t next = 0;
  EXPECT_EQ(unit.test(o.a, o.b, spaced, [&] { return gaps.at(next++); }), entered + p.cycles());
  EXPECT_EQ(spaced == expected, true) << "gaps between rows must not change results";

  // One row alone, after a reset during a stream.
  unit.reset();
  const std::span<const std::uint64_t> a(o.a), b(o.b);
  std::vector<PairResult> one(config.lanes);
  EXPECT_EQ(unit.test(a.first(config.lanes * primary_words(p.pair)),
                      b.first(config.lanes * secondary_words(p.pair)), one),
            p.cycles());
  EXPECT_TRUE(std::equal(one.begin(), one.end(), expected.begin()));
}

std::string test_name(const ::testing::TestParamInfo<Parameter>& info) {
  std::string text = std::string(name(info.param.pair)) + (info.param.gates() ? "_rtl" : "_host");
  std::replace(text.begin(), text.end(), '-', '_');
  return text;
}

// Taking a pair costs one cycle more than with an interval of 1. Two boxes wait two cycles for the
// last of three edges. With a triangle, every edge waits longer, for the triangle's own face.
INSTANTIATE_TEST_SUITE_P(
    Fp32, SatInterval,
    ::testing::Values(Parameter{Pair::kObbObb, Arithmetic::kHost, 107 + 3},
                      Parameter{Pair::kObbObb, Arithmetic::kRtl, 107 + 3},
                      Parameter{Pair::kTriangleAabb, Arithmetic::kHost, 109 + 1},
                      Parameter{Pair::kTriangleAabb, Arithmetic::kRtl, 109 + 1},
                      Parameter{Pair::kTriangleObb, Arithmetic::kHost, 112 + 1},
                      Parameter{Pair::kTriangleObb, Arithmetic::kRtl, 112 + 1}),
    test_name);

template <class Config>
void expect_refused(const Config& config, const char* why) {
  try {
    (void)config.parameters();
    ADD_FAILURE() << "not refused: " << why;
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::kUsage);
    EXPECT_NE(std::string(e.what()).find(why), std::string::npos) << e.what();
  }
}

TEST(SatIntervalConfig, UnsupportedIntervals_AreRefused) {
  for (const unsigned interval : {0u, 2u, 4u, 9u}) {
    expect_refused(PairConfig{.pair = Pair::kObbObb, .sat_interval = interval}, "1 or 3");
    expect_refused(BoardConfig{.pairs = {Pair::kObbObb}, .sat_interval = interval}, "1 or 3");
  }
  for (unsigned p = 0; p < kPairs; ++p) {
    const auto pair = static_cast<Pair>(p);
    const PairConfig config{.pair = pair, .sat_interval = kInterval};
    if (!has_sat_interval(pair)) {
      expect_refused(config, "no candidate axes");
      expect_refused(BoardConfig{.pairs = {pair}, .sat_interval = kInterval}, "no candidate axes");
      continue;
    }
    const auto listed = [](const std::vector<std::string>& parameters) {
      return std::count(parameters.begin(), parameters.end(), "SAT_II=3");
    };
    EXPECT_EQ(listed(config.parameters()), 1);
    EXPECT_EQ(listed(BoardConfig{.pairs = {Pair::kRayTriangle, pair}, .sat_interval = kInterval}
                         .parameters()),
              1);
    // An interval of 1 adds no parameter, so existing models stay valid.
    for (const std::string& parameter : PairConfig{.pair = pair}.parameters())
      EXPECT_FALSE(parameter.starts_with("SAT_II")) << parameter;
  }
}

}  // namespace
}  // namespace cde
