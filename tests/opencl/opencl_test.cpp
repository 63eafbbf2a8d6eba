// SPDX-License-Identifier: Apache-2.0
// The OpenCL baseline against the reference: brute force and BVH, on the first device.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "baselines/baseline_opencl.hpp"
#include "baselines/hit_differences.hpp"
#include "cde/reference/reference.hpp"
#include "expect_error.hpp"
#include "hard_rays.hpp"

namespace cde::testing {
namespace {

using baseline::OpenClDevice;
using baseline::OpenClRays;
using baseline::OpenClSpheres;
using hard::Rays;
using hard::TriangleScene;

constexpr Through kWays[] = {Through::kBruteForce, Through::kBvh};

class OpenCl : public ::testing::Test {
 protected:
  void SetUp() override {
    try {
      device_ = baseline::choose_opencl_device(baseline::opencl_devices(), "");
    } catch (const Error& e) {
      GTEST_SKIP() << e.what();
    }
  }

  /// Expects the records of brute force in the reference: bit for bit where the device is exact.
  void expect_reference(const TriangleScene& scene, const std::vector<Ray>& rays,
                        double least_hit_share = 0) const {
    const std::vector<Record> records = reference::cast(rays, scene, Mode::kNearest, {}, {}, true);
    OpenClRays opencl(device_, scene);
    for (const Through through : kWays) {
      opencl.upload(through);
      const auto hits = opencl.cast(rays, through);
      const auto d = baseline::compare_hits(records, hits);
      if (device_.is_exact()) {
        EXPECT_EQ(d.equal(), rays.size())
            << (through == Through::kBvh ? "BVH: " : "brute force: ") << d.text();
      }
      baseline::require_few(d, device_.label());
    }
    std::size_t hit = 0;
    for (const Record& r : records) hit += r.f ? 1 : 0;
    EXPECT_GE(static_cast<double>(hit), least_hit_share * static_cast<double>(rays.size()));
  }
  OpenClDevice device_;
};

/// Ten families of rays: any, edges, vertices, in planes, along axes, from far, with an interval,
/// grazing.
class OpenClScenes : public OpenCl, public ::testing::WithParamInterface<hard::Case> {};
INSTANTIATE_TEST_SUITE_P(Scenes, OpenClScenes, ::testing::ValuesIn(hard::kScenes),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_P(OpenClScenes, HardRays_EqualTheReference) {
  const TriangleScene scene = GetParam().make();
  Rays draw(scene, 11);
  std::vector<Ray> rays;
  for (unsigned i = 0; i < 10'000; ++i) rays.push_back(draw(i % Rays::kKinds));
  expect_reference(scene, rays, 0.05);
}

/// Every triangle twice: the lower index wins, also where leaves have another order.
TEST_F(OpenCl, DuplicateTriangles_GiveTheLowestIndex) {
  TriangleScene scene = hard::icosphere({1, 2, 3});
  const std::size_t once = scene.size();
  for (std::size_t i = 0; i < once; ++i) scene.push_back(scene[i]);
  Rays draw(scene, 12);
  std::vector<Ray> rays;
  for (unsigned i = 0; i < 4'000; ++i) rays.push_back(draw(i % Rays::kKinds));
  expect_reference(scene, rays, 0.3);
  OpenClRays opencl(device_, scene);
  for (const Through through : kWays) {
    opencl.upload(through);
    for (const auto& hit : opencl.cast(rays, through))
      EXPECT_TRUE(hit.index < once || hit.index == ~0u) << hit.index;
  }
}

/// Lengths from the least to the largest of the contract, and around zero.
TEST_F(OpenCl, TinyAndHugeScenes_EqualTheReference) {
  const TriangleScene unit = hard::icosphere({0, 0, 0});
  for (const int power : {-120, -60, -34, -10, 20, 38}) {
    TriangleScene scene = unit;
    for (Triangle& t : scene)
      for (auto* v : {&t.v0, &t.v1, &t.v2}) *v *= std::ldexp(1.0f, power);
    Rays draw(unit, 13);
    std::vector<Ray> rays;
    for (unsigned i = 0; i < 2'000; ++i) {
      Ray ray = draw(i % 7);  // from far away would exceed the contract
      ray.o *= std::ldexp(1.0f, power);
      rays.push_back(ray);
    }
    SCOPED_TRACE(power);
    expect_reference(scene, rays, power < -40 ? 0 : 0.2);
  }
}

/// The numbers of rays and triangles around the sizes of groups and chunks.
TEST_F(OpenCl, AnyNumberOfRaysAndTriangles_IsAnswered) {
  const TriangleScene all = hard::flat();
  for (const std::size_t triangles : {1u, 2u, 4u, 5u, 63u, 64u, 65u, 129u, 200u}) {
    const TriangleScene scene(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(triangles));
    for (const std::size_t count : {1u, 2u, 63u, 64u, 65u, 300u}) {
      Rays draw(scene, 14);
      std::vector<Ray> rays;
      for (unsigned i = 0; i < count; ++i) rays.push_back(draw(i % Rays::kKinds));
      SCOPED_TRACE(fmt::format("{} triangles, {} rays", triangles, count));
      expect_reference(scene, rays);
    }
  }
}

TEST_F(OpenCl, Misses_HaveNoIndex) {
  OpenClRays opencl(device_, TriangleScene{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}});
  for (const Through through : kWays) {
    opencl.upload(through);
    const auto hits = opencl.cast(std::vector<Ray>{{{5, 5, 5}, {0, 0, 1}}}, through);
    EXPECT_EQ(hits[0].index, ~0u);
    EXPECT_TRUE(std::isinf(hits[0].t));
    EXPECT_TRUE(opencl.cast({}, through).empty());
  }
}

/// A ray that starts on the triangle, towards its back: T is +0.
TEST_F(OpenCl, TouchingRay_HasTZero) {
  const TriangleScene scene{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
  const std::vector<Ray> rays{{{0.25f, 0.25f, 0}, {0, 0, 1}}, {{0.25f, 0.25f, 0}, {0, 0, -1}}};
  expect_reference(scene, rays, 1);
  OpenClRays opencl(device_, scene);
  opencl.upload(Through::kBvh);
  for (const auto& hit : opencl.cast(rays, Through::kBvh))
    EXPECT_EQ(std::bit_cast<std::uint32_t>(hit.t), 0u);
}

TEST_F(OpenCl, HitBeyondNumbers_IsAMiss) {
  expect_reference(hard::edge_on(), {hard::beyond_numbers()});
}

TEST_F(OpenCl, MovedTriangles_AreSeenByBruteForce) {
  TriangleScene scene = hard::tilted_plane();
  OpenClRays opencl(device_, scene);
  opencl.upload(Through::kBruteForce);
  for (std::size_t i = 100; i < 200; ++i)
    for (auto* v : {&scene[i].v0, &scene[i].v1, &scene[i].v2}) v->z() += 0.5f;
  EXPECT_GT(opencl.move(100, std::span(scene).subspan(100, 100)), 0);
  Rays draw(scene, 15);
  std::vector<Ray> rays;
  for (unsigned i = 0; i < 1'000; ++i) rays.push_back(draw(i % Rays::kKinds));
  const auto d = baseline::compare_hits(reference::cast(rays, scene, Mode::kNearest, {}, {}, true),
                                        opencl.cast(rays, Through::kBruteForce));
  EXPECT_TRUE(!device_.is_exact() || d.equal() == rays.size()) << d.text();
  expect_error(ErrorCode::kUsage, "exceed the mesh",
               [&] { (void)opencl.move(scene.size(), scene); });
}

TEST_F(OpenCl, Times_ArePlausible) {
  const TriangleScene scene = hard::icosphere({0, 0, 0});
  OpenClRays opencl(device_, scene);
  EXPECT_GT(opencl.bvh().nodes, scene.size() / 8);
  EXPECT_EQ(opencl.bvh().bytes, 64 * opencl.bvh().nodes);
  for (const Through through : kWays) {
    EXPECT_GT(opencl.upload(through), 0);
    Rays draw(scene, 16);
    std::vector<Ray> rays;
    for (unsigned i = 0; i < 1'000; ++i) rays.push_back(draw(0));
    baseline::OpenClTimes times;
    (void)opencl.cast(rays, through, &times);
    EXPECT_GT(times.kernel, 0);
    EXPECT_GT(times.copies, times.kernel) << "wall time includes the kernel";
  }
}

TEST_F(OpenCl, Spheres_OverlapAsInSoftware) {
  hard::Draw draw(17);
  std::vector<Sphere> spheres(333);
  for (Sphere& sphere : spheres) sphere = {5 * draw.point(), draw(0.2f, 0.6f)};
  std::uint64_t expected = 0;
  for (const Sphere& a : spheres)
    for (const Sphere& b : spheres) {
      const Eigen::Vector3f d = b.c - a.c;
      const float sum = b.r + a.r;
      expected += (d.x() * d.x() + d.y() * d.y()) + d.z() * d.z() <= sum * sum ? 1 : 0;
    }
  OpenClSpheres opencl(device_);
  baseline::OpenClTimes times;
  EXPECT_EQ(opencl.overlaps(spheres, &times), expected);
  EXPECT_GT(expected, spheres.size());
  EXPECT_GT(times.copies, times.kernel);
  EXPECT_EQ(opencl.overlaps({}), 0u);
}

TEST_F(OpenCl, BadInput_IsNamed) {
  expect_error(ErrorCode::kBadInput, "no triangles", [&] { OpenClRays(device_, {}); });
  const TriangleScene huge{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                           {{0, 0, 0}, {0x1p41f, 0, 0}, {0, 1, 0}}};
  expect_error(ErrorCode::kBadInput, "triangle 1", [&] { OpenClRays(device_, huge); });
  OpenClRays opencl(device_, std::span(huge).first(1));
  opencl.upload(Through::kBvh);
  const std::vector<Ray> rays{{{0, 0, 0}, {0, 0, 1}}, {{0, 0, 0}, {0, 0, 0}}};
  expect_error(ErrorCode::kBadInput, "ray 1", [&] { (void)opencl.cast(rays, Through::kBvh); });
}

}  // namespace
}  // namespace cde::testing
