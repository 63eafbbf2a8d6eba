// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "cde/mesh/mesh.hpp"

namespace cde {

/// Which points lie inside a closed mesh. Records of a mesh do not tell: its triangles are a
/// surface, and a body that is wholly inside of it is apart from each of them.
///
/// The winding number decides: the sum of the solid angles of all triangles as seen from the point,
/// over 4 pi (van Oosterom and Strackee 1983), in binary64. It is a whole number but on the surface
/// itself, where either answer may come. A point outside of the bounding box takes no time, another
/// some 20 ns per triangle.
class Inside {
 public:
  /// Error kBadInput, naming a triangle and an edge of it, if the mesh is not closed: each edge
  /// must have as many triangles one way round as the other. Vertices of equal coordinates are one.
  explicit Inside(const Mesh& mesh);

  /// The winding number of a point in the mesh's frame: 1 inside of a body whose faces wind
  /// counter-clockwise as seen from outside, 0 outside.
  [[nodiscard]] double winding_number(const Eigen::Vector3f& point) const;
  /// Whether the winding number is nearer to another whole number than to 0.
  [[nodiscard]] bool contains(const Eigen::Vector3f& point) const;

 private:
  std::vector<std::array<Eigen::Vector3d, 3>> triangles_;
  Eigen::AlignedBox3f box_;
};

}  // namespace cde
