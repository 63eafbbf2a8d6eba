// SPDX-License-Identifier: Apache-2.0
#include "report/report_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>

#include "page/page.hpp"

namespace cde::cli {
namespace {

constexpr std::size_t kMostTriangles =
    120'000;  // for all objects in the page; one object gets at most half of them
constexpr std::size_t kMostShapes = 4'096;  // per object of rays or solids

/// Sorted, since a file could make points collide under a hash.
using PointNumbers = std::map<std::array<std::uint32_t, 3>, std::uint32_t>;

Drawn drawn_as(Shape shape) {
  return with_shape<float>(shape, []<class P>() { return P::kDrawn; });
}

std::vector<Triangle> triangles_of(const Shapes& shapes) {
  std::vector<Triangle> all;
  all.reserve(size(shapes));
  std::visit(
      [&all](const auto& list) {
        for (const auto& shape : list)
          if constexpr (requires { shape.triangles(); })
            for (const Triangle& t : shape.triangles()) all.push_back(t);
      },
      shapes);
  return all;
}

Shapes in_frame(const Scene& scene, const SceneObject& object, std::uint32_t frame) {
  const Shapes local = local_shapes(scene, object, frame);
  return has_member_poses(object) ? posed(local, member_poses(scene, object, frame))
                                  : posed(local, pose(scene, object, frame));
}

/// The triangles as a surface, without shared corners.
Surface soup(const std::vector<Triangle>& triangles) {
  Surface surface;
  for (const Triangle& t : triangles) {
    for (const auto* p : {&t.v0, &t.v1, &t.v2}) {
      surface.corners.push_back(static_cast<std::uint32_t>(surface.points.size()));
      surface.points.push_back(*p);
    }
  }
  return surface;
}

Surface surface_of(const Mesh& mesh) {
  Surface surface{mesh.vertices, {}};
  for (const auto& face : mesh.faces)
    surface.corners.insert(surface.corners.end(), face.begin(), face.end());
  return surface;
}

/// The surface after clustering its points in grid cells of this size.
Surface clustered(const Surface& surface, const Eigen::Vector3f& origin, float cell) {
  PointNumbers cells;
  Surface coarse;
  std::vector<std::uint32_t> number(surface.points.size()), members;
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    std::array<std::uint32_t, 3> key{};
    for (int k = 0; k < 3; ++k)
      key[k] = static_cast<std::uint32_t>((surface.points[i][k] - origin[k]) / cell);
    const auto [at, fresh] = cells.try_emplace(key, static_cast<std::uint32_t>(members.size()));
    if (fresh) coarse.points.emplace_back(0, 0, 0), members.push_back(0);
    number[i] = at->second;
    coarse.points[number[i]] += surface.points[i];
    ++members[number[i]];
  }
  for (std::size_t i = 0; i < members.size(); ++i)
    coarse.points[i] /= static_cast<float>(members[i]);
  for (std::size_t i = 0; i < surface.corners.size(); i += 3) {
    const std::uint32_t a = number[surface.corners[i]], b = number[surface.corners[i + 1]],
                        c = number[surface.corners[i + 2]];
    if (a != b && b != c && c != a) coarse.corners.insert(coarse.corners.end(), {a, b, c});
  }
  return coarse;
}

}  // namespace

Surface welded(const std::vector<Triangle>& triangles) {
  PointNumbers numbers;
  Surface surface;
  for (const Triangle& t : triangles) {
    for (const auto* p : {&t.v0, &t.v1, &t.v2}) {
      const std::array<std::uint32_t, 3> key = {std::bit_cast<std::uint32_t>(p->x()),
                                                std::bit_cast<std::uint32_t>(p->y()),
                                                std::bit_cast<std::uint32_t>(p->z())};
      const auto [at, fresh] =
          numbers.try_emplace(key, static_cast<std::uint32_t>(surface.points.size()));
      if (fresh) surface.points.push_back(*p);
      surface.corners.push_back(at->second);
    }
  }
  return surface;
}

Surface simplified(const Surface& surface, std::size_t most) {
  if (surface.corners.size() <= 3 * most) return surface;
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : surface.points) box.extend(p);
  const float extent = box.sizes().maxCoeff();
  // Begins with about as many cells as the triangles of a surface would fill, then takes fewer
  // until the result is small enough.
  auto cells = static_cast<float>(std::sqrt(static_cast<double>(most)));
  Surface coarse;
  do {
    coarse = clustered(surface, box.min(), extent / cells);
    cells *= 0.9f;
  } while (coarse.corners.size() > 3 * most && cells > 2);
  return coarse;
}

SceneGeometry::SceneGeometry(const Scene& scene) : scene_(scene) {
  const auto surfaces = std::count_if(
      scene.objects.begin(), scene.objects.end(),
      [](const SceneObject& o) { return drawn_as(shape_of(o.shapes)) == Drawn::kSurface; });
  most_triangles_ =
      kMostTriangles / static_cast<std::size_t>(std::max<std::ptrdiff_t>(surfaces, 2));
  for (const SceneObject& source : scene.objects) {
    Object object;
    object.name = source.name;
    object.shape = shape_of(source.shapes);
    object.drawn = drawn_as(object.shape);
    object.count = size(source.shapes);
    object.still = is_still(scene, source);
    if (object.drawn == Drawn::kSurface) {
      add_surface(object, source);
    } else {
      object.still = object.still && deforming(source).empty();
      object.stride = (object.count + kMostShapes - 1) / kMostShapes;
      if (object.stride > 1)
        notes_.push_back(fmt::format("“{1}” has {0} shapes; every {2}th is drawn.",
                                     grouped(object.count), object.name, object.stride));
    }
    objects_.push_back(std::move(object));
  }
}

void SceneGeometry::add_surface(Object& object, const SceneObject& source) {
  const std::vector<Triangle> triangles = triangles_of(source.shapes);
  object.deforms = has_member_poses(source) || source.deform.has_value();
  const bool fits = triangles.size() <= most_triangles_;
  if (has_member_poses(source))
    object.surface = soup(triangles);
  else
    object.surface = source.mesh ? surface_of(*source.mesh) : welded(triangles);
  if (fits) return;
  object.surface = simplified(object.surface, most_triangles_);
  notes_.push_back(fmt::format(
      "“{}” has {} triangles; it is drawn with {} (corners in one grid cell are merged). The card "
      "tested all of them.",
      object.name, grouped(triangles.size()), grouped(object.surface.corners.size() / 3)));
  if (object.deforms) {
    object.deforms = false;
    notes_.push_back(fmt::format("“{}” deforms; it is drawn as it is in its file.", object.name));
  }
}

ShownObject SceneGeometry::show(std::size_t number, std::uint32_t frame) const {
  const Object& object = objects_[number];
  const SceneObject& source = scene_.objects[number];
  ShownObject shown;
  if (object.drawn == Drawn::kSurface && !object.deforms) {
    shown.pose = pose(scene_, source, frame);
    return shown;
  }
  const Shapes shapes = in_frame(scene_, source, frame);
  if (object.drawn == Drawn::kSurface) {
    const std::vector<Triangle> triangles = triangles_of(shapes);
    shown.points.assign(object.surface.points.size(), Eigen::Vector3f::Zero());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const std::uint32_t* corner = &object.surface.corners[3 * i];
      shown.points[corner[0]] = triangles[i].v0;
      shown.points[corner[1]] = triangles[i].v1;
      shown.points[corner[2]] = triangles[i].v2;
    }
    return shown;
  }
  std::visit(
      [&](const auto& list) {
        for (std::size_t i = 0; i < list.size(); i += object.stride) {
          if constexpr (requires { list[i].placed(); })
            shown.placements.push_back(list[i].placed());
          else if constexpr (std::is_same_v<decltype(list), const std::vector<Ray>&>)
            shown.rays.push_back(list[i]);
        }
      },
      shapes);
  return shown;
}

}  // namespace cde::cli
