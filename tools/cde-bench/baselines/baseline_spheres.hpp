// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "baselines/software_baselines.hpp"

namespace cde::cli {

/// The loop of both kernels. They differ only in how it is compiled.
inline __attribute__((always_inline)) std::uint64_t overlaps(const SphereArrays& s) {
  std::uint64_t all = 0;
  for (std::size_t i = 0; i < s.count; ++i) {
    const float x = s.x[i], y = s.y[i], z = s.z[i], r = s.r[i];
    std::uint32_t some = 0;
    for (std::size_t j = 0; j < s.count; ++j) {
      const float dx = s.x[j] - x, dy = s.y[j] - y, dz = s.z[j] - z, sum = s.r[j] + r;
      some += dx * dx + dy * dy + dz * dz <= sum * sum ? 1 : 0;
    }
    all += some;
  }
  return all;
}

}  // namespace cde::cli
