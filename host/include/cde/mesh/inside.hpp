// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "cde/mesh/mesh.hpp"

namespace cde {

/// Which points lie inside a closed mesh. Records cannot tell this: the triangles are a surface,
/// and a body wholly inside touches none of them.
///
/// The winding number decides, computed in binary64 (van Oosterom and Strackee 1983). It is the sum
/// of the solid angles of all triangles seen from the point, over 4 pi. Off the surface it is an
/// integer. On the surface either answer is possible. A point outside the bounding box is decided
/// at once.
class Inside {
 public:
  /// Error kBadInput, naming a triangle and an edge, if the mesh is not closed. Each edge must have
  /// as many triangles in one direction as in the other. Vertices with equal coordinates are one.
  explicit Inside(const Mesh& mesh);

  /// Winding number of a point in the mesh's frame. It is 0 outside. It is 1 inside a body whose
  /// faces wind counter-clockwise as seen from outside.
  [[nodiscard]] double winding_number(const Eigen::Vector3f& point) const;
  /// Whether the winding number is nearer to another whole number than to 0.
  [[nodiscard]] bool contains(const Eigen::Vector3f& point) const;

 private:
  std::vector<std::array<Eigen::Vector3d, 3>> triangles_;
  Eigen::AlignedBox3f box_;
};

}  // namespace cde
