// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "cde/oracle/cases.hpp"

/// Cases of the convex pairs beyond the oracle's cases. They are aimed at configurations where the
/// distance is easy and the normal is hard.
namespace cde::testing {

enum class DirectedFamily {
  kCorners,  ///< vertex to vertex, small distance, normal within the cone of either
  kEdges,    ///< normal perpendicular to an edge of one or both, within 1e-9 to 1e-2
  kFaces,    ///< normal of a face, within 1e-9 to 1e-2; apart or penetrating
  kThin,     ///< smallest width of the triangle or box is 1e-8 to 1e-2 of its size
};
inline constexpr std::array kDirectedFamilies = {DirectedFamily::kCorners, DirectedFamily::kEdges,
                                                 DirectedFamily::kFaces, DirectedFamily::kThin};
[[nodiscard]] const char* to_string(DirectedFamily family);

/// The same case for the same arguments. The signed distance of the two supports along a chosen
/// normal is +-1e-7 to +-1e-1 of the scene, positive in three of four cases.
[[nodiscard]] oracle::Case directed_case(oracle::Pair pair, DirectedFamily family,
                                         std::uint64_t seed, std::uint64_t index);

}  // namespace cde::testing
