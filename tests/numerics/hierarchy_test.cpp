// SPDX-License-Identifier: Apache-2.0
// Rays through a hierarchy against all triangles one by one: no record may differ, whatever the
// scene and however the ray lies.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include "cde/reference/reference.hpp"
#include "cde/reference/refit.hpp"
#include "cde/reference/traversal.hpp"
#include "hard_rays.hpp"
#include "rewritten.hpp"

namespace cde::testing {
namespace {

using namespace hard;

// ---- Tests ----

class EveryRecord : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Scenes, EveryRecord, ::testing::ValuesIn(kScenes),
                         [](const auto& scene) { return std::string(scene.param.name); });

/// Mode hits; how many there are.
std::size_t expect_hits(reference::Traversal& traversal, const Scene& scene,
                        const std::vector<Ray>& rays) {
  std::vector<Record> all = reference::cast(rays, scene, Mode::kHits, {}, {}, true), own;
  std::sort(all.begin(), all.end(), [](const Record& a, const Record& b) {
    return a.primary != b.primary ? a.primary < b.primary : a.index < b.index;
  });
  for (std::size_t i = 0; i < rays.size(); ++i)
    for (const Record& r : traversal.trace(rays[i], static_cast<std::uint32_t>(i), Mode::kHits))
      own.push_back(r);
  EXPECT_TRUE(std::ranges::equal(own, all, same_bits));
  return all.size();
}

/// CDE_FULL=1: ten million rays in all.
TEST_P(EveryRecord, IsThatOfAllTriangles) {
  const std::size_t count = std::getenv("CDE_FULL") != nullptr ? 1'250'000 : 6'000;
  const Scene scene = GetParam().make();
  Rays draw(scene, 1);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i)
    rays.push_back(draw(static_cast<unsigned>(i % Rays::kKinds)));
  for (const unsigned leaf : {1u, 2u}) {
    const Hierarchy hierarchy = Hierarchy::build(scene, {.leaf = leaf});
    reference::Traversal traversal(scene, hierarchy);
    std::size_t hits = 0, different = 0;
    for (const Mode mode : {Mode::kNearest, Mode::kFarthest, Mode::kAny}) {
      const std::vector<Record> all = reference::cast(rays, scene, mode, {}, {}, true);
      ASSERT_EQ(all.size(), rays.size());
      for (std::size_t i = 0; i < count; ++i) {
        const auto number = static_cast<std::uint32_t>(i);
        const std::vector<Record> own = traversal.trace(rays[i], number, mode);
        ASSERT_EQ(own.size(), 1u);
        hits += own[0].f ? 1 : 0;
        if (mode == Mode::kAny) {
          EXPECT_EQ(traversal.occluded(rays[i]), all[i].f);
        }
        if (same_bits(own[0], all[i])) continue;
        if (different++ < 3)
          ADD_FAILURE() << name_of(mode) << ", ray " << i << " of kind " << i % Rays::kKinds << ": "
                        << text(rays[i]) << "\n  T " << own[0].t << " of " << own[0].index
                        << ", should be " << all[i].t << " of " << all[i].index;
      }
    }
    const std::size_t all_hits = expect_hits(traversal, scene, rays);
    EXPECT_EQ(different, 0u);
    EXPECT_GT(hits, count / 20);
    const auto& c = traversal.counts();
    fmt::print(
        "leaves of {}: {} rays, {} hits of mode hits; of five queries a ray and one, nodes {:.1f}, "
        "triangles {:.1f} of {}\n",
        leaf, count, all_hits, static_cast<double>(c.nodes) / static_cast<double>(5 * count),
        static_cast<double>(c.triangles) / static_cast<double>(5 * count), scene.size());
  }
}

/// A tree as a card's refit leaves it, whose triangles are not where it was built for them.
TEST_P(EveryRecord, IsThatOfAllTrianglesAfterACardsRefit) {
  const std::size_t count = std::getenv("CDE_FULL") != nullptr ? 200'000 : 2'000;
  Scene scene = GetParam().make();
  for (const unsigned leaf : {1u, 2u}) {
    const Hierarchy built = Hierarchy::build(scene, {.leaf = leaf});
    Draw draw(7);
    for (Triangle& t : scene) {
      const Vector3f size = (t.v1 - t.v0).cwiseAbs() + (t.v2 - t.v0).cwiseAbs();
      const Vector3f way = 3 * size.cwiseProduct(draw.point());
      for (Vector3f* v : {&t.v0, &t.v1, &t.v2}) *v += way;
    }
    const auto refitted = reference::refit(built.nodes(), built.order(), scene);
    ASSERT_FALSE(refitted.bad);
    const Hierarchy hierarchy =
        rewritten(built, refitted.nodes, reference::box_of(refitted.nodes[0]));
    reference::Traversal traversal(scene, hierarchy);
    Rays make(scene, 2);
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < count; ++i)
      rays.push_back(make(static_cast<unsigned>(i % Rays::kKinds)));
    std::size_t hits = 0, different = 0;
    for (const Mode mode : {Mode::kNearest, Mode::kFarthest, Mode::kAny}) {
      const std::vector<Record> all = reference::cast(rays, scene, mode, {}, {}, true);
      for (std::size_t i = 0; i < count; ++i) {
        const Record own = traversal.trace(rays[i], static_cast<std::uint32_t>(i), mode)[0];
        hits += own.f ? 1 : 0;
        different += same_bits(own, all[i]) ? 0 : 1;
        if (mode == Mode::kAny) {
          EXPECT_EQ(traversal.occluded(rays[i]), all[i].f);
        }
      }
    }
    (void)expect_hits(traversal, scene, rays);
    EXPECT_EQ(different, 0u) << "leaves of " << leaf;
    EXPECT_GT(hits, count / 20);
  }
}

}  // namespace
}  // namespace cde::testing
