// SPDX-License-Identifier: Apache-2.0
// Compiled for AVX2, eight spheres at a time.
#include "baselines/baseline_spheres.hpp"

namespace cde::cli {

std::uint64_t overlaps_avx2(const SphereArrays& spheres) {
  return overlaps(spheres);
}

}  // namespace cde::cli
