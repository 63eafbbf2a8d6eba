// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>
#include <optional>

#include "cde/bvh/bvh.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/model/device.hpp"

/// Chooses between brute force and a BVH, for scenes and for casts. Private to the planners.
namespace cde::bvh_choice {

/// Cost of both methods, in the same unit.
struct Cost {
  double traversal, brute_force;
};

/// Fewest secondaries for which a BVH can win.
constexpr std::uint64_t fewest(Shape leaf) {
  return leaf == Shape::kTriangle ? 2048 : 256;
}

/// Whether primaries traverse a BVH over so many secondaries: if it is asked for, or if it can win.
/// Once the cost is known, the BVH must be cheaper.
inline bool traverses(bool asked, Shape leaf, std::uint64_t secondaries,
                      const std::optional<Cost>& cost = {}) {
  return asked || (secondaries >= fewest(leaf) && (!cost || cost->traversal < cost->brute_force));
}

/// Cycles of the traversal units per primary. They also test the secondaries. A narrow memory
/// delivers a triangle and the two words of its slot.
inline double cycles(const Device& device, double nodes, double secondaries) {
  constexpr unsigned kNarrowCycles = 2 * (9 + 2);
  return std::max(
      nodes * device.node_cycles / device.traversal_units,
      secondaries * std::max({1u, device.shared_lane, device.narrow_memory ? kNarrowCycles : 1u}));
}

/// Words of node memory for a BVH over so many secondaries.
inline unsigned node_memory(const Bvh& bvh, std::uint64_t secondaries) {
  return static_cast<unsigned>(
      std::max<std::uint64_t>({BoardConfig{}.nodes, std::bit_ceil(bvh.nodes().size()),
                               std::bit_ceil((secondaries + 7) / 8)}));
}

}  // namespace cde::bvh_choice
