// SPDX-License-Identifier: Apache-2.0
// Pipes at every size that the contract allows, and one step beyond, against their references with
// both back ends.
#include <gtest/gtest.h>

#include <bit>
#include <cstdio>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "../printed.hpp"
#include "cde/card/pair_unit.hpp"
#include "cde/fp/fp_format.hpp"
#include "cde/geometry/length_range.hpp"
#include "cde/reference/pairs.hpp"
#include "numerics/scaled_cases.hpp"
#include "pair_failure.hpp"

namespace cde::testing {
namespace {

constexpr std::uint64_t kSeed = 20261123;

class Range : public ::testing::TestWithParam<PairConfig> {
 protected:
  struct Operands {
    std::vector<std::uint64_t> a, b;
  };
  [[nodiscard]] static LengthRange lengths() {
    const FpFormat f = GetParam().format;
    return LengthRange::of(f.exp_bits, f.man_bits);
  }
  [[nodiscard]] static oracle::Case made(std::uint64_t i) {
    const PairConfig& config = GetParam();
    return oracle::generate(
        static_cast<oracle::Pair>(config.pair), kSeed, i,
        {.exp_bits = config.format.exp_bits, .man_bits = config.format.man_bits});
  }
  /// Results of the pipe, which must equal the reference.
  static std::vector<PairResult> answers(const Operands& o) {
    const PairConfig& config = GetParam();
    PairUnit unit(config);
    std::vector<PairResult> got(o.a.size() / primary_words(config.pair)), expected(got.size());
    reference::test_pairs(config.pair, config.algorithm, config.format, o.a, o.b, expected,
                          config.plane);
    (void)unit.test(o.a, o.b, got);
    for (std::size_t i = 0, wrong = 0; i < got.size() && wrong < 3; ++i) {
      if (got[i] == expected[i]) continue;
      ++wrong;
      ADD_FAILURE() << "pair " << i << ": F " << got[i].f << " " << expected[i].f << " bad "
                    << got[i].bad << " " << expected[i].bad << std::hex << " T " << got[i].t << " "
                    << expected[i].t << std::dec << "\n"
                    << testing::failure_report({config, o.a, o.b, i});
    }
    return got;
  }
};

TEST_P(Range, EverySize_EqualsTheReference) {
  const PairConfig& config = GetParam();
  const Shape a = primary_shape(config.pair), b = secondary_shape(config.pair);
  std::mt19937_64 random(kSeed);
  Operands o;
  for (std::uint64_t i = 0; i < 1500; ++i) {
    const oracle::Case c = made(i);
    const LengthRange length = scale_range(c, a, b, Kind::kLength, lengths());
    const LengthRange direction =
        a == Shape::kRay ? scale_range(c, a, b, Kind::kDirection, lengths()) : LengthRange{0, 0};
    if (length.low > length.high || direction.low > direction.high) continue;
    const auto between = [&](LengthRange r) {
      return r.low + static_cast<int>(random() % static_cast<unsigned>(r.high - r.low + 1));
    };
    const int j = between(length), m = between(direction);
    std::vector<std::uint64_t> x, y;
    if (!scaled_words(c.a, a, config.format, j, m, x) ||
        !scaled_words(c.b, b, config.format, j, m, y))
      continue;
    o.a.insert(o.a.end(), x.begin(), x.end());
    o.b.insert(o.b.end(), y.begin(), y.end());
  }
  std::size_t hits = 0, bad = 0;
  const std::vector<PairResult> got = answers(o);
  for (const PairResult& r : got) hits += r.f, bad += r.bad;
  std::printf("%zu pairs, %zu hits, %zu bad\n", got.size(), hits, bad);
  EXPECT_GT(got.size(), 1000u);
  EXPECT_GT(hits, got.size() / 4);
  EXPECT_LT(bad, got.size() / 20);  // boxes whose corners coincide in a coarse format
}

TEST_P(Range, Range_BeginsAndEndsWhereStated) {
  const PairConfig& config = GetParam();
  const FpFormat f = config.format;
  const auto [low, high] = lengths();
  const auto word = [&](int e) { return f.encode(std::ldexp(1, e)); };
  Operands o;
  std::vector<bool> bad;
  const auto try_words = [&](Shape shape, bool first) {
    for (std::size_t k = 0; k < words(shape); ++k) {
      const Kind of = kind(shape, k);
      if (of == Kind::kPure || of == Kind::kInterval) continue;
      const bool size = is_size(shape, k);
      struct Try {
        std::uint64_t word;
        bool bad;
      };
      std::vector<Try> all{{word(high), false}, {word(high) + 1, true}};
      if (size) {
        all.insert(all.end(), {{word(low), false}, {word(low) - 1, true}, {1, true}});
      } else if (shape != Shape::kAabb) {
        all.push_back({word(high) | f.sign_bit(), false});
        all.push_back({(word(high) + 1) | f.sign_bit(), true});
        if (of == Kind::kLength) all.insert(all.end(), {{1, false}, {word(low) - 1, false}});
      }
      for (const Try& t : all) {
        const oracle::Case c = made(4 * k);
        std::vector<std::uint64_t> x, y;
        for (const double w : c.a) x.push_back(f.encode(w));
        for (const double w : c.b) y.push_back(f.encode(w));
        std::vector<std::uint64_t>& changed = first ? x : y;
        changed[k] = t.word;
        if (shape == Shape::kAabb && k < 3) changed[k] |= f.sign_bit();  // min
        o.a.insert(o.a.end(), x.begin(), x.end());
        o.b.insert(o.b.end(), y.begin(), y.end());
        bad.push_back(t.bad);
        if (of != Kind::kDirection) continue;
        for (const bool below : {false, true}) {  // all components of a direction are small
          std::vector<std::uint64_t> ray = x;
          for (std::size_t d = 3; d < 6; ++d) ray[d] = word(low) - 1;
          if (!below) ray[k] = word(low) | f.sign_bit();
          o.a.insert(o.a.end(), ray.begin(), ray.end());
          o.b.insert(o.b.end(), y.begin(), y.end());
          bad.push_back(below);
        }
      }
    }
  };
  try_words(primary_shape(config.pair), true);
  try_words(secondary_shape(config.pair), false);
  const std::vector<PairResult> got = answers(o);
  for (std::size_t i = 0; i < got.size(); ++i) {
    EXPECT_EQ(got[i].bad, bad[i]) << i;
    if (bad[i]) {
      EXPECT_EQ(got[i].t, f.canonical_nan());
    }
  }
}

/// The fp32 pipes with host arithmetic. Others that build quickly stand for each way of scaling:
/// solids and rays, iterative pipelines, gates, slow operators, shared candidate axes, and a 64-bit
/// container.
std::vector<PairConfig> configurations() {
  constexpr FpFormat kFp16{5, 10}, kFp24{7, 16}, kFp64{11, 52};
  std::vector<PairConfig> all;
  for (unsigned p = 0; p < kPairs; ++p) all.push_back({.pair = static_cast<Pair>(p)});
  for (const Pair pair : {Pair::kRaySphere, Pair::kRayTriangle, Pair::kSphereSphere,
                          Pair::kObbPlane, Pair::kTriangleSphere})
    all.push_back({.pair = pair, .format = kFp16, .lanes = 1});
  all.push_back({.pair = Pair::kRayCylinder, .format = kFp24, .lanes = 1});
  all.push_back({.pair = Pair::kTriangleSphere, .format = kFp64, .lanes = 1});
  const PairConfig slow{.lanes = 1,
                        .arithmetic = Arithmetic::kRtl,
                        .latency = {.add = 2, .mul = 3, .div = 7, .sqrt = 11, .compare = 4}};
  for (const auto& [pair, format] : {std::pair{Pair::kRaySphere, kFp16},
                                     {Pair::kSphereSphere, kFp16},
                                     {Pair::kTriangleSphere, FpFormat{8, 23}}}) {
    PairConfig gates = slow;
    gates.pair = pair, gates.format = format;
    all.push_back(gates);
  }
  return all;
}

std::string label(const ::testing::TestParamInfo<PairConfig>& info) {
  std::ostringstream text;
  text << name(info.param.pair) << '_' << info.param.format.name()
       << (info.param.arithmetic == Arithmetic::kRtl ? "_slow_rtl" : "_host");
  std::string result = text.str();
  std::replace(result.begin(), result.end(), '-', '_');
  return result;
}

INSTANTIATE_TEST_SUITE_P(Pipes, Range, ::testing::ValuesIn(configurations()), label);

/// Two touching boxes in fp16. At size one, T is below the normal numbers, so F is 1.
TEST(Touching, TouchingBoxes_AreAHit) {
  const PairConfig config{.pair = Pair::kObbObb, .format = FpFormat{5, 10}, .lanes = 1};
  std::vector<std::uint64_t> a, b;
  for (const double w : {0., 0., 0., .75, .875, 1., 1., 0., 0., 0., 1., 0., 0., 0., 1.})
    a.push_back(config.format.encode(w));
  for (const double w : {0., 1., -2., 2., .125, 1.375, 1., 0., 0., 0., 1., 0., 0., 0., 1.})
    b.push_back(config.format.encode(w));
  PairUnit unit(config);
  PairResult got, expected;
  (void)unit.test(a, b, std::span(&got, 1));
  reference::test_pairs(config.pair, config.algorithm, config.format, a, b,
                        std::span(&expected, 1));
  EXPECT_EQ(got, expected);
  EXPECT_TRUE(got.f);
  EXPECT_EQ(config.format.decode(got.t), 0);
}

}  // namespace
}  // namespace cde::testing
