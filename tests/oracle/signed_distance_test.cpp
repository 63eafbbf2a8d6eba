// SPDX-License-Identifier: Apache-2.0
// The certified signed distance: known answers, invariants, and intervals that contain the true
// value.
#include "cde/oracle/signed_distance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include "cde/oracle/build_shape.hpp"
#include "cde/oracle/cases.hpp"
#include "cde/oracle/random.hpp"
#include "printed.hpp"

namespace cde::oracle {
namespace {

constexpr std::uint64_t kSeed = 20240611;
const Eigen::Matrix3d kNoTurn = Eigen::Matrix3d::Identity();

Triangle point_triangle(const Vec& p) {
  return {p, p, p};
}
Obb cube(const Vec& c) {
  return {c, Vec::Ones(), kNoTurn};
}
Obb turned_cube(const Vec& c) {
  return {c, Vec::Ones(), Frame(Eigen::AngleAxisd(std::numbers::pi / 4, Vec::UnitZ()))};
}
Cylinder can(const Vec& c, const Vec& axis) {
  return {c, axis, 2, 1};
}

struct Known {
  const char* name;
  Shape a, b;
  double s;
};
void PrintTo(const Known& known, std::ostream* out) {
  *out << known.name;
}

class KnownDistance : public testing::TestWithParam<Known> {};

TEST_P(KnownDistance, KnownDistance_LiesInTheInterval) {
  const auto& [name, a, b, s] = GetParam();
  for (const bool swapped : {false, true}) {
    const SignedDistance bounds = swapped ? signed_distance(b, a) : signed_distance(a, b);
    EXPECT_LE(bounds.lo, s) << "swapped: " << swapped;
    EXPECT_GE(bounds.hi, s) << "swapped: " << swapped;
    EXPECT_LE(bounds.hi - bounds.lo, 1.1e-8 * scene_size(a, b));
    EXPECT_NEAR(swapped ? distance_along(b, a, bounds.n) : distance_along(a, b, bounds.n),
                bounds.lo, 1e-13 * scene_size(a, b));
  }
}

const double kRoot2 = std::sqrt(2.0);
const Vec kX = Vec::UnitX(), kY = Vec::UnitY(), kZ = Vec::UnitZ(), kO = Vec::Zero();

INSTANTIATE_TEST_SUITE_P(
    All, KnownDistance,
    testing::Values(
        Known{"spheres_apart", Sphere{kO, 1}, Sphere{Vec(3, 4, 0), 2}, 2},
        Known{"spheres_touching", Sphere{kO, 1}, Sphere{Vec(0, 3, 4), 4}, 0},
        Known{"spheres_concentric", Sphere{kO, 1}, Sphere{kO, 2}, -3},
        Known{"boxes_corner_to_corner", cube(kO), cube(Vec(5, 6, 14)), 13},
        Known{"boxes_edge_to_edge", cube(kO), cube(Vec(5, 6, 0.5)), 5},
        Known{"boxes_face_to_face", cube(kO), cube(Vec(0.5, -0.25, 2)), 0},
        Known{"boxes_stacked", cube(kO), cube(Vec(0, 0, 1.75)), -0.25},
        Known{"boxes_corner_on_corner", cube(kO), cube(Vec(2, 2, 2)), 0},
        Known{"boxes_concentric", cube(kO), Obb{kO, Vec(0.5, 0.25, 0.125), kNoTurn}, -1.125},
        Known{"boxes_edge_to_face", cube(kO), turned_cube(Vec(3, 0, 0)), 2 - kRoot2},
        Known{"boxes_crossed_edges",  // edges along y + z and along x cross above each other
              Obb{kO, Vec::Ones(), Frame(Eigen::AngleAxisd(std::numbers::pi / 4, kY))},
              Obb{Vec(0, 0, 3), Vec::Ones(), Frame(Eigen::AngleAxisd(std::numbers::pi / 4, kX))},
              3 - 2 * kRoot2},
        Known{"sphere_beside_box", Sphere{Vec(4, 5, 0), 2}, cube(kO), 3},
        Known{"sphere_centre_inside_box", Sphere{Vec(0.75, 0.5, 0), 0.5}, cube(kO), -0.75},
        Known{"sphere_centre_in_box_centre", Sphere{kO, 0.5}, cube(kO), -1.5},
        Known{"triangle_above_aabb", Triangle{Vec(0, 0, 2), Vec(9, 0, 2), Vec(0, 9, 2)},
              Aabb{-Vec::Ones(), Vec::Ones()}, 1},
        Known{"triangle_through_aabb",
              Triangle{Vec(-9, -9, 0.75), Vec(9, 0, 0.75), Vec(0, 9, 0.75)},
              Aabb{-Vec::Ones(), Vec::Ones()}, -0.25},
        Known{"triangle_cuts_corner",  // x + y + z = 2.5 passes (1, 1, 1) by 0.5 / sqrt(3)
              Triangle{Vec(12.5, -5, -5), Vec(-5, 12.5, -5), Vec(-5, -5, 12.5)},
              Aabb{-Vec::Ones(), Vec::Ones()}, -0.5 / std::sqrt(3.0)},
        Known{"sphere_over_triangle", Triangle{kO, 4 * kX, 4 * kY}, Sphere{Vec(1, 1, 0.5), 1},
              -0.5},
        Known{"sphere_off_vertex", Triangle{kO, 4 * kX, 4 * kY}, Sphere{Vec(-3, -4, 0), 1}, 4},
        Known{"cylinders_side_by_side", can(kO, kZ), can(Vec(3, 4, 1), kZ), 3},
        Known{"cylinders_on_end", can(kO, kZ), can(Vec(0.5, 0, 4), -kZ), 0},
        Known{"cylinders_coaxial", can(kO, kZ), can(kO, kZ), -2},
        Known{"cylinders_crossed", can(kO, kX), can(Vec(0, 0, 1.5), kY), -0.5},
        Known{"cylinders_crossed_apart", can(kO, kX), can(Vec(0.25, 0.5, 3), kY), 1},
        Known{"cylinder_cap_to_side", can(kO, kZ), can(Vec(0, 0, 3.25), kX), 0.25},
        Known{"rim_to_rim", can(kO, kZ), can(Vec(5, 0, 8), kZ), 5},
        Known{"cylinder_on_box", Obb{kO, Vec(3, 3, 1), kNoTurn}, can(Vec(0, 0, 3), kZ), 0},
        Known{"cylinder_rolls_on_box", Obb{kO, Vec(3, 3, 1), kNoTurn}, can(Vec(0, 0, 1.5), kY),
              -0.5},
        Known{"point_in_cylinder", point_triangle(Vec(0.75, 0, 1)), can(kO, kZ), -0.25},
        Known{"point_beside_cylinder", point_triangle(Vec(4, 0, 6)), can(kO, kZ), 5},
        Known{"box_above_plane", cube(Vec(0, 0, 3)), Plane{kZ, 1}, 1},
        Known{"box_below_plane", cube(Vec(0, 0, -3)), Plane{kZ, 1}, 3},
        Known{"box_in_plane", turned_cube(kO), Plane{kX, 0.5}, 0.5 - kRoot2},
        Known{"box_below_half_space", cube(Vec(0, 0, -3)), Plane{kZ, 1, true}, -5},
        Known{"box_above_half_space", cube(Vec(0, 0, 3)), Plane{kZ, 1, true}, 1}),
    [](const auto& info) { return info.param.name; });

/// Known signed distances of a point.
double point_to_box(const Vec& p, const Vec& half) {
  const Vec q = p.cwiseAbs() - half;
  return q.maxCoeff() > 0 ? q.cwiseMax(0).norm() : q.maxCoeff();
}
double point_to_cylinder(const Vec& p, double half_height, double radius) {
  const Eigen::Vector2d q(p.head<2>().norm() - radius, std::abs(p.z()) - half_height);
  return q.maxCoeff() > 0 ? q.cwiseMax(0).norm() : q.maxCoeff();
}

TEST(SignedDistance, PointToBoxAndCylinder_HasItsSignedDistance) {
  int inside = 0, converged = 0;
  constexpr int kCount = 3000;
  for (int i = 0; i < kCount; ++i) {
    Random random(kSeed, 1, i);
    const Vec half{random.uniform(0.2, 2), random.uniform(0.2, 2), random.uniform(0.2, 2)};
    const Vec p{random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)};
    const Frame turn = random.rotation();
    const Vec c = random.uniform(0, 9) * turn.col(0);
    const Triangle point = point_triangle(c + turn * p);
    const Shape box = Obb{c, half, turn}, cylinder = Cylinder{c, turn.col(2), half.z(), half.x()};
    const double slack = 1e-13 * scene_size(point, box);
    const double truths[2] = {point_to_box(p, half), point_to_cylinder(p, half.z(), half.x())};
    for (int k = 0; k < 2; ++k) {
      const SignedDistance bounds = signed_distance(point, k ? cylinder : box);
      EXPECT_LE(bounds.lo - slack, truths[k]) << i;
      EXPECT_GE(bounds.hi + slack, truths[k]) << i;
      converged += bounds.converged;
      EXPECT_NEAR(distance(point.v0, k ? cylinder : box), std::max(0.0, truths[k]), slack) << i;
      inside += truths[k] < 0;
    }
  }
  EXPECT_GT(inside, kCount / 10);
  EXPECT_LT(inside, kCount);
  EXPECT_GE(converged, 2 * kCount * 999 / 1000);  // all but points nearly on a cylinder's axis
}

class EveryConvexPair : public testing::TestWithParam<Pair> {};

TEST_P(EveryConvexPair, SwappedShapes_HaveTheSameDistance) {
  constexpr int kCount = 1000;
  int converged = 0;
  double widest = 0;
  for (int i = 0; i < kCount; ++i) {
    const Case c = generate(GetParam(), kSeed, i);
    const Shape a = c.shape_a(), b = c.shape_b();
    const SignedDistance ab = signed_distance(a, b), ba = signed_distance(b, a);
    EXPECT_LE(ab.lo, ba.hi) << c.describe();
    EXPECT_LE(ba.lo, ab.hi) << c.describe();
    EXPECT_LE(ab.lo, ab.hi);
    converged += ab.converged && ba.converged;
    widest = std::max(widest, (ab.hi - ab.lo) / scene_size(a, b));
  }
  EXPECT_EQ(converged, kCount);
  std::printf("%s: %d of %d pairs converged to 1e-8 both ways, widest %.1e S\n",
              to_string(GetParam()), converged, kCount, widest);
}

TEST_P(EveryConvexPair, Distance_IsBoundedByNormalsAndPoints) {
  for (int i = 0; i < 200; ++i) {
    const Case c = generate(GetParam(), kSeed + 1, i);
    const Shape a = c.shape_a(), b = c.shape_b();
    const SignedDistance bounds = signed_distance(a, b);
    Random random(kSeed, 2, i);
    for (int k = 0; k < 100; ++k)
      EXPECT_LE(distance_along(a, b, random.direction()), bounds.hi) << c.describe();
    // Near the best normal, where an error could occur.
    for (int k = 0; k < 100; ++k) {
      const double by = random.decades(1e-9, 1e-1);
      EXPECT_LE(distance_along(a, b, bounds.n + by * random.direction()), bounds.hi)
          << c.describe();
    }
  }
}

TEST_P(EveryConvexPair, Approach_ReducesTheDistanceEqually) {
  // Along the normal s falls by exactly the translation while the shapes stay apart.
  int apart = 0;
  for (int i = 0; i < 400; ++i) {
    const Case c = generate(GetParam(), kSeed + 2, i);
    const Shape a = c.shape_a(), b = c.shape_b();
    const SignedDistance bounds = signed_distance(a, b);
    if (bounds.lo <= 0) continue;
    ++apart;
    const Shape nearer = moved(b, -0.5 * bounds.lo * bounds.n);
    const SignedDistance half = signed_distance(a, nearer);
    const double tolerance =
        1e-13 * (scene_size(a, b) + largest_coordinate(a, b)) + bounds.hi - bounds.lo;
    EXPECT_LE(half.lo, bounds.hi - 0.5 * bounds.lo + tolerance) << c.describe();
    EXPECT_GE(half.hi, 0.5 * bounds.lo - tolerance) << c.describe();
  }
  EXPECT_GT(apart, 100);
}

INSTANTIATE_TEST_SUITE_P(All, EveryConvexPair,
                         testing::Values(Pair::kObbObb, Pair::kTriangleAabb, Pair::kTriangleObb,
                                         Pair::kSphereSphere, Pair::kTriangleSphere,
                                         Pair::kTriangleCylinder, Pair::kCylinderCylinder,
                                         Pair::kObbCylinder, Pair::kObbPlane, Pair::kSphereObb,
                                         Pair::kTriangleTriangle),
                         [](const auto& info) {
                           std::string name = to_string(info.param);
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

TEST(SignedDistance, ExhaustedBudget_GivesAWideTrueInterval) {
  // Two cylinders about one centre, slightly tilted: a whole circle of normals is nearly best.
  const Shape a = Cylinder{kO, kZ, 5, 1}, b = Cylinder{kO, Vec(1e-6, 0, 1).normalized(), 5, 1};
  const SignedDistance wide = signed_distance(a, b, {1e-9, 2000}),
                       narrow = signed_distance(a, b, {1e-7, 2000000});
  EXPECT_FALSE(wide.converged);
  EXPECT_LT(wide.evaluations, 2100);
  EXPECT_LE(wide.lo, narrow.hi);
  EXPECT_GE(wide.hi, narrow.lo);
  EXPECT_LE(narrow.lo, -2 + 1e-5);
  EXPECT_GE(narrow.hi, -2);
}

TEST(SignedDistance, TwoPlanes_AreRefused) {
  EXPECT_THROW((void)signed_distance(Plane{kZ, 0}, Plane{kZ, 1}), std::invalid_argument);
}

}  // namespace
}  // namespace cde::oracle
