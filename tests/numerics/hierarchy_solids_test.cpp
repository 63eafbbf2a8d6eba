// SPDX-License-Identifier: Apache-2.0
// Spheres, OBBs and triangles through a hierarchy against all triangles one by one, and what the
// box rule changes of their gaps.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cde/reference/pipes/convex/triangle_box.hpp"
#include "cde/reference/pipes/convex/triangle_sphere.hpp"
#include "cde/reference/pipes/convex/triangle_triangle.hpp"
#include "cde/reference/pipes/gap_bound.hpp"
#include "cde/reference/traversal.hpp"
#include "cde/support/error.hpp"
#include "hard_solids.hpp"
#include "through_and_swept.hpp"

namespace cde::testing {
namespace {

using namespace hard;

template <class Solid>
Solid draw(Solids& solids, unsigned kind) {
  if constexpr (std::is_same_v<Solid, Sphere>)
    return solids.sphere(kind);
  else if constexpr (std::is_same_v<Solid, Obb>)
    return solids.obb(kind);
  else
    return solids.triangle(kind);
}
constexpr Mode kModes[] = {Mode::kNearest, Mode::kAny, Mode::kHits};

constexpr unsigned kSeed = 5;

/// Hard ones in turn.
template <class Solid>
void expect_hard_ones(const Scene& scene, std::size_t count) {
  Solids draws(scene, kSeed);
  std::vector<Solid> solids;
  for (std::size_t i = 0; i < count; ++i)
    solids.push_back(draw<Solid>(draws, static_cast<unsigned>(i % Solids::kKinds)));
  fmt::print("seed {}: ", kSeed);
  expect_all_records(scene, solids, kModes, count, [](const Solid& s) { return text(s); });
}

class EverySolid : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Scenes, EverySolid, ::testing::ValuesIn(kScenes),
                         [](const auto& test) { return std::string(test.param.name); });

/// CDE_FULL=1: 20,000 of each in all.
TEST_P(EverySolid, SphereIsThatOfAllTriangles) {
  expect_hard_ones<Sphere>(GetParam().make(), full() ? 2500 : 300);
}
TEST_P(EverySolid, ObbIsThatOfAllTriangles) {
  expect_hard_ones<Obb>(GetParam().make(), full() ? 2500 : 60);
}
TEST_P(EverySolid, TriangleIsThatOfAllTriangles) {
  expect_hard_ones<Triangle>(GetParam().make(), full() ? 2500 : 60);
}

/// How many gaps the rule changes, and by how much of its margin at most.
template <class Solid, class Pipe>
void expect_rule_is_quiet(const Scene& scene, Pipe pipe, unsigned kinds, std::size_t count) {
  Solids draws(scene, kSeed + 1);
  std::size_t pairs = 0, changed = 0, verdicts = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Solid solid = draw<Solid>(draws, static_cast<unsigned>(i % kinds));
    if (defect(solid)) continue;  // a rotation that is not one to 2^-20
    for (const Triangle& t : scene) {
      const reference::Outcome<float> plain = pipe(t, solid);
      const reference::Outcome<float> boxed = reference::bounded<float>(plain, t, solid);
      ++pairs;
      changed += plain.t != boxed.t;
      verdicts += plain.f != boxed.f;
      const float gap = boxed.f ? -boxed.t : boxed.t;
      ASSERT_GE(gap, reference::gap_bound<float>(t, solid));
      ASSERT_GE(gap, plain.f ? -plain.t : plain.t);
    }
  }
  fmt::print("seed {}, {} pairs: the rule changes {} gaps and {} F\n", kSeed + 1, pairs, changed,
             verdicts);
  EXPECT_EQ(changed, 0u);
  EXPECT_EQ(verdicts, 0u);
}

TEST_P(EverySolid, TheRuleChangesNoGap) {
  const Scene scene = GetParam().make();
  const std::size_t count = std::max<std::size_t>(10, (full() ? 2'000'000 : 40'000) / scene.size());
  expect_rule_is_quiet<Sphere>(scene, reference::triangle_sphere<float>, Solids::kKinds, count);
  expect_rule_is_quiet<Obb>(scene, reference::triangle_obb<float>, Solids::kKinds, count / 8 + 10);
  expect_rule_is_quiet<Triangle>(scene, reference::triangle_triangle<float>, Solids::kKinds,
                                 count / 8 + 10);
}

/// A pipe that answers too little is held to the boxes' gap, and so is F.
TEST(GapBound, HoldsWhatIsTooLittle) {
  const Triangle t{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const Sphere sphere{{0.25f, 0.25f, 3}, 1};
  EXPECT_EQ(reference::gap_bound<float>(t, sphere), 2 - 4 * 0x1p-17f);
  reference::Outcome<float> wrong;
  wrong.f = true, wrong.t = 0.5f;
  const auto held = reference::bounded<float>(wrong, t, sphere);
  EXPECT_FALSE(held.f);
  EXPECT_EQ(held.t, 2 - 4 * 0x1p-17f);
  wrong.bad = true;
  EXPECT_TRUE(reference::bounded<float>(wrong, t, sphere).f);
}

/// What a sphere reads that is far from all: docs/hierarchy.md has it.
TEST(HierarchyOfSolids, FarFromAll) {
  const Scene scene = triangles_of(make_terrain({.quads_x = 200, .quads_y = 200}));
  const Hierarchy tree = Hierarchy::build(scene);
  for (const float quads : {1.0f, 4.0f, 16.0f, 64.0f}) {
    reference::Traversal walk(scene, tree);
    Draw draw(4);
    for (std::uint32_t i = 0; i < 50; ++i) {
      const Triangle& under = scene[draw.below(scene.size())];
      (void)walk.trace(Sphere{under.v0 + 10 * quads * Vector3f::UnitZ(), 5}, i, Mode::kNearest);
    }
    const double each = static_cast<double>(walk.counts().secondaries) / 50;
    fmt::print("a sphere {:g} quads above: {:.1f} nodes, {:.1f} triangles\n", quads,
               static_cast<double>(walk.counts().nodes) / 50, each);
    EXPECT_LT(each, 100) << "by the largest gap of an axis it is a tenth of the terrain";
  }
}

TEST(HierarchyOfSolids, HasNoFarthest) {
  const Scene scene = flat();
  const Hierarchy tree = Hierarchy::build(scene);
  reference::Traversal walk(scene, tree);
  EXPECT_THROW((void)walk.trace(Sphere{{0, 0, 0}, 1}, 0, Mode::kFarthest), Error);
  EXPECT_THROW((void)walk.trace(Sphere{{0, 0, 0}, 1}, 0, Mode::kAll), Error);
  const auto bad = walk.trace(Sphere{{0, 0, 0}, -1}, 0, Mode::kNearest);
  ASSERT_EQ(bad.size(), 1u);
  EXPECT_TRUE(bad[0].bad);
}

}  // namespace
}  // namespace cde::testing
