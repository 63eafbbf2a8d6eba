// SPDX-License-Identifier: Apache-2.0
// Closest hits of whole meshes against Embree. The triangles may differ in two cases: both answers
// lie within rounding of each other (a shared edge, coincident triangles), or exact arithmetic
// shows that the decision is uncertain. Every such ray is counted.
#include <embree3/rtcore.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <random>

#include "cde/card/board.hpp"
#include "cde/geometry/bounds.hpp"
#include "cde/mesh/mesh.hpp"
#include "cde/mesh/terrain.hpp"
#include "cde/oracle/exact.hpp"

namespace {

using cde::Mesh;
using cde::Ray;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr unsigned kSeed = 1997;

class Embree {
 public:
  explicit Embree(const Mesh& mesh)
      : device_(rtcNewDevice("threads=1"), rtcReleaseDevice),
        scene_(rtcNewScene(device_.get()), rtcReleaseScene) {
    rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* v = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, mesh.vertices.size()));
    for (const Vector3f& p : mesh.vertices) v = std::copy_n(p.data(), 3, v);
    auto* f = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, mesh.faces.size()));
    for (const auto& face : mesh.faces) f = std::copy_n(face.data(), 3, f);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_.get(), geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_.get());
  }
  /// Triangle and t, or all ones.
  [[nodiscard]] std::pair<unsigned, float> cast(const Ray& ray) const {
    RTCRayHit q{};
    q.ray.org_x = ray.o.x(), q.ray.org_y = ray.o.y(), q.ray.org_z = ray.o.z();
    q.ray.dir_x = ray.d.x(), q.ray.dir_y = ray.d.y(), q.ray.dir_z = ray.d.z();
    q.ray.tnear = ray.tmin, q.ray.tfar = ray.tmax, q.ray.mask = ~0u;
    q.hit.geomID = q.hit.primID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_.get(), &context, &q);
    return {q.hit.geomID == RTC_INVALID_GEOMETRY_ID ? ~0u : q.hit.primID, q.ray.tfar};
  }

 private:
  std::unique_ptr<std::remove_pointer_t<RTCDevice>, void (*)(RTCDevice)> device_;
  std::unique_ptr<std::remove_pointer_t<RTCScene>, void (*)(RTCScene)> scene_;
};

/// Whether rounding alone could make this triangle a hit or a miss, or move its t.
bool uncertain_decision(const Ray& ray, const cde::Triangle& triangle) {
  const ExactHit exact(ray, triangle);
  const cde::MollerBound bound = cde::moller_bound(ray, triangle);
  const double det = std::abs(static_cast<double>(exact.det));
  if (det <= bound.det) return true;
  const double u = static_cast<double>(exact.u) * det, v = static_cast<double>(exact.v) * det;
  return std::abs(u) <= bound.u || std::abs(v) <= bound.v ||
         std::abs(det - u - v) <= bound.uv + bound.det;
}

void compare(const char* name, const Mesh& mesh, const std::vector<Ray>& rays) {
  cde::Board board = cde::Board::open(cde::BoardConfig{.lanes = 16});
  board.upload(mesh);
  const std::vector<cde::Record> records = board.cast(rays);
  const Embree embree(mesh);
  int hits = 0, same = 0, tie = 0, edge = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    const cde::Record& card = records[i];
    const auto [index, t] = embree.cast(rays[i]);
    hits += card.f;
    if (card.index == index) {
      ++same;
      continue;
    }
    // Compares both in exact arithmetic: which is nearer, and by more than rounding?
    if (card.f && index != ~0u && std::abs(card.t - t) <= 1e-5f * std::abs(t)) {
      ++tie;
      continue;
    }
    const bool excused = (card.f && uncertain_decision(rays[i], mesh.triangle(card.index))) ||
                         (index != ~0u && uncertain_decision(rays[i], mesh.triangle(index)));
    EXPECT_TRUE(excused) << name << " ray " << i << " seed " << kSeed << ": card says "
                         << card.index << " at " << card.t << ", Embree " << index << " at " << t
                         << std::hexfloat << " o " << rays[i].o.transpose() << " d "
                         << rays[i].d.transpose();
    edge += excused;
  }
  std::printf(
      "%s: seed %u, %zu rays, %d hit, %d same triangle, %d other triangle at the same T, %d "
      "uncertain "
      "at an edge\n",
      name, kSeed, rays.size(), hits, same, tie, edge);
  EXPECT_GT(hits, static_cast<int>(0.3 * rays.size()));
  EXPECT_LE(tie + edge, static_cast<int>(0.01 * rays.size()) + 2);
}

std::vector<Ray> rays_around(const Mesh& mesh, int n) {
  std::mt19937_64 bits(kSeed);
  const auto unit = [&] { return static_cast<double>(bits() >> 11) * 0x1p-53; };
  const Eigen::AlignedBox3f box = bounds(mesh);
  const Vector3d centre = box.center().cast<double>(), half = 0.5 * box.sizes().cast<double>();
  std::vector<Ray> rays;
  for (int i = 0; i < n; ++i) {
    const Vector3d from =
        centre + 1.5 * half.norm() * Vector3d(2 * unit() - 1, 2 * unit() - 1, 2 * unit() - 1);
    const Vector3d to =
        centre + half.cwiseProduct(Vector3d(2 * unit() - 1, 2 * unit() - 1, 2 * unit() - 1));
    Ray ray;
    ray.o = from.cast<float>();
    ray.d = (to - from).cast<float>();
    rays.push_back(ray);
  }
  return rays;
}

TEST(Embree, Terrain_AgreesWithEmbree) {
  const Mesh mesh = cde::make_terrain({});
  compare("terrain", mesh, rays_around(mesh, 1024));
}

TEST(Embree, ClosedSphere_AgreesWithEmbree) {
  const Mesh mesh = cde::load_mesh(CDE_SOURCE_DIR "/meshes/icosphere.ply");
  compare("icosphere", mesh, rays_around(mesh, 20000));
}

TEST(Embree, Torus_AgreesWithEmbree) {
  const Mesh mesh = cde::load_mesh(CDE_SOURCE_DIR "/meshes/torus.stl");
  compare("torus", mesh, rays_around(mesh, 20000));
}

}  // namespace
