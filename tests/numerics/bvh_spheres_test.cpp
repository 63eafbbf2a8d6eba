// SPDX-License-Identifier: Apache-2.0
// Rays and spheres against a BVH over spheres, compared with brute force.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "cde/reference/traversal.hpp"
#include "cde/support/error.hpp"
#include "hard_spheres.hpp"
#include "traversal_and_brute_force.hpp"

namespace cde::testing {
namespace {

using namespace hard;

constexpr unsigned kSeed = 7;

constexpr Mode kRayModes[] = {Mode::kNearest, Mode::kFarthest, Mode::kAny, Mode::kHits};
constexpr Mode kModes[] = {Mode::kNearest, Mode::kAny, Mode::kHits};

template <class P>
void expect_all(const Cloud& cloud, const std::vector<P>& primaries, std::size_t least) {
  fmt::print("seed {}: ", kSeed);
  const std::span<const Mode> modes =
      std::is_same_v<P, Ray> ? std::span<const Mode>(kRayModes) : std::span<const Mode>(kModes);
  expect_all_records(cloud, primaries, modes, least, [](const P& p) { return text(p); });
}

class BvhEveryCloud : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Scenes, BvhEveryCloud, ::testing::ValuesIn(kScenes),
                         [](const auto& test) { return std::string(test.param.name); });

/// CDE_FULL=1: a million rays and 200,000 spheres in all.
TEST_P(BvhEveryCloud, RaysAgainstSpheres_EqualBruteForce) {
  const Cloud cloud = cloud_of(GetParam().make());
  CloudRays draw(cloud, kSeed);
  std::vector<Ray> rays;
  for (unsigned i = 0; i < (full() ? 125'000u : 3000u); ++i)
    rays.push_back(draw(i % CloudRays::kKinds));
  expect_all(cloud, rays, rays.size());
}
TEST_P(BvhEveryCloud, SpheresAgainstSpheres_EqualBruteForce) {
  const Cloud cloud = cloud_of(GetParam().make());
  CloudSpheres draw(cloud, kSeed);
  std::vector<Sphere> spheres;
  for (unsigned i = 0; i < (full() ? 25'000u : 2000u); ++i)
    spheres.push_back(draw(i % CloudSpheres::kKinds));
  expect_all(cloud, spheres, spheres.size());
}

/// Where T^2 is not a normal number a hit can be anywhere: such rays meet all boxes.
TEST(BvhOverSpheres, RaysOfAnyLength_EqualBruteForce) {
  for (const float size : {0x1p-33f, 0x1p-26f, 0x1p38f}) {
    Cloud cloud = cloud_of(kScenes[0].make());
    for (Sphere& s : cloud) s.c *= size, s.r = std::max(s.r * size, 0x1p-34f);
    CloudRays draw(cloud, kSeed);
    std::vector<Ray> rays;
    for (unsigned i = 0; i < 1000; ++i) rays.push_back(draw(7));
    expect_all(cloud, rays, 0);
  }
}

/// Boxes are rounded outwards, so nodes contain their spheres.
TEST(BvhOverSpheres, Boxes_ContainTheirSpheres) {
  Draw draw(kSeed);
  for (int i = 0; i < 100'000; ++i) {
    const Sphere s{draw.point() * draw.power(-30, 30), draw.power(-34, 30) * draw(1, 1.999f)};
    const Bvh bvh = Bvh::build(std::vector{s});
    for (int k = 0; k < 3; ++k) {
      const long double c = s.c[k], r = s.r;  // sums are exact in 64 bits where it matters
      if (std::fabs(std::log2(std::fabs(s.c[k]) / s.r)) > 36) continue;
      ASSERT_LE(bvh.box().min()[k], c - r) << text(s);
      ASSERT_GE(bvh.box().max()[k], c + r) << text(s);
      const float least = static_cast<float>(c - r);
      ASSERT_GE(bvh.box().min()[k], std::nextafter(least, -INFINITY)) << "the box is too wide";
    }
  }
}

/// Spheres that moved keep their BVH, with new boxes.
TEST(BvhOverSpheres, Refit_KeepsRecordsEqualToBruteForce) {
  Cloud cloud = cloud_of(kScenes[0].make());
  Bvh bvh = Bvh::build(cloud);
  Draw draw(kSeed);
  for (Sphere& s : cloud) s.c += draw.point() * 0.3f;
  bvh.refit(cloud);
  CloudSpheres draws(cloud, kSeed);
  std::vector<Sphere> spheres;
  for (unsigned i = 0; i < 500; ++i) spheres.push_back(draws(i % CloudSpheres::kKinds));
  const std::vector<Record> all = brute_force(cloud, spheres, Mode::kNearest);
  reference::Traversal traversal(cloud, bvh);
  for (std::uint32_t i = 0; i < spheres.size(); ++i)
    ASSERT_TRUE(same_bits(traversal.trace(spheres[i], i, Mode::kNearest)[0], all[i]))
        << text(spheres[i]);
  EXPECT_LT(traversal.counts().secondaries, spheres.size() * cloud.size() / 4);
}

TEST(BvhOverSpheres, InvalidUse_IsRefused) {
  const Cloud cloud = {{{0, 0, 0}, 1}, {{3, 0, 0}, 1}};
  const Bvh bvh = Bvh::build(cloud);
  EXPECT_THROW(reference::Traversal(std::span(cloud).first(1), bvh), Error);
  reference::Traversal traversal(cloud, bvh);
  EXPECT_THROW((void)traversal.trace(cloud[0], 0, Mode::kFarthest), Error);
  const Aabb box{{0, 0, 0}, {1, 1, 1}};
  EXPECT_THROW((void)traversal.trace(box, 0, Mode::kNearest), Error);
  EXPECT_THROW((void)Bvh::build(Cloud{{{0x1p40f, 0, 0}, 1}}), Error) << "coordinate of 2^40";
  EXPECT_THROW((void)Bvh::build(Cloud{{{0, NAN, 0}, 1}}), Error);
  for (const float r : {0.0f, -1.0f, 0x1p-35f, NAN})
    EXPECT_THROW((void)Bvh::build(Cloud{{{0, 0, 0}, r}}), Error) << r;
}

}  // namespace
}  // namespace cde::testing
