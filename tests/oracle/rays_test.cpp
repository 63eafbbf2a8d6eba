// SPDX-License-Identifier: Apache-2.0
// Exact answers for rays: known ones, and margins that have the stated meaning.
#include "cde/oracle/rays.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>

#include "cde/oracle/random.hpp"
#include "printed.hpp"

namespace cde::oracle {
namespace {

constexpr std::uint64_t kSeed = 5;
constexpr double kInf = std::numeric_limits<double>::infinity();
const Vec kX = Vec::UnitX(), kZ = Vec::UnitZ(), kO = Vec::Zero();

struct Known {
  const char* name;
  Ray ray;
  Shape target;
  double t;       // kInf for a miss
  double margin;  // of F, as a length
};
void PrintTo(const Known& known, std::ostream* out) {
  *out << known.name;
}

RayAnswer cast_at(const Ray& ray, const Shape& target) {
  if (const auto* s = std::get_if<Sphere>(&target)) return cast(ray, *s);
  if (const auto* s = std::get_if<Cylinder>(&target)) return cast(ray, *s);
  return cast(ray, std::get<Triangle>(target));
}

class KnownRay : public testing::TestWithParam<Known> {};

TEST_P(KnownRay, Case_HasItsAnswer) {
  const auto& [name, ray, target, t, margin] = GetParam();
  const RayAnswer answer = cast_at(ray, target);
  EXPECT_EQ(answer.hit, t < kInf);
  EXPECT_EQ(answer.t, t);
  EXPECT_EQ(answer.point, answer.hit ? Vec(ray.o + t * ray.d) : kO);
  if (margin < kInf)
    EXPECT_NEAR(answer.margin * answer.scale, margin, 1e-12);
  else
    EXPECT_EQ(answer.margin, kInf);
}

Ray from(const Vec& o, const Vec& d, double tmin = 0, double tmax = kInf) {
  return {o, d, tmin, tmax};
}
const Sphere kBall{kO, 2};
const Cylinder kCan{kO, kZ, 2, 1};
const Triangle kFlat{Vec(0, 0, 1), Vec(4, 0, 1), Vec(0, 4, 1)};

INSTANTIATE_TEST_SUITE_P(
    All, KnownRay,
    testing::Values(
        Known{"ball_ahead", from(Vec(-6, 0, 0), kX), kBall, 4, 2},
        Known{"ball_longer_direction", from(Vec(-6, 0, 0), 4 * kX), kBall, 1, 2},
        Known{"ball_behind", from(Vec(3, 0, 0), kX), kBall, kInf, 1},
        Known{"ball_from_inside_is_its_exit", from(Vec(1, 0, 0), kX), kBall, 1, 1},
        Known{"ball_entry_before_tmin_is_its_exit", from(Vec(-6, 0, 0), kX, 5), kBall, 8, 2},
        Known{"ball_between_the_crossings", from(Vec(-6, 0, 0), kX, 5, 7), kBall, kInf, 1},
        Known{"ball_at_tmax", from(Vec(-6, 0, 0), kX, 0, 4), kBall, 4, 0},
        Known{"ball_after_tmax", from(Vec(-6, 0, 0), kX, 0, std::nextafter(4, 0)), kBall, kInf, 0},
        Known{"ball_at_tmin", from(Vec(-6, 0, 0), kX, 4), kBall, 4, 2},
        Known{"ball_after_tmin", from(Vec(-6, 0, 0), kX, std::nextafter(4, 5)), kBall, 8, 2},
        Known{"ball_tangent", from(Vec(-6, 2, 0), kX), kBall, 6, 0},
        Known{"ball_beside", from(Vec(-6, 2.5, 0), kX), kBall, kInf, 0.5},
        Known{"ball_empty_interval", from(Vec(-6, 0, 0), kX, 9, 1), kBall, kInf, kInf},
        Known{"ball_negative_t", from(Vec(6, 0, 0), kX, -kInf), kBall, -8, 2},
        Known{"can_side", from(Vec(-4, 0, 0), kX), kCan, 3, 1},
        Known{"can_cap", from(Vec(0.25, 0, -6), kZ), kCan, 4, 0.75},
        Known{"can_from_inside_is_its_exit", from(Vec(0.25, 0, 1), kZ), kCan, 1, 0.75},
        Known{"can_down_its_side", from(Vec(1, 0, -6), kZ), kCan, 4, 0},
        Known{"can_parallel_outside", from(Vec(1.5, 0, -6), kZ), kCan, kInf, 0.5},
        Known{"can_over_its_cap", from(Vec(-4, 0, 2.5), kX), kCan, kInf, 0.5},
        Known{"can_along_its_cap", from(Vec(-4, 0, 2), kX), kCan, 3, 0},
        Known{"can_beside", from(Vec(-4, 1.25, 0), kX), kCan, kInf, 0.25},
        Known{"can_rim", from(Vec(-3, 0, 0), Vec(1, 0, 1)), kCan, 2, 0},
        Known{"can_past_its_rim", from(Vec(-4, 0, 0), Vec(1, 0, 1)), kCan, kInf, 0.5},
        Known{"triangle_ahead", from(Vec(1, 1, -2), kZ), kFlat, 3, 1},
        Known{"triangle_from_the_back", from(Vec(1, 1, 3), -kZ), kFlat, 2, 1},
        Known{"triangle_edge", from(Vec(1, 0, 0), kZ), kFlat, 1, 0},
        Known{"triangle_vertex", from(Vec(4, 0, 0), 0.5 * kZ), kFlat, 2, 0},
        Known{"triangle_beside", from(Vec(1, -0.5, 0), kZ), kFlat, kInf, 0.5},
        Known{"triangle_in_its_plane", from(Vec(-1, 1, 1), kX), kFlat, kInf, 0},
        Known{"triangle_above_its_plane", from(Vec(-1, 1, 1.5), kX), kFlat, kInf, 0.5},
        Known{"triangle_without_area", from(Vec(1, 0.5, -2), kZ), Triangle{kO, 2 * kX, 4 * kX},
              kInf, 0.5}),
    [](const auto& info) { return info.param.name; });

TEST(RayMargin, DisplacementWithinTheMargin_KeepsTheDecision) {
  for (const Pair pair : {Pair::kRaySphere, Pair::kRayCylinder}) {
    int kept = 0, flipped = 0;
    for (int i = 0; i < 1500; ++i) {
      const Case c = generate(pair, kSeed, i);
      const Ray ray = c.ray();
      const RayAnswer answer = cast(c);
      if (!std::isfinite(answer.margin) || answer.margin < 1e-13) continue;
      const double length = answer.margin * answer.scale;
      Random random(kSeed, 1, i);
      bool flips = false;
      for (int k = 0; k < 4; ++k) {
        const Shape near = moved(c.shape_b(), 0.3 * length * random.direction());
        EXPECT_EQ(cast_at(ray, near).hit, answer.hit) << c.describe();
        ++kept;
        // A slightly larger displacement, in one of a few directions, changes the answer.
        flips |=
            cast_at(ray, moved(c.shape_b(), 10 * length * random.direction())).hit != answer.hit;
      }
      flipped += flips;
    }
    EXPECT_GT(kept, 4000);
    EXPECT_GT(flipped, 500) << "the margin would be far too small";
    std::printf("%s: F kept by %d displacements of 0.3 margins, %d cases flipped by 10 margins\n",
                to_string(pair), kept, flipped);
  }
}

TEST(RayCheck, FAndT_AreCheckedAgainstTheBands) {
  const Ray ray = from(Vec(-6, 1, 0), kX);
  const RayAnswer answer = cast(ray, kBall);
  ASSERT_TRUE(answer.hit);
  const double tolerance = 0x1p-20;
  const auto decision = [&](bool f, double t, const Vec& cp, double band = 0x1p-20) {
    return check(ray, answer, f, t, cp, band, tolerance);
  };
  EXPECT_TRUE(decision(true, answer.t, answer.point).ok);
  EXPECT_FALSE(decision(true, answer.t * (1 + 0x1p-16), answer.point).ok);
  EXPECT_FALSE(decision(true, answer.t, answer.point + 1e-4 * kZ).ok);
  EXPECT_FALSE(decision(true, std::numeric_limits<double>::quiet_NaN(), answer.point).ok);
  EXPECT_FALSE(decision(false, kInf, kO).ok);
  EXPECT_TRUE(decision(false, kInf, kO, 0.5).excused);
  const Ray past = from(Vec(-6, 3, 0), kX);
  const RayAnswer miss = cast(past, kBall);
  EXPECT_TRUE(check(past, miss, false, kInf, kO, 0x1p-20, tolerance).ok);
  EXPECT_FALSE(check(past, miss, false, 0, kO, 0x1p-20, tolerance).ok);
  EXPECT_FALSE(check(past, miss, true, 6, Vec(0, 2, 0), 0x1p-20, tolerance).ok);
}

TEST(RayAnswer, ZeroDirection_IsRefused) {
  for (const Shape& target : {Shape(kBall), Shape(kCan), Shape(kFlat)})
    EXPECT_THROW((void)cast_at(from(kX, kO), target), std::invalid_argument);
}

TEST(RayAnswer, CosineAndThinness_AreKnown) {
  EXPECT_DOUBLE_EQ(cast(from(Vec(-6, 1, 0), kX), kBall).cosine, std::sqrt(0.75));
  EXPECT_DOUBLE_EQ(cast(from(Vec(0.25, 0, -6), kZ), kCan).cosine, 1);
  EXPECT_DOUBLE_EQ(cast(from(Vec(-4, 0.5, 0), kX), kCan).cosine, std::sqrt(0.75));
  EXPECT_DOUBLE_EQ(cast(from(Vec(1, 1, 0), kZ), kFlat).cosine, 1);
  EXPECT_DOUBLE_EQ(cast(from(Vec(1, 1, 0), kZ), kFlat).aspect, 2);
  EXPECT_EQ(cast(from(Vec(1, 1, 0), kZ), Triangle{kO, kX, 2 * kX}).aspect, kInf);
}

TEST(RayTriangle, Decision_IsExactInBinary64) {
  const double inside = 0x1p-52, outside = -0x1p-52;  // of the edge on the y axis
  EXPECT_TRUE(cast(from(Vec(inside, 0.5, -1), kZ), kFlat).hit);
  EXPECT_TRUE(cast(from(Vec(0, 0.5, -1), kZ), kFlat).hit);
  EXPECT_FALSE(cast(from(Vec(outside, 0.5, -1), kZ), kFlat).hit);
}

}  // namespace
}  // namespace cde::oracle
