// SPDX-License-Identifier: Apache-2.0
// Batches: pairs given as numbers, rays in strided arrays, and rays on several threads have the
// bits of the calls that take one word or ray at a time.
#include <gtest/gtest.h>

#include <atomic>
#include <bit>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "cde/bvh/bvh.hpp"
#include "cde/check/random_pairs.hpp"
#include "cde/image/ray_view.hpp"
#include "cde/mesh/terrain.hpp"
#include "cde/reference/pairs.hpp"
#include "cde/reference/traversal.hpp"
#include "expect_error.hpp"

namespace cde::testing {
namespace {

std::vector<std::uint64_t> words_of(const std::vector<float>& numbers) {
  std::vector<std::uint64_t> words;
  for (const float x : numbers) words.push_back(std::bit_cast<std::uint32_t>(x));
  return words;
}
std::uint64_t word(float x) {
  return std::bit_cast<std::uint32_t>(x);
}

TEST(Batches, PairsOfNumbers_EqualPairsOfWords) {
  constexpr std::size_t kCount = 60;
  for (unsigned p = 0; p < kPairs; ++p) {
    const auto pair = static_cast<Pair>(p);
    std::vector<float> a, b;
    RandomPairs random(p);
    for (std::size_t i = 0; i < kCount; ++i) random.pair(pair, a, b);
    a[2] = std::numeric_limits<float>::quiet_NaN();
    std::vector<PairResult> want(kCount);
    std::vector<PairAnswer> got(kCount);
    reference::test_pairs(pair, Algorithm::kMoller, FpFormat{8, 23}, words_of(a), words_of(b),
                          want);
    reference::test_pairs(pair, Algorithm::kMoller, a, b, got);
    std::size_t hits = 0;
    for (std::size_t i = 0; i < kCount; ++i) {
      PairResult r{.f = got[i].f, .bad = got[i].bad, .t = word(got[i].t)};
      for (std::size_t k = 0; k < 3; ++k) {
        r.cp[k] = word(got[i].cp[k]);
        r.n[k] = word(got[i].n[k]);
      }
      EXPECT_EQ(differing_fields(r, want[i]), "") << name(pair) << ", pair " << i;
      hits += got[i].f ? 1 : 0;
    }
    EXPECT_TRUE(got[0].bad) << name(pair);
    EXPECT_GT(hits, 0u) << name(pair);
    EXPECT_LT(hits, kCount) << name(pair);
  }
}

TEST(Batches, PairsOfOtherSizes_AreRefused) {
  std::vector<float> a(4), b(3);
  std::vector<PairAnswer> got(1);
  expect_error(ErrorCode::kUsage, "1 pairs of sphere-sphere need 4 and 4 words, not 4 and 3",
               [&] { reference::test_pairs(Pair::kSphereSphere, Algorithm::kMoller, a, b, got); });
}

struct Terrain {
  Mesh mesh = make_terrain({.quads_x = 40, .quads_y = 40});
  Bvh bvh = Bvh::build(mesh);
  std::vector<Ray> rays;

  explicit Terrain(std::size_t count) {
    std::mt19937 random(7);
    const Eigen::AlignedBox3f box = bounds(mesh);
    std::uniform_real_distribution<float> unit(0, 1);
    const auto point = [&](float above) {
      const Eigen::Vector3f at(unit(random), unit(random), unit(random) + above);
      return Eigen::Vector3f(box.min() + box.sizes().cwiseProduct(at));
    };
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Vector3f from = point(0.5f);
      rays.push_back({from, point(-0.5f) - from});
    }
  }
};

TEST(Batches, RaysOnThreads_EqualRaysOneByOne) {
  Terrain terrain(5000);
  terrain.rays[17].d.setZero();
  terrain.rays[4999].o[1] = std::numeric_limits<float>::quiet_NaN();
  reference::Traversal one(terrain.mesh, terrain.bvh, kLeakFree);
  for (const Mode mode : {Mode::kNearest, Mode::kFarthest, Mode::kAny})
    for (const unsigned threads : {1u, 3u, 64u}) {
      std::vector<Record> got(terrain.rays.size());
      EXPECT_TRUE(reference::trace_rays(terrain.mesh, terrain.bvh, terrain.rays, got,
                                        {.mode = mode, .threads = threads}));
      std::size_t hits = 0;
      for (std::size_t i = 0; i < got.size(); ++i) {
        const auto number = static_cast<std::uint32_t>(i);
        const Record want = one.trace(terrain.rays[i], number, mode).front();
        ASSERT_EQ(differing_fields(got[i], want), "") << name_of(mode) << ", ray " << i;
        hits += got[i].f ? 1 : 0;
      }
      EXPECT_GT(hits, 1000u);
      EXPECT_TRUE(got[17].bad && got[4999].bad);
    }
  std::vector<Record> occluded(terrain.rays.size());
  EXPECT_TRUE(reference::trace_rays(terrain.mesh, terrain.bvh, terrain.rays, occluded,
                                    {.mode = Mode::kOccluded}));
  for (std::size_t i = 0; i < occluded.size(); ++i) {
    EXPECT_EQ(occluded[i].f, one.occluded(terrain.rays[i]));
    EXPECT_EQ(occluded[i].bad, i == 17 || i == 4999);
  }
}

TEST(Batches, RaysInStridedArrays_AreTheSameRays) {
  const Terrain terrain(100);
  constexpr std::size_t kStep = 9;
  std::vector<float> numbers(kStep * terrain.rays.size() + 1);
  for (std::size_t i = 0; i < terrain.rays.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const std::size_t at = kStep * (terrain.rays.size() - 1 - i) + static_cast<std::size_t>(k);
      numbers[at] = terrain.rays[i].o[k];
      numbers[at + 4] = terrain.rays[i].d[k];
    }
  // Backwards from the last row.
  const float* last = numbers.data() + kStep * (terrain.rays.size() - 1);
  const auto back = -static_cast<std::ptrdiff_t>(kStep * sizeof(float));
  const RayView view = StridedRays{.origins = last,
                                   .directions = last + 4,
                                   .origin_step = back,
                                   .direction_step = back,
                                   .count = terrain.rays.size(),
                                   .tmin = 0.25f,
                                   .tmax = 8};
  ASSERT_EQ(view.size(), terrain.rays.size());
  for (std::size_t i = 0; i < view.size(); ++i) {
    EXPECT_EQ(view[i].o, terrain.rays[i].o);
    EXPECT_EQ(view[i].d, terrain.rays[i].d);
    EXPECT_EQ(view[i].tmin, 0.25f);
    EXPECT_EQ(view[i].tmax, 8);
  }
  EXPECT_EQ(view.subview(90, 20).size(), 10u);
  EXPECT_EQ(view.subview(90, 20)[3].o, terrain.rays[93].o);
}

TEST(Batches, Rays_CanBeStoppedAndRefused) {
  const Terrain terrain(1'000'000);
  std::vector<Record> got(terrain.rays.size());
  std::atomic<int> asked = 0;
  EXPECT_FALSE(reference::trace_rays(terrain.mesh, terrain.bvh, terrain.rays, got,
                                     {.threads = 1, .stop = [&] { return ++asked == 1; }}));
  EXPECT_EQ(asked, 1);
  const auto trace = [&](std::size_t records, Mode mode) {
    (void)reference::trace_rays(terrain.mesh, terrain.bvh, terrain.rays,
                                std::span(got).first(records), {.mode = mode});
  };
  expect_error(ErrorCode::kUsage, "1000000 rays need as many records, not 5",
               [&] { trace(5, Mode::kNearest); });
  expect_error(ErrorCode::kUsage, "mode hits has any number of records per ray",
               [&] { trace(got.size(), Mode::kHits); });
  const Mesh other = make_terrain({.quads_x = 2, .quads_y = 2});
  std::vector<Record> few(1);
  expect_error(ErrorCode::kUsage, "", [&] {
    (void)reference::trace_rays(other, terrain.bvh, RayView(terrain.rays).subview(0, 1), few);
  });
}

}  // namespace
}  // namespace cde::testing
