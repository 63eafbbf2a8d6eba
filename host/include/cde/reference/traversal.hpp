// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "cde/contract/pairs.hpp"
#include "cde/geometry/primitives.hpp"
#include "cde/hierarchy/hierarchy.hpp"
#include "cde/mesh/triangle_view.hpp"
#include "cde/query/query.hpp"

namespace cde::reference {

/// What rays met on their way.
struct TraversalCounts {
  std::uint64_t nodes = 0;      ///< read
  std::uint64_t triangles = 0;  ///< tested
  unsigned deepest = 0;         ///< groups on the stack at a time
};

/// Rays through a hierarchy, by an algorithm with the box rule: records are those of Sweep with
/// both, every bit, ties included.
class Traversal {
 public:
  /// Both must outlive it. Error kUsage if the hierarchy is of another number of triangles.
  Traversal(const TriangleView& triangles, const Hierarchy& hierarchy,
            Algorithm algorithm = Algorithm::kMoller);

  /// The record of a ray in modes nearest, farthest and any; in mode hits those of all its hits by
  /// ascending index. Error kUsage in mode all, whose records are those of all triangles.
  [[nodiscard]] std::vector<Record> trace(const Ray& ray, std::uint32_t number, Mode mode);
  /// Whether the ray meets any triangle: ends at the first.
  [[nodiscard]] bool occluded(const Ray& ray);

  [[nodiscard]] const TraversalCounts& counts() const { return counts_; }

 private:
  class Walk;
  TriangleView triangles_;
  const Hierarchy& hierarchy_;
  Algorithm algorithm_;
  TraversalCounts counts_;
};

}  // namespace cde::reference
