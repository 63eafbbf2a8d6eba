// SPDX-License-Identifier: Apache-2.0
// The generated operands are valid, reproducible, and close to the decisions.
#include "cde/oracle/cases.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>

#include "cde/oracle/random.hpp"
#include "cde/oracle/rays.hpp"
#include "cde/oracle/signed_distance.hpp"
#include "printed.hpp"

namespace cde::oracle {
namespace {

constexpr std::uint64_t kSeed = 11;
constexpr int kCount = 1120;

/// The input contract, with its tolerance of 2^-20.
struct Valid {
  bool operator()(const Triangle&) const { return true; }
  bool operator()(const Sphere& s) const { return s.r > 0; }
  bool operator()(const Aabb& s) const { return (s.max.array() > s.min.array()).all(); }
  bool operator()(const Plane& s) const { return std::abs(s.n.squaredNorm() - 1) <= 0x1p-20; }
  bool operator()(const Cylinder& s) const {
    return s.half_height > 0 && s.radius > 0 && std::abs(s.axis.squaredNorm() - 1) <= 0x1p-20;
  }
  bool operator()(const Obb& s) const {
    const Eigen::Matrix3d defect = s.rotation.transpose() * s.rotation - Frame::Identity();
    return s.half.minCoeff() > 0 && defect.cwiseAbs().maxCoeff() <= 0x1p-20;
  }
  using Frame = Eigen::Matrix3d;
};

class EveryPair : public testing::TestWithParam<Pair> {};

TEST_P(EveryPair, Cases_AreValidAndReproducible) {
  std::map<std::string, int> families;
  for (int i = 0; i < kCount; ++i) {
    const Case c = generate(GetParam(), kSeed, i), again = generate(GetParam(), kSeed, i);
    EXPECT_EQ(c.describe(), again.describe());
    ASSERT_EQ(c.a.size(), word_count(primary(GetParam())));
    ASSERT_EQ(c.b.size(), word_count(secondary(GetParam())));
    for (const double word : c.b) EXPECT_TRUE(std::isfinite(word)) << c.describe();
    EXPECT_TRUE(std::visit(Valid{}, c.shape_b())) << c.describe();
    if (has_ray(GetParam())) {
      EXPECT_TRUE(c.ray().o.allFinite() && c.ray().d.allFinite()) << c.describe();
      EXPECT_FALSE(c.ray().d.isZero(0)) << c.describe();
      EXPECT_FALSE(std::isnan(c.a[6]) || std::isnan(c.a[7])) << c.describe();
    } else {
      EXPECT_TRUE(std::visit(Valid{}, c.shape_a())) << c.describe();
    }
    ++families[c.family];
  }
  EXPECT_GE(families.size(), 13U);
  EXPECT_NE(generate(GetParam(), kSeed, 0).describe(),
            generate(GetParam(), kSeed + 1, 0).describe());
}

TEST_P(EveryPair, Cases_AreHalfNearTheDecision) {
  int near = 0, hits = 0, even_hits = 0, band = 0;
  for (int i = 0; i < kCount; ++i) {
    const Case c = generate(GetParam(), kSeed, i);
    bool hit, close;
    if (has_ray(GetParam())) {
      const RayAnswer answer = cast(c);
      hit = answer.hit;
      close = answer.margin < 2e-3;
      band += answer.margin < 0x1p-20;
    } else {
      const Shape a = c.shape_a(), b = c.shape_b();
      const SignedDistance distance = signed_distance(a, b, {1e-6});
      hit = distance.middle() <= 0;
      close = std::abs(distance.middle()) < 2e-3 * scene_size(a, b);
      band += std::abs(distance.middle()) < 0x1p-20 * scene_size(a, b);
    }
    hits += hit;
    if (i % 2 == 0) near += close, even_hits += hit;
  }
  std::printf("%s: %d cases, %d hit, %d within 16 u; near the decision %d, %d hit\n",
              to_string(GetParam()), kCount, hits, band, kCount / 2, even_hits);
  EXPECT_GT(near, kCount / 2 * 95 / 100);
  EXPECT_GT(hits, kCount * 3 / 10);
  EXPECT_LT(hits, kCount * 75 / 100);
  EXPECT_GT(even_hits, kCount / 2 * 3 / 10);
  EXPECT_LT(even_hits, kCount / 2 * 7 / 10);
}

/// The processor rounds to nearest even in binary32.
TEST(OracleFormats, RoundAndStep_EqualTheProcessor) {
  const Format format;
  Random random(kSeed, 0, 0);
  int checked = 0;
  for (int i = 0; i < 1000000; ++i) {
    const auto x = std::bit_cast<double>((random.bits() & ~(std::uint64_t{0x7ff} << 52)) |
                                         (std::uint64_t(860 + random.below(310)) << 52));
    const auto expected = static_cast<float>(x);
    ASSERT_EQ(format.round(x), static_cast<double>(expected)) << x;
    if (std::isinf(expected)) continue;
    const float to = random.chance(0.5) ? INFINITY : -INFINITY;
    ASSERT_EQ(format.next(expected, to), static_cast<double>(std::nextafter(expected, to)));
    ++checked;
  }
  EXPECT_GT(checked, 900000);
  for (int e = -149; e < 128; ++e)  // where the spacing changes
    for (const float to : {-INFINITY, INFINITY}) {
      const float x = std::ldexp(1.0f, e);
      ASSERT_EQ(format.next(x, to), static_cast<double>(std::nextafter(x, to))) << e;
    }
  EXPECT_EQ(format.next(0, 1), 0x1p-149);
  EXPECT_EQ(format.round(0x1.fffffep127), 0x1.fffffep127);
  const Format half{5, 10}, twice{11, 52};
  EXPECT_EQ(half.round(65519), 65504);
  EXPECT_EQ(half.round(65520), INFINITY);
  EXPECT_EQ(half.round(1 + 0x1p-11), 1);
  EXPECT_EQ(half.round(1 + 0x3p-11), 1 + 0x1p-9);
  EXPECT_EQ(half.round(0x3p-26), 0x1p-24);
  EXPECT_EQ(half.next(1, 0), 1 - 0x1p-11);
  for (const double x : {0.0, 1.0, -1.0, 1 + 0x1p-52, 0.1})
    for (const double to : {-INFINITY, INFINITY}) {
      EXPECT_EQ(twice.round(x), x);
      EXPECT_EQ(twice.next(x, to), std::nextafter(x, to)) << x;
    }
}

TEST_P(EveryPair, Cases_FitTheRequestedFormat) {
  for (const Format format : {Format{5, 10}, Format{8, 7}, Format{7, 16}, Format{11, 52}}) {
    int finer = 0;
    for (int i = 0; i < 280; ++i) {
      const Case c = generate(GetParam(), kSeed, i, format);
      for (const auto* words : {&c.a, &c.b})
        for (const double x : *words) {
          EXPECT_TRUE(std::isnan(x) || format.round(x) == x) << c.describe();
          finer += Format{}.round(x) != x;
        }
    }
    if (format.man_bits > 23)
      EXPECT_GT(finer, 280);
    else
      EXPECT_EQ(finer, 0);
  }
}

TEST_P(EveryPair, EverydayCases_AreValidAndReproducible) {
  for (const Format format : {Format{}, Format{5, 10}, Format{11, 52}}) {
    std::map<std::string, int> families;
    int whole = 0;
    for (int i = 0; i < kCount; ++i) {
      const Case c = everyday(GetParam(), kSeed, i, format);
      EXPECT_EQ(c.describe(), everyday(GetParam(), kSeed, i, format).describe());
      for (const auto* words : {&c.a, &c.b})
        for (const double x : *words) EXPECT_TRUE(format.round(x) == x) << c.describe();
      if (format.man_bits >= 23) {
        EXPECT_TRUE(std::visit(Valid{}, c.shape_b())) << c.describe();
      }
      if (has_ray(GetParam())) {
        EXPECT_TRUE(c.ray().d.allFinite() && !c.ray().d.isZero(0)) << c.describe();
      } else if (format.man_bits >= 23) {
        EXPECT_TRUE(std::visit(Valid{}, c.shape_a())) << c.describe();
      }
      ++families[c.family];
      whole += std::all_of(c.b.begin(), c.b.end(), [](double x) { return x == std::round(x); });
    }
    EXPECT_GE(families.size(), 5U);
    EXPECT_GT(whole, kCount / 20) << "too few whole numbers";
  }
  EXPECT_NE(everyday(GetParam(), kSeed, 0).describe(), generate(GetParam(), kSeed, 0).describe());
}

TEST_P(EveryPair, Words_KeepTheShape) {
  for (int i = 0; i < 100; ++i) {
    const Case c = generate(GetParam(), kSeed, i);
    EXPECT_EQ(to_words(c.shape_b()), c.b);
    EXPECT_EQ(has_ray(GetParam()) ? to_words(c.ray()) : to_words(c.shape_a()), c.a);
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryPair, testing::ValuesIn(kPairs), [](const auto& info) {
  std::string name = to_string(info.param);
  std::ranges::replace(name, '-', '_');
  return name;
});

TEST(OracleWords, Words_AreInSlotOrder) {
  const std::vector<double> words = {1, 2, 3, 4, 5, 6, 0, -1, 0, 1, 0, 0, 0, 0, 1};
  const auto box = std::get<Obb>(shape_from_words(ShapeKind::kObb, words));
  EXPECT_EQ(box.c, Vec(1, 2, 3));
  EXPECT_EQ(box.half, Vec(4, 5, 6));
  EXPECT_EQ(box.rotation.col(0), Vec::UnitY());  // words 6, 9, 12
  EXPECT_EQ(support(box, Vec::UnitY()), 2 + 4);
  const std::vector<double> can = {1, 2, 3, 0, 0, 1, 4, 5};
  const auto cylinder = std::get<Cylinder>(shape_from_words(ShapeKind::kCylinder, can));
  EXPECT_EQ(cylinder.half_height, 4);
  EXPECT_EQ(cylinder.radius, 5);
  EXPECT_THROW((void)shape_from_words(ShapeKind::kSphere, can), std::invalid_argument);
  EXPECT_THROW((void)shape_from_words(ShapeKind::kRay, can), std::invalid_argument);
}

}  // namespace
}  // namespace cde::oracle
