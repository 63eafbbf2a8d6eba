// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cde/scene/scene.hpp"

/// The geometry that a report shows: its position in each frame, in world coordinates.
namespace cde::cli {

/// Triangles with shared corners.
struct Surface {
  std::vector<Eigen::Vector3f> points;
  std::vector<std::uint32_t> corners;  ///< three per triangle
};

/// The surface of the triangles. Corners with equal coordinates become one point.
[[nodiscard]] Surface welded(const std::vector<Triangle>& triangles);

/// The surface with at most about `most` triangles. The points in a cell of a cubic grid become
/// their mean, and triangles that lose a corner are removed. A surface with no more than `most`
/// triangles stays unchanged.
[[nodiscard]] Surface simplified(const Surface& surface, std::size_t most);

/// One object in a frame, as the page shows it.
struct ShownObject {
  std::vector<Placement> placements;    ///< of solids and planes, one per shape
  std::optional<Transform> pose;        ///< of a rigid surface
  std::vector<Eigen::Vector3f> points;  ///< points of a deforming surface, in world coordinates
  std::vector<Ray> rays;                ///< of rays
};

/// A record with F = 1 that the page shows.
struct ShownHit {
  std::uint32_t primary = 0, index = 0;
  float t = 0;
  Eigen::Vector3f cp, n;  ///< n is zero without normals
};

/// The scene's objects, simplified for the page.
class SceneGeometry {
 public:
  explicit SceneGeometry(const Scene& scene);

  struct Object {
    std::string name;
    Shape shape = Shape::kTriangle;
    Drawn drawn = Drawn::kSurface;
    std::size_t count = 0;   ///< shapes
    std::size_t stride = 1;  ///< every stride-th shape is shown
    bool still = false;      ///< the same in every frame
    bool deforms = false;    ///< its points change from frame to frame
    Surface surface;         ///< triangles in object coordinates, as in the first shown frame
  };
  [[nodiscard]] const std::vector<Object>& objects() const { return objects_; }
  /// Sentences about differences between the page and the simulation.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

  [[nodiscard]] ShownObject show(std::size_t object, std::uint32_t frame) const;

 private:
  void add_surface(Object& object, const SceneObject& source);
  const Scene& scene_;
  std::size_t most_triangles_ = 0;  ///< per object
  std::vector<Object> objects_;
  std::vector<std::string> notes_;
};

}  // namespace cde::cli
