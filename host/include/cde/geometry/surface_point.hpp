// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <limits>

#include "cde/geometry/primitives.hpp"

namespace cde {

/// A point of a triangle, computed in binary64. NaN for a triangle without area.
struct SurfacePoint {
  /// Barycentric weights of the second and third corner.
  double u = std::numeric_limits<double>::quiet_NaN(), v = u;
  /// Unit vector, right-handed around the corners.
  Eigen::Vector3d normal = Eigen::Vector3d::Constant(u);
  std::int8_t side = 0;  ///< where a ray comes from: 1 front (against the normal), -1 back
};

[[nodiscard]] inline SurfacePoint surface_point(const Triangle& triangle,
                                                const Eigen::Vector3f& point,
                                                const Eigen::Vector3f& direction) {
  const Eigen::Vector3d a = triangle.v0.cast<double>(), ab = triangle.v1.cast<double>() - a,
                        ac = triangle.v2.cast<double>() - a, ap = point.cast<double>() - a;
  const Eigen::Vector3d n = ab.cross(ac);
  const double towards = n.dot(direction.cast<double>());
  return {.u = ap.cross(ac).dot(n) / n.squaredNorm(),
          .v = ab.cross(ap).dot(n) / n.squaredNorm(),
          .normal = n.normalized(),
          .side = static_cast<std::int8_t>(towards < 0   ? 1
                                           : towards > 0 ? -1
                                                         : 0)};
}

}  // namespace cde
