// SPDX-License-Identifier: Apache-2.0
#include "baselines/bench_fcl_mesh.hpp"

#ifdef CDE_FCL
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include "baselines/fcl_objects.hpp"

namespace cde::cli {
namespace {

using Model = fcl::BVHModel<fcl::OBBRSSd>;
using fcl::CollisionObjectd;

std::shared_ptr<Model> model_of(const Mesh& mesh) {
  auto model = std::make_shared<Model>();
  std::vector<fcl::Vector3d> vertices;
  std::vector<fcl::Triangle> triangles;
  for (const Eigen::Vector3f& v : mesh.vertices) vertices.push_back(v.cast<double>());
  for (const auto& face : mesh.faces) triangles.emplace_back(face[0], face[1], face[2]);
  model->beginModel();
  model->addSubModel(vertices, triangles);
  model->endModel();
  return model;
}

constexpr std::size_t kAllContacts = 1u << 20;
std::size_t contacts(const CollisionObjectd& mesh, const CollisionObjectd& other,
                     std::size_t most) {
  fcl::CollisionResultd result;
  return fcl::collide(&other, &mesh, fcl::CollisionRequestd(most, false), result);
}
bool touches(const CollisionObjectd& mesh, const CollisionObjectd& solid) {
  return contacts(mesh, solid, 1) > 0;
}
double distance(const CollisionObjectd& mesh, const CollisionObjectd& solid) {
  fcl::DistanceResultd result;
  return fcl::distance(&solid, &mesh, fcl::DistanceRequestd(false), result);
}

}  // namespace

std::optional<FclOnMesh> measure_fcl_mesh(const Mesh& mesh, Shape shape,
                                          std::span<const float> words) {
  const unsigned each = cde::words(shape);
  const std::size_t count = words.size() / each;
  // The answers, then the time of each question in seconds.
  const auto all = fcl_objects::in_child<double>([&](const auto& put) {
    const CollisionObjectd on(model_of(mesh));
    std::vector<CollisionObjectd> solids;
    for (std::size_t i = 0; i < count; ++i)
      solids.push_back(fcl_objects::object(shape, words.subspan(i * each, each)));
    for (const auto& solid : solids) put(touches(on, solid) ? 1 : 0);
    for (const auto& solid : solids) put(distance(on, solid));
    volatile double kept = 0;
    const auto time = [&](const auto& ask) {
      const Spread spread = measured([&](std::size_t) {
        for (const auto& solid : solids) kept = ask(on, solid);
      });
      put(spread.median / static_cast<double>(count));
    };
    time(touches);
    time(distance);
    (void)kept;
  });
  if (all.size() != 2 * count + 2) return std::nullopt;
  FclOnMesh on_mesh;
  on_mesh.touches.assign(all.begin(), all.begin() + static_cast<long>(count));
  on_mesh.distances.assign(all.begin() + static_cast<long>(count), all.end() - 2);
  on_mesh.collide_seconds = all[2 * count];
  on_mesh.distance_seconds = all[2 * count + 1];
  return on_mesh;
}

std::optional<FclMeshes> measure_fcl_meshes(const Mesh& mesh, std::span<const Mesh> others) {
  const std::size_t count = others.size();
  const auto all = fcl_objects::in_child<double>([&](const auto& put) {
    const CollisionObjectd on(model_of(mesh));
    std::vector<CollisionObjectd> objects;
    for (const Mesh& other : others) objects.emplace_back(model_of(other));
    for (const auto& other : objects) put(static_cast<double>(contacts(on, other, kAllContacts)));
    for (const auto& other : objects) put(distance(on, other));
    volatile double kept = 0;
    const auto time = [&](const auto& ask) {
      const Spread spread = measured([&](std::size_t) {
        for (const auto& other : objects) kept = static_cast<double>(ask(on, other));
      });
      put(spread.median / static_cast<double>(count));
    };
    time(touches);
    time([](const auto& a, const auto& b) { return contacts(a, b, kAllContacts); });
    time(distance);
    (void)kept;
  });
  if (all.size() != 2 * count + 3) return std::nullopt;
  FclMeshes meshes;
  meshes.contacts.assign(all.begin(), all.begin() + static_cast<long>(count));
  meshes.distances.assign(all.begin() + static_cast<long>(count), all.end() - 3);
  meshes.touch_seconds = all[2 * count];
  meshes.contacts_seconds = all[2 * count + 1];
  meshes.distance_seconds = all[2 * count + 2];
  return meshes;
}

}  // namespace cde::cli

#else

namespace cde::cli {

std::optional<FclOnMesh> measure_fcl_mesh(const Mesh&, Shape, std::span<const float>) {
  return std::nullopt;
}
std::optional<FclMeshes> measure_fcl_meshes(const Mesh&, std::span<const Mesh>) {
  return std::nullopt;
}

}  // namespace cde::cli

#endif
