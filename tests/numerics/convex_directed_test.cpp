// SPDX-License-Identifier: Apache-2.0
// Convex pairs with known answers.
#include <Eigen/Geometry>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <string>

#include "convex_check.hpp"

namespace cde::testing {
namespace {

Obb box(const Eigen::Vector3f& c, const Eigen::Vector3f& half) {
  return {c, half, Matrix3<float>::Identity()};
}

// Two boxes resting on each other. Nearly parallel edges give a normal of rounding noise, which
// must not produce a phantom depth of the size of the boxes.
TEST(ConvexPairDirected, BoxesFaceToFace_HaveNoPhantomDepth) {
  const Obb lower = box({0, 0, 0}, {1, 1, 0.5f});
  for (const float angle : {0.0f, 1e-7f, 1e-6f, 1e-4f, 0.3f, 3.14159265f}) {
    Obb upper = box({0.25f, -0.125f, 1}, {1, 1, 0.5f});
    upper.rotation = Eigen::AngleAxisf(angle, Eigen::Vector3f::UnitZ()).toRotationMatrix();
    const auto o = reference::obb_obb(lower, upper);
    EXPECT_TRUE(o.f) << angle << ": touching must be a hit";
    EXPECT_EQ(o.t, 0) << angle;
    EXPECT_EQ(o.n, Eigen::Vector3f(0, 0, 1)) << angle;
    EXPECT_NEAR(o.cp.z(), 0.5, 1e-6) << angle;
  }
}

// Centres with an equal coordinate: the depth axis has two directions. All candidate axes in one
// plane must choose the same direction, or CP lies outside a body.
TEST(ConvexPairDirected, TiedDepthAxes_KeepWitnessPointsInTheBodies) {
  const Obb a = box({0, 0, 0}, {3, 3, 1}), b = box({3, 2, 0}, {4, 3, 1});
  const auto boxes = reference::obb_obb(a, b);
  EXPECT_TRUE(boxes.f);
  EXPECT_EQ(boxes.t, 2);
  EXPECT_EQ(std::abs(boxes.n.z()), 1);
  EXPECT_GE(boxes.cp.y(), -1) << "B begins at y = -1";
  EXPECT_LE(boxes.cp.y(), 3) << "A ends at y = 3";
  const oracle::Case triangle{Pair::kTriangleAabb,  0, 0, "", {-6, -5, 0, 0, 2, 0, 5, -6, 0},
                              {-2, -4, -4, 2, 4, 4}};
  const oracle::Case as_case{Pair::kObbObb,
                             0,
                             0,
                             "",
                             {0, 0, 0, 3, 3, 1, 1, 0, 0, 0, 1, 0, 0, 0, 1},
                             {3, 2, 0, 4, 3, 1, 1, 0, 0, 0, 1, 0, 0, 0, 1}};
  for (const oracle::Case& c : {triangle, as_case}) {
    std::string message;
    (void)judge<float>(run<float>(c.pair, c.a, c.b), c.shape_a(), c.shape_b(), 0x1p-24, message);
    EXPECT_EQ(message, "") << c.describe();
  }
}

// Two thin, nearly parallel boxes: a polishing step may rotate v so far that its signed distance is
// useless. Then the distance of the candidate axes alone would be 137 u S too small. And two boxes
// that nearly touch: |v| alone is 8 u S too large, but the mean with the signed distance is not.
TEST(ConvexPairDirected, TiltedBoxes_KeepTheirDistance) {
  const oracle::Case plates{Pair::kObbObb,
                            0,
                            0,
                            "",
                            {0, 0, 0, 0x1.a9bceep+0, 0x1.1aff1ep+2, 0x1.3a04aep-30, 0x1p+0,
                             -0x1.484d72p-21, 0x1.3ea5dep-21, 0x1.484d8p-21, 0x1p+0,
                             -0x1.512eb4p-21, -0x1.3ea5d2p-21, 0x1.512ecp-21, 0x1p+0},
                            {-0x1.08fd52p+2, 0, -0x1.2222f4p+1, 0x1.39b67ap+1, 0x1.09fa6ep+2,
                             0x1.114a1ap-29, 1, 0, 0, 0, 1, 0, 0, 0, 1}};
  const oracle::Case near{
      Pair::kObbObb,
      0,
      0,
      "",
      {0x0p+0, 0x0p+0, 0x0p+0, 0x1.638e2ep+0, 0x1.c3e9bp-1, 0x1.5492b8p+0, 0x1.81e4eep-3,
       0x1.113732p-2, 0x1.e3ea9ep-1, -0x1.96f9b2p-3, -0x1.dd3f2ep-1, 0x1.36046cp-2, 0x1.ec6d7ep-1,
       -0x1.f57b84p-3, -0x1.f63accp-4},
      {-0x1.473386p-2, 0x1.1dc61ap+0, 0x1.2c493ep-2, 0x1.737412p+0, 0x1.427ff4p-2, 0x1.355f98p+0,
       0x1.81e47ep-3, 0x1.1136f4p-2, 0x1.e3eaacp-1, -0x1.96fa34p-3, -0x1.dd3f32p-1, 0x1.360426p-2,
       0x1.ec6d7cp-1, -0x1.f57bcep-3, -0x1.f639ecp-4}};
  for (const oracle::Case& c : {plates, near}) {
    const Outcome<float> o = run<float>(c.pair, {c.a.begin(), c.a.end()}, {c.b.begin(), c.b.end()});
    const oracle::SignedDistance distance = oracle::signed_distance(c.shape_a(), c.shape_b());
    const double u_s = 0x1p-24 * oracle::scene_size(c.shape_a(), c.shape_b());
    EXPECT_FALSE(o.f);
    EXPECT_LE(std::abs(o.t - distance.middle()) / u_s, 5) << c.describe();
    EXPECT_GE(oracle::distance_along(c.shape_a(), c.shape_b(), o.n.cast<double>()),
              distance.lo - 8 * u_s)
        << c.describe();
  }
}

// Exact touching counts as contact in every pair and in either order; a distance of one ulp does
// not.
TEST(ConvexPairDirected, Touching_IsAHit) {
  const float above = std::nextafter(2.0f, 3.0f);
  const Obb one = box({0, 0, 0}, {1, 1, 1});
  const Plane floor{{0, 0, 1}, -1};
  const auto hits = [&](float z) {
    const Sphere ball{{0, 0, z}, 1};
    const Triangle sheet{{-1, -1, z - 1}, {1, -1, z - 1}, {0, 1, z - 1}};
    const Aabb cube{{-1, -1, -1}, {1, 1, 1}};
    return std::array{
        reference::sphere_sphere(Sphere{{0, 0, 0}, 1}, ball).f,
        reference::sphere_sphere(ball, Sphere{{0, 0, 0}, 1}).f,
        reference::sphere_obb(ball, one).f,
        reference::obb_obb(one, box({0, 0, z}, {1, 1, 1})).f,
        reference::obb_obb(box({0, 0, z}, {1, 1, 1}), one).f,
        reference::triangle_aabb(sheet, cube).f,
        reference::triangle_obb(sheet, one).f,
        reference::triangle_sphere(sheet, Sphere{{0, 0, z - 2}, 1}).f,
        reference::obb_plane(box({0, 0, z - 2}, {1, 1, 1}), floor).f,
        reference::obb_plane(box({0, 0, z - 2}, {1, 1, 1}), floor, PlaneSide::kHalfSpace).f};
  };
  for (const bool hit : hits(2)) EXPECT_TRUE(hit);
  const auto apart = hits(above);
  for (std::size_t i = 0; i < apart.size(); ++i) {
    // Relative to its sphere, and to its plane, the translation is exact: the triangle gets no
    // distance.
    EXPECT_EQ(apart[i], i == 7) << i;
  }
}

TEST(ConvexPairDirected, ConcentricSpheres_HaveAnUpwardNormal) {
  const auto o = reference::sphere_sphere(Sphere{{5, 6, 7}, 1}, Sphere{{5, 6, 7}, 2});
  EXPECT_TRUE(o.f);
  EXPECT_EQ(o.t, 3);
  EXPECT_EQ(o.n, Eigen::Vector3f(0, 0, 1));
  EXPECT_EQ(o.cp, Eigen::Vector3f(5, 6, 6.5f));  // pA above, at z = 8, pB below, at z = 5
}

// A sphere whose centre is inside a box leaves it through the nearest face.
TEST(ConvexPairDirected, SphereInABox_LeavesByTheNearestFace) {
  const Obb cube = box({0, 0, 0}, {2, 2, 2});
  const auto near_x = reference::sphere_obb(Sphere{{1.5f, 1, -1}, 0.25f}, cube);
  EXPECT_EQ(near_x.t, 0.75f);
  EXPECT_EQ(near_x.n, Eigen::Vector3f(-1, 0, 0));
  const auto near_z = reference::sphere_obb(Sphere{{0, 0.5f, -1.75f}, 0.25f}, cube);
  EXPECT_EQ(near_z.t, 0.5f);
  EXPECT_EQ(near_z.n, Eigen::Vector3f(0, 0, 1));
  const auto tie = reference::sphere_obb(Sphere{{1, -1, 1}, 0.25f}, cube);
  EXPECT_EQ(tie.n, Eigen::Vector3f(-1, 0, 0));
}

TEST(ConvexPairDirected, BoxOnAPlane_TouchesAtACentroid) {
  const Plane floor{{0, 0, 1}, 0};
  const auto face = reference::obb_plane(box({3, 4, 0.75f}, {1, 2, 0.5f}), floor);
  EXPECT_FALSE(face.f);
  EXPECT_EQ(face.t, 0.25f);
  EXPECT_EQ(face.n, Eigen::Vector3f(0, 0, -1));
  EXPECT_EQ(face.cp, Eigen::Vector3f(3, 4, 0.125f));
  // Deep below the plane: separated from the surface, inside the half-space.
  const Obb below = box({0, 0, -5}, {1, 1, 1});
  EXPECT_FALSE(reference::obb_plane(below, floor).f);
  EXPECT_EQ(reference::obb_plane(below, floor).t, 4);
  const auto inside = reference::obb_plane(below, floor, PlaneSide::kHalfSpace);
  EXPECT_TRUE(inside.f);
  EXPECT_EQ(inside.t, 6);
  EXPECT_EQ(inside.n, Eigen::Vector3f(0, 0, -1));
}

// A triangle without area is treated as the segment or point that it covers.
TEST(ConvexPairDirected, TrianglesWithoutArea_AreSegmentsAndPoints) {
  const Eigen::Vector3f p(1, 2, 3), q(-3, 2, 3), middle(-1, 2, 3);
  for (const Triangle& t : {Triangle{p, q, middle}, Triangle{middle, p, q}, Triangle{q, q, p}}) {
    const auto o = reference::triangle_sphere(t, Sphere{{-1, 2, 4}, 0.5f});
    EXPECT_EQ(o.t, 0.5f);
    EXPECT_EQ(o.n, Eigen::Vector3f(0, 0, 1));
    const auto on_it = reference::triangle_sphere(t, Sphere{{0, 2, 3}, 0.5f});
    EXPECT_TRUE(on_it.f);
    EXPECT_EQ(on_it.t, 0.5f);
    EXPECT_EQ(on_it.n.x(), 0) << "n must be perpendicular to the segment";
    const auto o_box = reference::triangle_obb(t, box({-1, 2, 6}, {1, 1, 1}));
    EXPECT_EQ(o_box.t, 2);
    EXPECT_EQ(o_box.n, Eigen::Vector3f(0, 0, 1));
  }
  const auto point = reference::triangle_aabb(Triangle{p, p, p}, Aabb{{4, 6, 3}, {5, 7, 4}});
  EXPECT_EQ(point.t, 5);
  EXPECT_FLOAT_EQ(point.n.x(), 0.6f);
  EXPECT_FLOAT_EQ(point.n.y(), 0.8f);
}

TEST(ConvexPairDirected, BadInput_IsFlagged) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto expect_bad = [](const Outcome<float>& o) {
    EXPECT_TRUE(o.bad);
    EXPECT_FALSE(o.f);
    for (const float x : {o.t, o.cp.x(), o.cp.y(), o.cp.z(), o.n.x(), o.n.y(), o.n.z()})
      EXPECT_EQ(std::bit_cast<std::uint32_t>(x), 0x7fc00000U);
  };
  const Sphere ball{{0, 0, 0}, 1}, empty{{0, 0, 0}, 0};
  const Triangle sheet{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, broken{{nan, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const Obb cube = box({0, 0, 0}, {1, 1, 1}), flat = box({0, 0, 0}, {1, 0, 1});
  const Plane floor{{0, 0, 1}, 0}, no_plane{{0, 0, 1.001f}, 0};
  const Aabb room{{0, 0, 0}, {1, 1, 1}}, inverted{{0, 0, 0}, {1, -1, 1}};
  expect_bad(reference::sphere_sphere(ball, empty));
  expect_bad(reference::sphere_sphere(empty, ball));
  expect_bad(reference::triangle_sphere(broken, ball));
  expect_bad(reference::triangle_sphere(sheet, empty));
  expect_bad(reference::sphere_obb(ball, flat));
  expect_bad(reference::sphere_obb(empty, cube));
  expect_bad(reference::obb_plane(flat, floor));
  expect_bad(reference::obb_plane(cube, no_plane));
  expect_bad(reference::obb_obb(cube, flat));
  expect_bad(reference::obb_obb(flat, cube));
  expect_bad(reference::triangle_obb(broken, cube));
  expect_bad(reference::triangle_obb(sheet, flat));
  expect_bad(reference::triangle_aabb(broken, room));
  expect_bad(reference::triangle_aabb(sheet, inverted));
  expect_bad(reference::triangle_triangle(broken, sheet));
  expect_bad(reference::triangle_triangle(sheet, broken));
}

}  // namespace
}  // namespace cde::testing
