// SPDX-License-Identifier: Apache-2.0
// The oracles against FCL and CGAL, which share no code with them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "cde/oracle/build_shape.hpp"
#include "cde/oracle/cases.hpp"
#include "cde/oracle/rays.hpp"
#include "cde/oracle/signed_distance.hpp"
#include "oracle/cgal.hpp"
#include "oracle/fcl.hpp"
#include "printed.hpp"

namespace cde::oracle {
namespace {

constexpr std::uint64_t kSeed = 3;

class FclOracle : public testing::TestWithParam<Pair> {};

TEST_P(FclOracle, SignedDistance_AgreesWithFcl) {
  constexpr int kCount = 1500;
  std::vector<std::pair<Shape, Shape>> pairs;
  for (int i = 0; i < kCount; ++i) {
    Random random(kSeed, static_cast<std::uint64_t>(GetParam()), i);
    const Frame fa = random.rotation(), fb = random.rotation();
    const Shape a = build_shape(random, primary(GetParam()), fa, {});
    const Shape b = build_shape(random, secondary(GetParam()), fb, {});
    const double away = random.uniform(0, 3);
    pairs.emplace_back(a, moved(b, away * random.direction()));
  }
  const auto answers = fcl_signed_distances(pairs);
  const bool ball =
      primary(GetParam()) == ShapeKind::kSphere || secondary(GetParam()) == ShapeKind::kSphere;
  const bool is_round = ball || has_cylinder(GetParam());
  int compared = 0, apart = 0;
  double worst_apart = 0, worst_overlap = 0;
  for (int i = 0; i < kCount; ++i) {
    if (!answers[i]) continue;
    const double fcl = *answers[i];
    const auto& [a, b] = pairs[i];
    ++compared;
    const SignedDistance bounds = signed_distance(a, b, {1e-9});
    // Near round shapes GJK ends early with the distance of two points, which is too large.
    const double size = scene_size(a, b);
    const double below = (bounds.lo - fcl) / size, above = (fcl - bounds.hi) / size;
    EXPECT_LE(below, 2e-9) << i << ": FCL " << fcl << ", s in [" << bounds.lo << ", " << bounds.hi
                           << ']';
    EXPECT_LE(above, is_round ? 1e-5 : 2e-9)
        << i << ": FCL " << fcl << ", s in [" << bounds.lo << ", " << bounds.hi << ']';
    const double error = std::max({0.0, below, above});
    apart += fcl > 0;
    double& worst = fcl > 0 ? worst_apart : worst_overlap;
    worst = std::max(worst, error);
  }
  std::printf(
      "%s: FCL answers %d of %d; %d apart (at worst %.1e S outside the interval), %d overlap "
      "(%.1e S)\n",
      to_string(GetParam()), compared, kCount, apart, worst_apart, compared - apart, worst_overlap);
  EXPECT_GT(compared, ball ? kCount / 2 : kCount * 99 / 100);
  EXPECT_GT(apart, kCount / 8);
  EXPECT_GT(compared - apart, kCount / 8);
}

INSTANTIATE_TEST_SUITE_P(All, FclOracle,
                         testing::Values(Pair::kObbObb, Pair::kTriangleAabb, Pair::kTriangleObb,
                                         Pair::kSphereSphere, Pair::kTriangleSphere,
                                         Pair::kTriangleCylinder, Pair::kCylinderCylinder,
                                         Pair::kObbCylinder, Pair::kSphereObb),
                         [](const auto& info) {
                           std::string name = to_string(info.param);
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

TEST(CgalOracle, DistanceFromATriangle_AgreesWithCgal) {
  int needles = 0;
  for (int i = 0; i < 3000; ++i) {
    Random random(kSeed, 100, i);
    Build build;
    if (random.chance(0.5)) build.thin = random.decades(1e-5, 1e-2), ++needles;
    build.plate = random.chance(0.5);
    const Frame frame = random.rotation();
    const auto triangle =
        std::get<Triangle>(build_shape(random, ShapeKind::kTriangle, frame, build));
    const double away = random.decades(1e-3, 3);
    const Vec p = triangle.v0 + away * random.direction();
    const double exact = std::sqrt(cgal_squared_distance(p, triangle));
    EXPECT_NEAR(distance(p, triangle), exact, 1e-14) << i;
    const SignedDistance bounds = signed_distance(Triangle{p, p, p}, triangle);
    EXPECT_LE(bounds.lo, exact) << i;
    EXPECT_GE(bounds.hi, exact) << i;
  }
  EXPECT_GT(needles, 1000);
}

TEST(CgalOracle, TrianglesMeetingBoxes_AgreeWithCgal) {
  int met = 0, decided = 0;
  for (int i = 0; i < 3000; ++i) {
    const Case c = generate(Pair::kTriangleAabb, kSeed, i);
    const Shape a = c.shape_a(), b = c.shape_b();
    bool meet;
    try {
      meet = cgal_intersect(std::get<Triangle>(a), std::get<Aabb>(b));
    } catch (const std::invalid_argument&) {
      continue;  // no area
    }
    // Touching counts as contact in both libraries; only distances within the interval's width are
    // uncertain.
    const SignedDistance bounds = signed_distance(a, b);
    if (bounds.lo > 0 || bounds.hi < 0) {
      EXPECT_EQ(meet, bounds.hi < 0) << c.describe();
      ++decided;
    }
    met += meet;
  }
  std::printf("triangle-aabb: %d of 3000 decided and like CGAL, %d meet\n", decided, met);
  EXPECT_GT(decided, 2600);
  EXPECT_GT(met, 900);
  EXPECT_LT(met, 2100);
}

TEST(CgalOracle, RaysHittingTriangles_AgreeWithCgal) {
  int hits = 0, compared = 0;
  for (int i = 0; i < 3000; ++i) {
    const Case c = generate(Pair::kRayTriangle, kSeed, i);
    Ray ray = c.ray();
    ray.tmin = 0, ray.tmax = std::numeric_limits<double>::infinity();
    const auto triangle = std::get<Triangle>(c.shape_b());
    const Vec normal = (triangle.v1 - triangle.v0).cross(triangle.v2 - triangle.v0);
    if (normal.dot(ray.d) == 0) continue;  // CGAL counts hits in the plane, the pipe does not
    try {
      const bool hit = cgal_intersect(ray, triangle);
      EXPECT_EQ(cast(ray, triangle).hit, hit) << c.describe();
      hits += hit, ++compared;
    } catch (const std::invalid_argument&) {
    }
  }
  std::printf("ray-triangle: %d compared with CGAL, %d hit\n", compared, hits);
  EXPECT_GT(compared, 2500);
  EXPECT_GT(hits, compared * 3 / 10);
  EXPECT_LT(hits, compared * 7 / 10);
}

}  // namespace
}  // namespace cde::oracle
