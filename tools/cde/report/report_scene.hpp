// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cde/scene/scene.hpp"

/// What a report shows of a scene: geometry as it lay in the frames, in the world's frame.
namespace cde::cli {

/// Triangles with shared corners.
struct Surface {
  std::vector<Eigen::Vector3f> points;
  std::vector<std::uint32_t> corners;  ///< three a triangle
};

/// Corners of the triangles, those with the same coordinates as one point.
[[nodiscard]] Surface welded(const std::vector<Triangle>& triangles);

/// The same with at most about `most` triangles: points in a cell of a cubic grid become their
/// mean, and triangles that lose a corner go. Unchanged if there are no more than `most`.
[[nodiscard]] Surface simplified(const Surface& surface, std::size_t most);

/// One object of a frame as the page has it.
struct ShownObject {
  std::vector<Placement> placements;    ///< of solids and planes, one a shape
  std::optional<Transform> pose;        ///< of a surface that moves as a whole
  std::vector<Eigen::Vector3f> points;  ///< of a surface that deforms; its points, posed
  std::vector<Ray> rays;                ///< of rays
};

/// A record with F = 1 that the page shows.
struct ShownHit {
  std::uint32_t primary = 0, index = 0;
  float t = 0;
  Eigen::Vector3f cp, n;  ///< n zero without normals
};

/// The scene's objects, and what of them is left out of the page.
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
    bool deforms = false;    ///< points differ from frame to frame
    Surface surface;         ///< of triangles, the object's frame, as in the first frame shown
  };
  [[nodiscard]] const std::vector<Object>& objects() const { return objects_; }
  /// Sentences about what is shown otherwise than it was simulated.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

  [[nodiscard]] ShownObject show(std::size_t object, std::uint32_t frame) const;

 private:
  void add_surface(Object& object, const SceneObject& source);
  const Scene& scene_;
  std::size_t most_triangles_ = 0;  ///< of one object
  std::vector<Object> objects_;
  std::vector<std::string> notes_;
};

}  // namespace cde::cli
