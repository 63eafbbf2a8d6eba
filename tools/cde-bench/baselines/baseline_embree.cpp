// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "baselines/software_baselines.hpp"

#ifdef CDE_EMBREE
#include <embree3/rtcore.h>

#include <algorithm>

namespace cde::cli {

struct EmbreeBaseline::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  RTCGeometry geometry = nullptr;
  float* vertices = nullptr;
};

bool EmbreeBaseline::available() {
  return true;
}

EmbreeBaseline::EmbreeBaseline(const Mesh& mesh) : impl_(std::make_unique<Impl>()) {
  impl_->device = rtcNewDevice("threads=1");
  impl_->scene = rtcNewScene(impl_->device);
  rtcSetSceneFlags(impl_->scene,
                   static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC));
  impl_->geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryBuildQuality(impl_->geometry, RTC_BUILD_QUALITY_REFIT);
  impl_->vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      impl_->geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, mesh.vertices.size()));
  float* v = impl_->vertices;
  for (const Eigen::Vector3f& p : mesh.vertices) v = std::copy_n(p.data(), 3, v);
  auto* f = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      impl_->geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, mesh.faces.size()));
  for (const auto& face : mesh.faces) f = std::copy_n(face.data(), 3, f);
  rtcCommitGeometry(impl_->geometry);
  rtcAttachGeometry(impl_->scene, impl_->geometry);
  rtcCommitScene(impl_->scene);
}

EmbreeBaseline::~EmbreeBaseline() {
  rtcReleaseGeometry(impl_->geometry);
  rtcReleaseScene(impl_->scene);
  rtcReleaseDevice(impl_->device);
}

void EmbreeBaseline::move(std::size_t first, std::span<const Eigen::Vector3f> vertices) {
  float* v = impl_->vertices + 3 * first;
  for (const Eigen::Vector3f& p : vertices) v = std::copy_n(p.data(), 3, v);
  rtcUpdateGeometryBuffer(impl_->geometry, RTC_BUFFER_TYPE_VERTEX, 0);
  rtcCommitGeometry(impl_->geometry);
  rtcCommitScene(impl_->scene);
}

std::vector<float> EmbreeBaseline::cast(std::span<const Ray> rays) const {
  std::vector<float> nearest;
  nearest.reserve(rays.size());
  for (const Ray& ray : rays) {
    RTCRayHit q{};
    q.ray.org_x = ray.o.x(), q.ray.org_y = ray.o.y(), q.ray.org_z = ray.o.z();
    q.ray.dir_x = ray.d.x(), q.ray.dir_y = ray.d.y(), q.ray.dir_z = ray.d.z();
    q.ray.tnear = ray.tmin, q.ray.tfar = ray.tmax, q.ray.mask = ~0u;
    q.hit.geomID = q.hit.primID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(impl_->scene, &context, &q);
    nearest.push_back(q.hit.geomID == RTC_INVALID_GEOMETRY_ID ? INFINITY : q.ray.tfar);
  }
  return nearest;
}

}  // namespace cde::cli

#else

namespace cde::cli {

struct EmbreeBaseline::Impl {};
bool EmbreeBaseline::available() {
  return false;
}
EmbreeBaseline::EmbreeBaseline(const Mesh& /*mesh*/) {}
EmbreeBaseline::~EmbreeBaseline() = default;
void EmbreeBaseline::move(std::size_t /*first*/, std::span<const Eigen::Vector3f> /*vertices*/) {}
std::vector<float> EmbreeBaseline::cast(std::span<const Ray> /*rays*/) const {
  return {};
}

}  // namespace cde::cli

#endif
