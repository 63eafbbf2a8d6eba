// SPDX-License-Identifier: Apache-2.0
// Rays and solids against a BVH in hardware. Records, nodes read and secondaries tested equal the
// reference, for any stalls and any order of memory responses.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <span>
#include <vector>

#include "TraversalGates.h"
#include "TraversalHost.h"
#include "TraversalOne.h"
#include "TraversalSolids.h"
#include "cde/mesh/terrain.hpp"
#include "cde/reference/traversal.hpp"
#include "hard_solids.hpp"
#include "traversal_bench.hpp"

namespace cde::testing {
namespace {

using Eigen::Vector3f;
using namespace traversals;

constexpr std::size_t kStream = 20'000;  // rays, many times the number of contexts

struct Scene {
  std::vector<Triangle> triangles;
  std::vector<Ray> rays;
};

/// A terrain with every third triangle twice, so that ties occur.
Scene scene(std::size_t rays) {
  const Mesh mesh = make_terrain({.quads_x = 24, .quads_y = 24});
  Scene s;
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    s.triangles.push_back(mesh.triangle(i));
    if (i % 3 == 0) s.triangles.push_back(mesh.triangle(i));
  }
  const auto box = bounds(mesh);
  Dice dice;
  const auto within = [&](float beyond) {
    Vector3f p;
    for (int k = 0; k < 3; ++k)
      p[k] = box.min()[k] +
             box.sizes()[k] *
                 (static_cast<float>(dice.below(10'001)) * 1e-4f * (1 + 2 * beyond) - beyond);
    return p;
  };
  for (std::size_t i = 0; i < rays; ++i) {
    Ray ray{within(0.5f), Vector3f::Zero()};
    ray.d = within(0.1f) - ray.o;
    if (i % 5 == 0) ray.d = Vector3f(0, 0, i % 2 == 0 ? -1 : 1);
    if (i % 7 == 0) ray.tmin = -3, ray.tmax = 0.7f;
    s.rays.push_back(ray);
  }
  return s;
}

std::vector<Record> by_primary_and_index(std::vector<Record> hits) {
  std::sort(hits.begin(), hits.end(), [](const Record& a, const Record& b) {
    return a.primary != b.primary ? a.primary < b.primary : a.index < b.index;
  });
  return hits;
}

template <class Module>
void expect_hits(const Scene& s, const Bvh& bvh, Algorithm algorithm, bool patient) {
  Bench<Module> bench(s.triangles, bvh);
  reference::Traversal expected(s.triangles, bvh, algorithm);
  (void)bench.cast(s.rays, kHits, patient);
  bench.hits = by_primary_and_index(std::move(bench.hits));
  std::size_t at = 0;
  for (std::size_t i = 0; i < s.rays.size(); ++i) {
    for (const Record& should :
         expected.trace(s.rays[i], static_cast<std::uint32_t>(i), Mode::kHits)) {
      ASSERT_LT(at, bench.hits.size());
      ASSERT_TRUE(same_bits(bench.hits[at++], should)) << "ray " << i << ", hit " << at;
    }
  }
  EXPECT_EQ(at, bench.hits.size());
  EXPECT_GT(at, s.rays.size() / 10);
  if (patient && s.rays.size() >= kStream) bench.expect_cycles(s.rays.size());
}

template <class Module>
void expect_reference(std::size_t count, Algorithm algorithm = Algorithm::kMoller) {
  const Scene s = scene(count);
  for (const unsigned leaf : {1u, 2u}) {
    const Bvh bvh = Bvh::build(s.triangles, {.leaf = leaf});
    for (const bool patient : {true, false}) {
      for (const Goal& goal : kGoals) {
        Bench<Module> bench(s.triangles, bvh);
        reference::Traversal expected(s.triangles, bvh, algorithm);
        const std::vector<Record> records = bench.cast(s.rays, goal.number, patient);
        std::size_t hits = 0;
        for (std::size_t i = 0; i < s.rays.size(); ++i) {
          Record should = expected.trace(s.rays[i], ~0u, goal.mode)[0];
          ASSERT_EQ(records[i].f, should.f) << name_of(goal.mode) << " ray " << i;
          if (!should.f) continue;
          ++hits;
          ASSERT_TRUE(same_bits(records[i], should))
              << name_of(goal.mode) << " ray " << i << ": T " << records[i].t << " of "
              << records[i].index << "; expected " << should.t << " of " << should.index;
        }
        EXPECT_GT(hits, count / 10);
        EXPECT_LT(hits, count);
        EXPECT_EQ(bench.nodes(), expected.counts().nodes) << name_of(goal.mode);
        EXPECT_EQ(bench.secondaries(), expected.counts().secondaries) << name_of(goal.mode);
        if (patient && count >= kStream) bench.expect_cycles(count);
        if (patient && leaf == 2)
          std::printf("%s: %.2f cycles, %.2f nodes, %.2f triangles per ray\n", name_of(goal.mode),
                      bench.cycles / static_cast<double>(count),
                      bench.nodes() / static_cast<double>(count),
                      bench.secondaries() / static_cast<double>(count));
        if (kPinned<Module> != 0) {
          EXPECT_GT(bench.fetched(), 2 * bvh.nodes().size());  // lines are replaced
          EXPECT_LT(3 * bench.fetched(), 2 * bench.cached());
        }
      }
      Bench<Module> bench(s.triangles, bvh);
      reference::Traversal expected(s.triangles, bvh, algorithm);
      const std::vector<Record> records = bench.cast(s.rays, kOccluded, patient);
      for (std::size_t i = 0; i < s.rays.size(); ++i)
        ASSERT_EQ(records[i].f, expected.occluded(s.rays[i])) << "ray " << i;
      EXPECT_EQ(bench.nodes(), expected.counts().nodes);
      EXPECT_EQ(bench.secondaries(), expected.counts().secondaries);
      if (patient && count >= kStream) bench.expect_cycles(count);
      expect_hits<Module>(s, bvh, algorithm, patient);
    }
  }
}

/// With the algorithm of the longest latency; a card has moller in gates.
TEST(Traversal, Gates_EqualTheReference) {
  expect_reference<TraversalGates>(300, Algorithm::kWatertight);
}

TEST(Traversal, HostArithmetic_EqualsTheReference) {
  expect_reference<TraversalHost>(kStream);
}

/// The operators of the front serve the axes in turn.
TEST(Traversal, GatesOfTwoCyclesPerNode_EqualTheReference) {
  expect_reference<TraversalGatesTwo>(300);
}

/// One secondary per cycle, as for the lane of a placed card.
TEST(Traversal, SecondariesOneByOne_EqualTheReference) {
  expect_reference<TraversalSerial>(4000);
}

TEST(Traversal, TwoCyclesPerNode_EqualTheReference) {
  expect_reference<TraversalTwo>(kStream);
}

TEST(Traversal, NodesInDdr_EqualTheReference) {
  expect_reference<TraversalCached>(kStream);
}

/// One packet, then a stream of rays from within the terrain in any direction.
TEST(Traversal, Terrain_TakesTheDocumentedCycles) {
  const Mesh mesh = make_terrain();
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) triangles.push_back(mesh.triangle(i));
  const Bvh bvh = Bvh::build(triangles);
  reference::Traversal expected(triangles, bvh);
  const auto box = bounds(mesh);
  Dice dice;
  const auto share = [&] { return static_cast<float>(dice.below(1u << 24)) * 0x1p-24f; };
  for (const std::size_t count : {std::size_t{256}, kStream}) {
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < count; ++i) {
      Ray ray;
      for (int k = 0; k < 3; ++k) {
        ray.o[k] = box.min()[k] + share() * box.sizes()[k];
        ray.d[k] = 2 * share() - 1;
      }
      rays.push_back(ray);
    }
    Bench<TraversalHost> bench(triangles, bvh);
    const std::vector<Record> records = bench.cast(rays, 0, true);
    for (std::size_t i = 0; i < count; ++i) {
      const Record should = expected.trace(rays[i], ~0u, Mode::kNearest)[0];
      ASSERT_EQ(records[i].f, should.f) << "ray " << i;
      if (should.f) {
        ASSERT_TRUE(same_bits(records[i], should)) << "ray " << i;
      }
    }
    if (count == kStream) bench.expect_cycles(count);
    std::printf("%zu rays: %u cycles, %.2f per ray; %.2f nodes, %.2f triangles\n", count,
                bench.cycles, bench.cycles / static_cast<double>(count),
                bench.nodes() / static_cast<double>(count),
                bench.secondaries() / static_cast<double>(count));
  }
}

/// One unit and at most two rays in flight.
TEST(Traversal, TwoContexts_EqualTheReference) {
  expect_reference<TraversalOne>(1000);
}

/// Spheres: records, nodes read and secondaries tested.
template <class Module>
void expect_spheres(const hard::TriangleScene& triangles, std::size_t count) {
  hard::Solids draws(triangles, 3);
  std::vector<Sphere> solids;
  for (std::size_t i = 0; i < count; ++i)
    solids.push_back(draws.sphere(static_cast<unsigned>(i % hard::Solids::kKinds)));
  const Bvh bvh = Bvh::build(triangles, {.leaf = 2});
  for (const bool patient : {true, false}) {
    for (const Goal& goal : {kGoals[0], kGoals[2]}) {
      Bench<Module> bench(triangles, bvh);
      reference::Traversal traversal(triangles, bvh);
      const std::vector<Record> records = bench.cast(solids, goal.number, patient);
      std::size_t touching = 0;
      for (std::size_t i = 0; i < count; ++i) {
        const Record should = traversal.trace(solids[i], ~0u, goal.mode)[0];
        touching += should.f;
        ASSERT_EQ(records[i].f, should.f) << name_of(goal.mode) << ' ' << hard::text(solids[i]);
        if (should.index == ~0u) continue;
        ASSERT_TRUE(same_bits(records[i], should))
            << name_of(goal.mode) << ' ' << hard::text(solids[i]) << ": T " << records[i].t
            << " of " << records[i].index << "; expected " << should.t << " of " << should.index;
      }
      EXPECT_GT(touching, count / 10);
      EXPECT_LT(touching, count);
      EXPECT_EQ(bench.nodes(), traversal.counts().nodes) << name_of(goal.mode);
      EXPECT_EQ(bench.secondaries(), traversal.counts().secondaries) << name_of(goal.mode);
      if (patient)
        std::printf("%s: %.2f cycles, %.2f nodes, %.2f triangles per solid\n", name_of(goal.mode),
                    bench.cycles / static_cast<double>(count),
                    static_cast<double>(bench.nodes()) / static_cast<double>(count),
                    static_cast<double>(bench.secondaries()) / static_cast<double>(count));
    }
    Bench<Module> bench(triangles, bvh);
    reference::Traversal traversal(triangles, bvh);
    const std::vector<Record> records = bench.cast(solids, kOccluded, patient);
    for (std::size_t i = 0; i < count; ++i)
      ASSERT_EQ(records[i].f, traversal.occluded(solids[i])) << hard::text(solids[i]);
    EXPECT_EQ(bench.nodes(), traversal.counts().nodes);
    Bench<Module> all(triangles, bvh);
    (void)all.cast(solids, kHits, patient);
    std::vector<Record> hits;
    for (std::uint32_t i = 0; i < count; ++i)
      for (const Record& hit : traversal.trace(solids[i], i, Mode::kHits)) hits.push_back(hit);
    EXPECT_TRUE(std::ranges::equal(by_primary_and_index(all.hits), hits, same_bits));
    EXPECT_GT(hits.size(), count / 5);
  }
}

TEST(Traversal, Spheres_EqualTheReference) {
  for (const hard::Case& c : std::span(hard::kScenes).subspan(2)) {  // the first two are large
    SCOPED_TRACE(c.name);
    expect_spheres<TraversalSolids>(c.make(), 60);
  }
}

/// Passes of few primaries that do not wait for their leaves, one after the other in the same
/// contexts. Records are the same, and no fewer nodes are read. `cycles` is the expected duration.
template <class Module, class P>
void expect_ahead(const std::vector<Triangle>& triangles, const std::vector<P>& primaries,
                  bool patient, bool ahead, unsigned& cycles) {
  const Bvh bvh = Bvh::build(triangles, {.leaf = 2});
  reference::Traversal traversal(triangles, bvh);
  cycles = 0;
  for (unsigned goal = 0; goal <= kHits; ++goal) {
    if (goal == 1 && !std::is_same_v<P, Ray>) continue;  // no solid is farthest
    SCOPED_TRACE(goal);
    Bench<Module> bench(triangles, bvh);
    bench.ahead = ahead;
    const auto before = traversal.counts();
    for (std::size_t first = 0, count = 1; first < primaries.size();
         first += count, count = count % 16 + 1) {
      count = std::min(count, primaries.size() - first);
      const std::vector<P> some(primaries.begin() + static_cast<std::ptrdiff_t>(first),
                                primaries.begin() + static_cast<std::ptrdiff_t>(first + count));
      bench.hits.clear();
      const std::vector<Record> records = bench.cast(some, goal, patient);
      cycles += bench.cycles;
      std::vector<Record> hits;
      for (std::uint32_t i = 0; i < count; ++i) {
        if (goal == kOccluded) {
          ASSERT_EQ(records[i].f, traversal.occluded(some[i])) << first + i;
        } else if (goal == kHits) {
          for (const Record& hit : traversal.trace(some[i], i, Mode::kHits)) hits.push_back(hit);
        } else {
          const Record should = traversal.trace(some[i], ~0u, kGoals[goal].mode)[0];
          ASSERT_EQ(records[i].f, should.f) << first + i;
          if (should.index == ~0u) continue;
          ASSERT_TRUE(same_bits(records[i], should)) << first + i;
        }
      }
      ASSERT_TRUE(std::ranges::equal(by_primary_and_index(bench.hits), hits, same_bits)) << first;
    }
    const std::uint64_t nodes = traversal.counts().nodes - before.nodes,
                        secondaries = traversal.counts().secondaries - before.secondaries;
    if (!ahead || goal == 2 || goal == kHits) {  // these goals read every node that is hit
      EXPECT_EQ(bench.nodes(), nodes);
      EXPECT_EQ(bench.secondaries(), secondaries);
    } else {
      EXPECT_GE(bench.nodes(), nodes);
      EXPECT_GE(bench.secondaries(), secondaries);
    }
  }
}

TEST(Traversal, PassesAheadOfTheirLeaves_EqualTheReferenceFaster) {
  const Scene s = scene(300);
  std::vector<Sphere> spheres;
  for (std::size_t i = 0; i < s.rays.size(); ++i)
    spheres.push_back({s.rays[i].o, 0.4f * static_cast<float>(i % 23 + 1)});
  for (const bool patient : {true, false}) {
    unsigned ahead = 0, waiting = 0;
    expect_ahead<TraversalHost>(s.triangles, s.rays, patient, true, ahead);
    expect_ahead<TraversalSolids>(s.triangles, spheres, patient, true, ahead);
    expect_ahead<TraversalSolids>(s.triangles, spheres, patient, false, waiting);
    std::printf("%u cycles, not %u\n", ahead, waiting);
    EXPECT_LT(2 * ahead, waiting);
  }
}

/// The same module with other pairs.
TEST(Traversal, RaysBesideSolids_EqualTheReference) {
  expect_reference<TraversalSolids>(500);
}

}  // namespace
}  // namespace cde::testing
