// SPDX-License-Identifier: Apache-2.0
// Ray pipes bit for bit where random operands rarely occur: ties of the dominant axis, and hits at
// infinity or at -0.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "../printed.hpp"
#include "cde/card/pair_unit.hpp"
#include "cde/reference/pairs.hpp"
#include "pair_failure.hpp"

namespace {

using cde::Algorithm;
using cde::Pair;
using cde::PairConfig;
using cde::PairResult;
using Words = std::vector<std::uint64_t>;

constexpr unsigned kSeed = 20261121;
constexpr float kInf = std::numeric_limits<float>::infinity();

void push(Words& to, std::initializer_list<float> values) {
  for (const float x : values) to.push_back(std::bit_cast<std::uint32_t>(x));
}
float number(std::uint64_t word) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(word));
}

std::vector<PairResult> reference_of(const PairConfig& c, const Words& a, const Words& b) {
  std::vector<PairResult> r(a.size() / cde::primary_words(c.pair));
  cde::reference::test_pairs(c.pair, c.algorithm, c.format, a, b, r, c.plane, {}, c.box);
  return r;
}

void expect_equal(const PairConfig& config, const Words& a, const Words& b) {
  cde::PairUnit unit(config);
  const std::vector<PairResult> expected = reference_of(config, a, b);
  std::vector<PairResult> got(expected.size());
  (void)unit.test(a, b, got);
  for (std::size_t i = 0; i < got.size(); ++i)
    ASSERT_EQ(got[i], expected[i]) << "pair " << i << "\n"
                                   << cde::testing::failure_report({config, a, b, i});
}

/// The same pairs with axes j and k exchanged in every vector except the interval.
Words exchanged(Words words, std::size_t stride, std::size_t vectors, std::size_t j,
                std::size_t k) {
  for (std::size_t i = 0; i < words.size(); i += stride)
    for (std::size_t v = 0; v < vectors; ++v) std::swap(words[i + 3 * v + j], words[i + 3 * v + k]);
  return words;
}

class DominantAxisTies : public ::testing::TestWithParam<Algorithm> {};

/// Triangles in x + y = 1, and the same for every pair of axes, against rays that are equally steep
/// along both axes. With the two axes exchanged the reference selects the other one, and some
/// answers differ in bits. A pipe that selects the wrong axis would fail.
TEST_P(DominantAxisTies, TiedAxes_TakeTheLowest) {
  const PairConfig config{.algorithm = GetParam()};
  std::mt19937 random(kSeed);
  const auto unit = [&random] { return static_cast<float>(random()) * 0x1p-32f; };
  Words all_a, all_b;
  for (std::size_t j = 0; j < 3; ++j) {
    const std::size_t k = (j + 1) % 3, l = (j + 2) % 3;
    Words a, b;
    for (int i = 0; i < 4000; ++i) {
      std::array<std::array<float, 3>, 3> v{};
      for (auto& p : v) {
        // Multiples of 2^-20, so that 1 - p and the edges are exact, and the components of the
        // normal tie.
        const auto grid = [&] { return std::round(std::ldexp(4 * unit() - 2, 20)) * 0x1p-20f; };
        p[j] = grid(), p[k] = 1 - p[j], p[l] = grid();
      }
      const float s = random() % 2 == 0 ? 1 : -1;
      std::array<float, 3> d{}, o{};
      d[j] = s * (1 + unit()), d[k] = random() % 4 != 0 ? d[j] : -d[j];
      d[l] = (2 * unit() - 1) * std::abs(d[j]);
      // Half of the rays pass through an edge, where rounding decides.
      const float x = i % 2 == 0 ? 0 : 1.2f * unit(), y = (1.2f - x) * unit(), t = 1 + 3 * unit();
      for (std::size_t m = 0; m < 3; ++m)
        o[m] = v[0][m] * (1 - x - y) + v[1][m] * x + v[2][m] * y - t * d[m];
      push(a, {o[0], o[1], o[2], d[0], d[1], d[2], 0, kInf});
      for (const auto& p : v) push(b, {p[0], p[1], p[2]});
    }
    const auto here = reference_of(config, a, b),
               there = reference_of(config, exchanged(a, 8, 2, j, k), exchanged(b, 9, 3, j, k));
    std::size_t hits = 0, other = 0;
    for (std::size_t i = 0; i < here.size(); ++i)
      hits += here[i].f, other += here[i].f != there[i].f || here[i].t != there[i].t;
    std::printf("%s, axes %zu and %zu: seed %u, %zu pairs, %zu hits, %zu differ by the tie\n",
                std::string(name(GetParam())).c_str(), j, k, kSeed, here.size(), hits, other);
    EXPECT_GT(hits, here.size() / 4);
    EXPECT_GT(other, 20u) << "the choice of the axis changes no answer";
    all_a.insert(all_a.end(), a.begin(), a.end());
    all_b.insert(all_b.end(), b.begin(), b.end());
  }
  expect_equal(config, all_a, all_b);
}

INSTANTIATE_TEST_SUITE_P(Algorithms, DominantAxisTies,
                         ::testing::Values(Algorithm::kBadouel, Algorithm::kWatertight),
                         [](const auto& info) { return std::string(name(info.param)); });

/// Rays along the z axis from anywhere towards a shape in z = 0, with directions of any size. T and
/// CP beyond the format are misses, and T = 0 has no sign.
struct RayPipe : PairConfig {
  friend void PrintTo(const RayPipe& p, std::ostream* out) { *out << name(p.pair); }
};
class RayExtremes : public ::testing::TestWithParam<RayPipe> {};

TEST_P(RayExtremes, Hits_AreFiniteAndNeverMinusZero) {
  const PairConfig config = GetParam();
  std::mt19937 random(kSeed);
  Words a, b;
  for (int i = 0; i < 6000; ++i) {
    const float o = i % 3 == 0 ? 0.0f : std::ldexp(1.0f, static_cast<int>(random() % 40)),
                d = std::ldexp(1.0f, static_cast<int>(random() % 260) - 149);
    push(a, {0, 0, o, 0, 0, i % 6 < 3 ? -d : d, i % 5 == 0 ? -1.0f : 0.0f, kInf});
    if (config.pair == Pair::kRayTriangle)
      push(b, {-1, -1, 0, 2, -1, 0, -1, 2, 0});
    else if (config.pair == Pair::kRaySphere)
      push(b, {0, 0, -1, 1});
    else
      push(b, {0, 0, -1, 0, 0, 1, 1, 1});
  }
  std::size_t hits = 0, zeros = 0;
  for (const PairResult& r : reference_of(config, a, b)) {
    if (!r.f) continue;
    ++hits, zeros += r.t == 0;
    EXPECT_TRUE(std::isfinite(number(r.t)));
    for (const std::uint64_t x : r.cp) EXPECT_TRUE(std::isfinite(number(x)));
    EXPECT_NE(r.t, std::bit_cast<std::uint32_t>(-0.0f));
  }
  EXPECT_GT(hits, 600u);
  EXPECT_LT(hits, 5400u) << "no hit is out of range";
  EXPECT_GT(zeros, 100u);
  expect_equal(config, a, b);
}

/// Every angle from a cylinder's axis down to zero. r^2 / A overflows long before 1 / A does.
TEST(RayNearCylinderAxis, AnyTilt_HitsTheCylinder) {
  const PairConfig config{.pair = Pair::kRayCylinder};
  std::mt19937 random(kSeed);
  Words a, b;
  for (int i = 0; i < 6000; ++i) {
    const float tilt = std::ldexp(1.0f, -static_cast<int>(random() % 150));
    push(a, {i % 2 == 0 ? 0.5f : 2.5f, i % 3 == 0 ? 1.0f : 0.0f, -4, i % 5 < 2 ? tilt : 0,
             i % 5 < 3 ? -tilt : tilt, 1, 0, kInf});
    push(b, {0, 0, 0, 0, 0, 1, 1, 2});
  }
  std::size_t hits = 0;
  const std::vector<PairResult> expected = reference_of(config, a, b);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    hits += expected[i].f;
    if (std::abs(number(a[8 * i + 4])) < 0.1f) {
      EXPECT_EQ(expected[i].f, i % 2 == 0) << i;
    }
  }
  EXPECT_GT(hits, 2000u);
  expect_equal(config, a, b);
}

std::vector<RayPipe> ray_pipes() {
  std::vector<RayPipe> all = {{PairConfig{.pair = Pair::kRaySphere}},
                              {PairConfig{.pair = Pair::kRayCylinder}}};
  for (unsigned a = 0; a < 4; ++a)
    for (const bool box : {false, true})
      all.push_back({PairConfig{.algorithm = static_cast<Algorithm>(a), .box = box}});
  return all;
}

INSTANTIATE_TEST_SUITE_P(Rays, RayExtremes, ::testing::ValuesIn(ray_pipes()), [](const auto& info) {
  const PairConfig& c = info.param;
  std::string text(name(c.pair));
  if (c.pair == Pair::kRayTriangle) text.append("_").append(name(c.algorithm));
  if (c.box) text += "_box";
  std::replace(text.begin(), text.end(), '-', '_');
  return text;
});

}  // namespace
