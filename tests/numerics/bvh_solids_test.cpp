// SPDX-License-Identifier: Apache-2.0
// Solids and triangles against BVHs over triangles, boxes and spheres, compared with brute force.
// Also the effect of the box rule on signed distances.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cde/reference/pipes/convex/obb_obb.hpp"
#include "cde/reference/pipes/convex/sphere_obb.hpp"
#include "cde/reference/pipes/convex/triangle_box.hpp"
#include "cde/reference/pipes/convex/triangle_sphere.hpp"
#include "cde/reference/pipes/convex/triangle_triangle.hpp"
#include "cde/reference/pipes/distance_bound.hpp"
#include "cde/reference/traversal.hpp"
#include "cde/support/error.hpp"
#include "hard_solids.hpp"
#include "hard_spheres.hpp"
#include "traversal_and_brute_force.hpp"

namespace cde::testing {
namespace {

using namespace hard;

constexpr Mode kModes[] = {Mode::kNearest, Mode::kAny, Mode::kHits};

constexpr unsigned kSeed = 5;

/// Hard primaries in turn, near the secondaries.
template <class Solid, class Secondary>
std::vector<Solid> hard_ones(const std::vector<Secondary>& all, std::size_t count, unsigned seed) {
  const TriangleScene corners = corners_of(all);
  Solids draws(corners, seed);
  std::vector<Solid> solids;
  for (std::size_t i = 0; i < count; ++i) solids.push_back(draws.draw<Solid>(i));
  return solids;
}

template <class Solid, class Secondary>
void expect_hard_ones(const std::vector<Secondary>& all, std::size_t count) {
  fmt::print("seed {}: ", kSeed);
  expect_all_records(all, hard_ones<Solid>(all, count, kSeed), kModes, count,
                     [](const Solid& s) { return text(s); });
}

class BvhEverySolid : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Scenes, BvhEverySolid, ::testing::ValuesIn(kScenes),
                         [](const auto& test) { return std::string(test.param.name); });

/// CDE_FULL=1: 20,000 of each in all.
TEST_P(BvhEverySolid, SphereAgainstTriangles_EqualsBruteForce) {
  expect_hard_ones<Sphere>(GetParam().make(), full() ? 2500 : 300);
}
TEST_P(BvhEverySolid, ObbAgainstTriangles_EqualsBruteForce) {
  expect_hard_ones<Obb>(GetParam().make(), full() ? 2500 : 60);
}
TEST_P(BvhEverySolid, TriangleAgainstTriangles_EqualsBruteForce) {
  expect_hard_ones<Triangle>(GetParam().make(), full() ? 2500 : 60);
}

TEST_P(BvhEverySolid, AabbAgainstTriangles_EqualsBruteForce) {
  expect_hard_ones<Aabb>(GetParam().make(), full() ? 2500 : 60);
}
TEST_P(BvhEverySolid, SolidsAgainstObbs_EqualBruteForce) {
  const std::vector<Obb> boxes = obbs_of(GetParam().make());
  expect_hard_ones<Sphere>(boxes, full() ? 2500 : 150);
  expect_hard_ones<Obb>(boxes, full() ? 2500 : 60);
  expect_hard_ones<Triangle>(boxes, full() ? 2500 : 60);
}
TEST_P(BvhEverySolid, TriangleAgainstAabbs_EqualsBruteForce) {
  expect_hard_ones<Triangle>(aabbs_of(GetParam().make()), full() ? 2500 : 60);
}
TEST_P(BvhEverySolid, SolidsAgainstSpheres_EqualBruteForce) {
  const Cloud cloud = cloud_of(GetParam().make());
  expect_hard_ones<Obb>(cloud, full() ? 2500 : 150);
  expect_hard_ones<Triangle>(cloud, full() ? 2500 : 150);
}

/// Checks how many signed distances the rule changes, over all secondaries as shape A.
template <class Solid, class Secondary, class Pipe>
void expect_rule_is_quiet(const std::vector<Secondary>& all, Pipe pipe, std::size_t count) {
  std::size_t pairs = 0, changed = 0, flags = 0;
  for (const Solid& solid : hard_ones<Solid>(all, count, kSeed + 1)) {
    if (defect(solid)) continue;  // a rotation that is not orthonormal to 2^-20
    for (const Secondary& t : all) {
      const reference::Outcome<float> plain = pipe(t, solid);
      const reference::Outcome<float> boxed = reference::bounded<float>(plain, t, solid);
      ++pairs;
      changed += plain.t != boxed.t;
      flags += plain.f != boxed.f;
      const float distance = boxed.f ? -boxed.t : boxed.t;
      ASSERT_GE(distance, reference::distance_bound<float>(t, solid));
      ASSERT_GE(distance, plain.f ? -plain.t : plain.t);
    }
  }
  fmt::print("seed {}, {} pairs: the rule changes {} distances and {} F\n", kSeed + 1, pairs,
             changed, flags);
  EXPECT_EQ(changed, 0u);
  EXPECT_EQ(flags, 0u);
}

TEST_P(BvhEverySolid, BoxRule_ChangesNoDistance) {
  const TriangleScene scene = GetParam().make();
  const std::size_t count = std::max<std::size_t>(10, (full() ? 2'000'000 : 40'000) / scene.size());
  const std::size_t some = count / 8 + 10;
  expect_rule_is_quiet<Sphere>(scene, reference::triangle_sphere<float>, count);
  expect_rule_is_quiet<Obb>(scene, reference::triangle_obb<float>, some);
  expect_rule_is_quiet<Aabb>(scene, reference::triangle_aabb<float>, some);
  expect_rule_is_quiet<Triangle>(scene, reference::triangle_triangle<float>, some);
  expect_rule_is_quiet<Obb>(cloud_of(scene), reference::sphere_obb<float>, some);
  expect_rule_is_quiet<Obb>(obbs_of(scene), reference::obb_obb<float>, some);
}

/// If a pipe's answer is too small, the box distance replaces it, and F follows.
TEST(DistanceBound, TooSmallAnswer_IsRaisedToTheBound) {
  const Triangle t{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const Sphere sphere{{0.25f, 0.25f, 3}, 1};
  EXPECT_EQ(reference::distance_bound<float>(t, sphere), 2 - 4 * 0x1p-17f);
  reference::Outcome<float> wrong;
  wrong.f = true, wrong.t = 0.5f;
  const auto held = reference::bounded<float>(wrong, t, sphere);
  EXPECT_FALSE(held.f);
  EXPECT_EQ(held.t, 2 - 4 * 0x1p-17f);
  wrong.bad = true;
  EXPECT_TRUE(reference::bounded<float>(wrong, t, sphere).f);
}

/// Nodes read for a sphere far from all triangles.
TEST(BvhForSolids, FarSphere_ReadsFewNodes) {
  const TriangleScene scene = triangles_of(make_terrain({.quads_x = 200, .quads_y = 200}));
  const Bvh bvh = Bvh::build(scene);
  for (const float quads : {1.0f, 4.0f, 16.0f, 64.0f}) {
    reference::Traversal traversal(scene, bvh);
    Draw draw(4);
    for (std::uint32_t i = 0; i < 50; ++i) {
      const Triangle& under = scene[draw.below(scene.size())];
      (void)traversal.trace(Sphere{under.v0 + 10 * quads * Vector3f::UnitZ(), 5}, i,
                            Mode::kNearest);
    }
    const double each = static_cast<double>(traversal.counts().secondaries) / 50;
    fmt::print("a sphere {:g} quads above: {:.1f} nodes, {:.1f} triangles\n", quads,
               static_cast<double>(traversal.counts().nodes) / 50, each);
    EXPECT_LT(each, 100)
        << "with the largest distance along one axis it would be a tenth of the terrain";
  }
}

TEST(BvhForSolids, FarthestMode_IsRefused) {
  const TriangleScene scene = flat();
  const Bvh bvh = Bvh::build(scene);
  reference::Traversal traversal(scene, bvh);
  EXPECT_THROW((void)traversal.trace(Sphere{{0, 0, 0}, 1}, 0, Mode::kFarthest), Error);
  EXPECT_THROW((void)traversal.trace(Sphere{{0, 0, 0}, 1}, 0, Mode::kAll), Error);
  const auto bad = traversal.trace(Sphere{{0, 0, 0}, -1}, 0, Mode::kNearest);
  ASSERT_EQ(bad.size(), 1u);
  EXPECT_TRUE(bad[0].bad);
}

}  // namespace
}  // namespace cde::testing
