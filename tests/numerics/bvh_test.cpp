// SPDX-License-Identifier: Apache-2.0
// Rays against a BVH, compared with brute force: no record may differ, for any scene and any ray.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "cde/reference/reference.hpp"
#include "cde/reference/refit.hpp"
#include "cde/reference/traversal.hpp"
#include "hard_rays.hpp"
#include "rewritten.hpp"

namespace cde {
/// The name of an algorithm in names of tests.
inline void PrintTo(Algorithm algorithm, std::ostream* out) {
  *out << name(algorithm);
}
}  // namespace cde

namespace cde::testing {
namespace {

using namespace hard;

// ---- Tests ----

constexpr Algorithm kAll[] = {Algorithm::kMoller, Algorithm::kBadouel, Algorithm::kPluecker,
                              Algorithm::kWatertight};

class BvhEveryRecord : public ::testing::TestWithParam<std::tuple<Case, Algorithm>> {
 protected:
  /// The number of rays by algorithm: brute force with Moeller is fast, the others get fewer rays.
  [[nodiscard]] std::size_t rays(std::size_t by_moller) const {
    return algorithm_ == Algorithm::kMoller       ? by_moller
           : algorithm_ == Algorithm::kWatertight ? by_moller / 4
                                                  : by_moller / 20;
  }
  /// Brute-force records, mode by mode.
  [[nodiscard]] std::vector<Record> brute_force(const TriangleScene& scene,
                                                const std::vector<Ray>& rays, Mode mode) const {
    std::vector<Record> all = reference::cast(rays, scene, mode, {}, {}, true, {}, algorithm_);
    std::stable_sort(all.begin(), all.end(), [](const Record& a, const Record& b) {
      return a.primary != b.primary ? a.primary < b.primary : a.index < b.index;
    });
    return all;
  }
  TriangleScene scene_ = std::get<0>(GetParam()).make();
  Algorithm algorithm_ = std::get<1>(GetParam());
};
INSTANTIATE_TEST_SUITE_P(Scenes, BvhEveryRecord,
                         ::testing::Combine(::testing::ValuesIn(kScenes),
                                            ::testing::ValuesIn(kAll)),
                         [](const auto& test) {
                           return fmt::format("{}_{}", std::get<0>(test.param).name,
                                              name(std::get<1>(test.param)));
                         });

constexpr Mode kBest[] = {Mode::kNearest, Mode::kFarthest, Mode::kAny};

/// Compares the records of mode kHits.
void expect_hits(reference::Traversal& traversal, const std::vector<Record>& all,
                 const std::vector<Ray>& rays) {
  std::vector<Record> own;
  for (std::size_t i = 0; i < rays.size(); ++i)
    for (const Record& r : traversal.trace(rays[i], static_cast<std::uint32_t>(i), Mode::kHits))
      own.push_back(r);
  EXPECT_TRUE(std::ranges::equal(own, all, same_bits));
}

/// CDE_FULL=1: ten million rays in all with moller, 2.5 million with watertight.
TEST_P(BvhEveryRecord, HardRays_EqualBruteForce) {
  const std::size_t count = rays(std::getenv("CDE_FULL") != nullptr ? 1'250'000 : 6'000);
  const TriangleScene& scene = scene_;
  Rays draw(scene, 1);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i)
    rays.push_back(draw(static_cast<unsigned>(i % Rays::kKinds)));
  std::map<Mode, std::vector<Record>> should;
  for (const Mode mode : {Mode::kNearest, Mode::kFarthest, Mode::kAny, Mode::kHits})
    should[mode] = brute_force(scene, rays, mode);
  for (const unsigned leaf : {1u, 2u}) {
    const Bvh bvh = Bvh::build(scene, {.leaf = leaf});
    reference::Traversal traversal(scene, bvh, algorithm_);
    std::size_t hits = 0, different = 0;
    for (const Mode mode : kBest) {
      const std::vector<Record>& all = should[mode];
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
                        << ", expected " << all[i].t << " of " << all[i].index;
      }
    }
    expect_hits(traversal, should[Mode::kHits], rays);
    EXPECT_EQ(different, 0u);
    EXPECT_GT(hits, count / 20);
    const auto& c = traversal.counts();
    fmt::print(
        "leaves of {}: {} rays, {} hits of mode hits; of five queries a ray and one, nodes {:.1f}, "
        "triangles {:.1f} of {}\n",
        leaf, count, should[Mode::kHits].size(),
        static_cast<double>(c.nodes) / static_cast<double>(5 * count),
        static_cast<double>(c.secondaries) / static_cast<double>(5 * count), scene.size());
  }
}

/// A BVH after a card's refit, with triangles that moved since it was built.
TEST_P(BvhEveryRecord, CardRefit_EqualsBruteForce) {
  const std::size_t count = rays(std::getenv("CDE_FULL") != nullptr ? 200'000 : 2'000);
  TriangleScene scene = scene_;
  for (const unsigned leaf : {1u, 2u}) {
    const Bvh built = Bvh::build(scene, {.leaf = leaf});
    Draw draw(7);
    for (Triangle& t : scene) {
      const Vector3f size = (t.v1 - t.v0).cwiseAbs() + (t.v2 - t.v0).cwiseAbs();
      const Vector3f shift = 3 * size.cwiseProduct(draw.point());
      for (Vector3f* v : {&t.v0, &t.v1, &t.v2}) *v += shift;
    }
    const auto refitted = reference::refit(built.nodes(), built.order(), scene);
    ASSERT_FALSE(refitted.bad);
    const Bvh bvh = rewritten(built, refitted.nodes, reference::box_of(refitted.nodes[0]));
    reference::Traversal traversal(scene, bvh, algorithm_);
    Rays make(scene, 2);
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < count; ++i)
      rays.push_back(make(static_cast<unsigned>(i % Rays::kKinds)));
    std::size_t hits = 0, different = 0;
    for (const Mode mode : kBest) {
      const std::vector<Record> all = brute_force(scene, rays, mode);
      for (std::size_t i = 0; i < count; ++i) {
        const Record own = traversal.trace(rays[i], static_cast<std::uint32_t>(i), mode)[0];
        hits += own.f ? 1 : 0;
        different += same_bits(own, all[i]) ? 0 : 1;
        if (mode == Mode::kAny) {
          EXPECT_EQ(traversal.occluded(rays[i]), all[i].f);
        }
      }
    }
    expect_hits(traversal, brute_force(scene, rays, Mode::kHits), rays);
    EXPECT_EQ(different, 0u) << "leaves of " << leaf;
    EXPECT_GT(hits, count / 20);
  }
}

/// d is finite, but the sum of its components overflows. An infinite margin would accept a hit
/// outside every box.
TEST(BoxRule, OverflowingMargin_DropsTheHit) {
  const Ray ray = beyond_numbers();
  const TriangleScene scene = edge_on();
  const Record plain = reference::record_of(ray, scene[0], 0, 0);
  EXPECT_TRUE(plain.f);
  EXPECT_GT(plain.t, 0x1p127f);
  const Bvh bvh = Bvh::build(scene);
  for (const Algorithm algorithm : kAll) {
    reference::Traversal traversal(scene, bvh, algorithm);
    EXPECT_FALSE(reference::record_of(ray, scene[0], 0, 0, true, algorithm).f) << name(algorithm);
    EXPECT_FALSE(traversal.occluded(ray)) << name(algorithm);
  }
}

/// Nodes read per ray, for rays from anywhere.
double nodes_per_ray(const TriangleScene& scene, const Bvh& bvh) {
  constexpr unsigned kRays = 2000;
  Draw draw(3);
  reference::Traversal traversal(scene, bvh);
  for (unsigned i = 0; i < kRays; ++i)
    (void)traversal.trace({0.5f * draw.point(), draw.point()}, i, Mode::kNearest);
  return static_cast<double>(traversal.counts().nodes) / kRays;
}

/// For few objects that moved among each other, the old BVH over them is as good as a new one.
/// Prints the figures of docs/tables/bvh.md.
TEST(BvhOverObjects, OldBvhOverFewObjects_IsAsGoodAsANewOne) {
  constexpr struct { std::uint32_t objects, each; } kCases[] = {{8, 320}, {40, 64}, {200, 12}};
  for (const auto& [objects, each] : kCases) {
    Draw draw(objects);
    const std::vector<std::uint32_t> parts(objects, each);
    TriangleScene before, after;
    for (std::uint32_t k = 0; k < objects; ++k) {
      const Vector3f from = draw.point(), to = draw.point();
      for (std::uint32_t i = 0; i < each; ++i) {
        const Vector3f v = 0.05f * draw.point(), a = 0.02f * draw.point(), b = 0.02f * draw.point();
        before.push_back({from + v, from + v + a, from + v + b});
        after.push_back({to + v, to + v + a, to + v + b});
      }
    }
    Bvh stays = Bvh::build(before, parts);
    stays.refit(after);
    const double old = nodes_per_ray(after, stays),
                 anew = nodes_per_ray(after, Bvh::build(after, parts));
    fmt::print("{} objects of {} triangles: {:.1f} nodes per ray, {:.1f} in a rebuilt BVH\n",
               objects, each, old, anew);
    if (objects == 8) {
      EXPECT_LT(old, 1.2 * anew);
    }
    EXPECT_GT(old, 0.9 * anew);
  }
}

/// Rays from inside a closed mesh at its edges and vertices, for any position and size: a ray
/// without a hit has left through a gap. CDE_FULL=1: four million rays.
TEST(Watertight, RaysInAClosedMesh_DoNotLeak) {
  const std::size_t count = std::getenv("CDE_FULL") != nullptr ? 1'000'000 : 4'000;
  struct Place {
    float size;
    Vector3f at;
  };
  std::size_t moller_leaks = 0;
  for (const Place& place : {Place{1, {0, 0, 0}}, Place{1, {37, -1234, 5}},
                             Place{0x1p-10f, {0.25f, -3, 1}}, Place{1e4f, {1e8f, 2e7f, -3e8f}}}) {
    const TriangleScene scene = icosphere(place.at, place.size);
    const Bvh bvh = Bvh::build(scene);
    reference::Traversal tight(scene, bvh, Algorithm::kWatertight),
        moller(scene, bvh, Algorithm::kMoller);
    Draw draw(11);
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < count; ++i)
      rays.push_back(from_inside(scene, place.at, place.size, draw));
    const std::vector<Record> brute_force =
        reference::cast(RayView(rays).subview(0, count / 8), scene, Mode::kNearest, {}, {}, true,
                        {}, Algorithm::kWatertight);
    std::size_t leaks = 0, different = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const auto number = static_cast<std::uint32_t>(i);
      const Record nearest = tight.trace(rays[i], number, Mode::kNearest)[0];
      const bool whole = nearest.f && tight.trace(rays[i], number, Mode::kFarthest)[0].f &&
                         tight.trace(rays[i], number, Mode::kAny)[0].f && tight.occluded(rays[i]);
      if (!whole && leaks++ < 3) ADD_FAILURE() << "ray " << i << ": " << text(rays[i]);
      if (i < brute_force.size() && !same_bits(nearest, brute_force[i])) ++different;
      moller_leaks += moller.occluded(rays[i]) ? 0 : 1;
    }
    EXPECT_EQ(leaks, 0u) << "size " << place.size;
    EXPECT_EQ(different, 0u) << "size " << place.size;
  }
  fmt::print("{} rays, no leak by watertight, {} by moller\n", 4 * count, moller_leaks);
  EXPECT_GT(moller_leaks, 0u);
}

}  // namespace
}  // namespace cde::testing
