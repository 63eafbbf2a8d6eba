// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "cde/geometry/primitives.hpp"

/// Software baselines: brute-force Möller-Trumbore on one thread, as fast as this project can write
/// it. Unlike the reference they may contract, exit early and reorder operations. Their T therefore
/// equals the card's only within rounding.
namespace cde::baseline {

struct ClosestHit {
  float t = std::numeric_limits<float>::infinity();  ///< +inf without a hit
  std::uint32_t index = ~0u;                         ///< triangle; all ones without a hit
};

enum class Kind {
  kScalar,  ///< one pair at a time, until the first failed comparison; compiled without vectors
  kAvx2,    ///< 8 rays at a time
  kAvx512,  ///< 16 rays at a time
};

[[nodiscard]] const char* name_of(Kind kind);
[[nodiscard]] bool available(Kind kind);  ///< on this processor

/// The nearest hit of every ray, ties to the lowest index. Error kUsage if not available().
[[nodiscard]] std::vector<ClosestHit> closest(Kind kind, std::span<const Ray> rays,
                                              std::span<const Triangle> triangles);

}  // namespace cde::baseline
