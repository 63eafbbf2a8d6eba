// SPDX-License-Identifier: Apache-2.0
// Compiled without vectors.
#include "baselines/baseline_spheres.hpp"

namespace cde::cli {

std::uint64_t overlaps_scalar(const SphereArrays& spheres) {
  return overlaps(spheres);
}

}  // namespace cde::cli
