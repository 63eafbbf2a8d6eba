// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>
#include <cstddef>
#include <vector>

#include "cde/geometry/motion.hpp"
#include "cde/mesh/mesh.hpp"

namespace cde::cli {

/// Rays from the middle of a flight over the terrain, in random directions below the horizon.
/// Another `first` gives other rays.
inline std::vector<Ray> flight_rays(const Mesh& mesh, std::size_t count, std::size_t first = 0) {
  const Eigen::AlignedBox3f box = bounds(mesh);
  std::vector<Ray> rays(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d d = random_direction(2007, 5, first + i);
    rays[i].o = box.min() + box.sizes().cwiseProduct(Eigen::Vector3f(0.5f, 0.45f, 1.2f));
    rays[i].d = Eigen::Vector3d(d.x(), d.y(), -std::abs(d.z())).cast<float>();
  }
  return rays;
}

}  // namespace cde::cli
