// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "cde/oracle/cases.hpp"

/// Cases of the convex pairs beyond those of the oracle, aimed at where a normal is hard to get
/// right although the distance is easy.
namespace cde::testing {

enum class DirectedFamily {
  kCorners,  ///< vertex to vertex, small distance, normal within the cone of either
  kEdges,    ///< normal perpendicular to an edge of one or both, but for 1e-9 to 1e-2
  kFaces,    ///< normal that of a face, but for 1e-9 to 1e-2; apart or penetrating
  kThin,     ///< the triangle's, or box's, smallest width is 1e-8 to 1e-2 of it
};
inline constexpr std::array kDirectedFamilies = {DirectedFamily::kCorners, DirectedFamily::kEdges,
                                                 DirectedFamily::kFaces, DirectedFamily::kThin};
[[nodiscard]] const char* to_string(DirectedFamily family);

/// The same for the same arguments. The gap of the two supports along a chosen normal is +-1e-7 to
/// +-1e-1 of the scene, positive in three of four.
[[nodiscard]] oracle::Case directed_case(oracle::Pair pair, DirectedFamily family,
                                         std::uint64_t seed, std::uint64_t index);

}  // namespace cde::testing
