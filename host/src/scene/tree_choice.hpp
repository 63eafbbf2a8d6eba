// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>
#include <optional>

#include "cde/bitstream/bitstream.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/hierarchy/hierarchy.hpp"

/// The choice between brute force and a BVH, for scenes and for casts. Private to the planners.
namespace cde::tree_choice {

constexpr unsigned kNodeUnits = 2;
/// Lanes of a card all of whose primaries traverse: more would stand idle.
constexpr unsigned kLanes = 4;

/// What primaries take each way, in one unit.
struct Cost {
  double traversal, brute_force;
};

/// Fewest secondaries for which a BVH can win.
constexpr std::uint64_t fewest(Shape leaf) {
  return leaf == Shape::kTriangle ? 2048 : 256;
}

/// Whether primaries traverse a tree over so many secondaries: where it is asked for, or where it
/// can win and, once the cost is known, does.
inline bool traverses(bool asked, Shape leaf, std::uint64_t secondaries,
                      const std::optional<Cost>& cost = {}) {
  return asked || (secondaries >= fewest(leaf) && (!cost || cost->traversal < cost->brute_force));
}

/// Cycles that one primary takes of the traversal units, which also test the secondaries.
inline double cycles(double nodes, double secondaries) {
  return std::max(nodes / kNodeUnits, secondaries);
}

/// Words of node memory for a tree over so many secondaries.
inline unsigned node_memory(const Hierarchy& tree, std::uint64_t secondaries) {
  return static_cast<unsigned>(
      std::max<std::uint64_t>({BoardConfig{}.nodes, std::bit_ceil(tree.nodes().size()),
                               std::bit_ceil((secondaries + 7) / 8)}));
}

}  // namespace cde::tree_choice
