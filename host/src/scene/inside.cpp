// SPDX-License-Identifier: Apache-2.0
#include "cde/scene/inside.hpp"

#include <fmt/format.h>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"

namespace cde {
namespace {

/// An object's triangles in a frame, in its own frame of reference.
Mesh local_mesh(const Scene& scene, const SceneObject& object, std::uint32_t frame) {
  Mesh mesh;
  mesh.name = fmt::format("object '{}'", object.name);
  const Shapes shapes = local_shapes(scene, object, frame);
  const auto& triangles = std::get<std::vector<Triangle>>(shapes);
  mesh.vertices.reserve(3 * triangles.size());
  mesh.faces.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Eigen::Vector3f& corner : {t.v0, t.v1, t.v2}) mesh.vertices.push_back(corner);
    mesh.faces.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

}  // namespace

SceneInside::SceneInside(const Scene& scene, const SceneQuery& query)
    : scene_(&scene), query_(&query) {
  for (const std::size_t number : query.secondaries) {
    const SceneObject& object = scene.objects[number];
    if (has_member_poses(object))
      throw Error(ErrorCode::kBadInput,
                  fmt::format("object '{}' has triangles that move one by one; expected a closed "
                              "mesh",
                              printable_name(object.name)));
    bodies_.push_back({number, Inside(local_mesh(scene, object, 0)), object.deform.has_value()});
  }
}

std::vector<Eigen::Vector3f> SceneInside::middles(std::uint32_t frame) const {
  std::vector<Eigen::Vector3f> all;
  for (const std::size_t number : query_->primaries) {
    const SceneObject& object = scene_->objects[number];
    const Shapes local = local_shapes(*scene_, object, frame);
    const Shapes shapes = has_member_poses(object)
                              ? posed(local, member_poses(*scene_, object, frame))
                              : posed(local, pose(*scene_, object, frame));
    std::visit(
        [&](const auto& list) {
          for (const auto& shape : list) all.push_back(shape.middle());
        },
        shapes);
  }
  return all;
}

const std::vector<bool>& SceneInside::of(std::uint32_t frame) {
  if (frame_ == frame) return inside_;
  const std::vector<Eigen::Vector3f> points = middles(frame);
  frame_.reset();
  inside_.assign(points.size(), false);
  for (Body& body : bodies_) {
    const SceneObject& object = scene_->objects[body.object];
    if (body.deforms) body.inside = Inside(local_mesh(*scene_, object, frame));
    const Transform to_world = pose(*scene_, object, frame);
    const Eigen::Matrix3d back = to_world.rotation.cast<double>().transpose();
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (inside_[i]) continue;
      const Eigen::Vector3d moved = points[i].cast<double>() - to_world.translation.cast<double>();
      inside_[i] = body.inside.contains((back * moved).cast<float>());
    }
  }
  frame_ = frame;
  return inside_;
}

}  // namespace cde
