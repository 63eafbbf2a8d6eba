// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "cde/contract/pairs.hpp"
#include "cde/contract/records.hpp"
#include "cde/geometry/primitives.hpp"

namespace cde::reference {

/// A packet of rays by component, for vectorisation. Private to the reference.
struct RayBlock {
  static constexpr std::size_t kRays = card::kMostPrimaries;
  alignas(64) std::array<float, kRays> ox{}, oy{}, oz{}, dx{}, dy{}, dz{};
  /// For watertight: the dominant axis of d, and the shear along it.
  alignas(64) std::array<std::uint32_t, kRays> axis{};
  alignas(64) std::array<float, kRays> sx{}, sy{};
  unsigned count = 0;  ///< rays in use, rounded up to whole vectors; the extra rays are zero

  void set(std::size_t place, const Ray& ray);
};

/// Sets one byte per ray that passes the triangle's inside test, and returns whether any ray does.
/// Does not check the interval or bad inputs.
using InsideTest = bool (*)(const RayBlock& rays, const Triangle& triangle,
                            std::array<std::uint8_t, RayBlock::kRays>& mask);
/// The test for moller or watertight; null for other algorithms.
[[nodiscard]] InsideTest inside_test(Algorithm algorithm);

}  // namespace cde::reference
