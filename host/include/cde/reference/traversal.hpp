// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <concepts>
#include <cstdint>
#include <span>
#include <vector>

#include "cde/contract/pairs.hpp"
#include "cde/geometry/primitives.hpp"
#include "cde/hierarchy/hierarchy.hpp"
#include "cde/mesh/triangle_view.hpp"
#include "cde/query/query.hpp"

namespace cde::reference {

/// What rays, or solids, met on their way.
struct TraversalCounts {
  std::uint64_t nodes = 0;        ///< read
  std::uint64_t secondaries = 0;  ///< tested
  unsigned deepest = 0;           ///< groups on the stack at a time
};

/// Rays, spheres, OBBs and triangles through a hierarchy over triangles, by pairs with the box
/// rule, or rays and spheres through one over spheres: records are those of Sweep or Pass, with the
/// rule, every bit, ties included.
class Traversal {
 public:
  /// Both must outlive it; the algorithm is that of rays. Error kUsage if the hierarchy is of
  /// another number of triangles.
  Traversal(const TriangleView& triangles, const Hierarchy& hierarchy,
            Algorithm algorithm = Algorithm::kMoller);
  /// The same over spheres.
  Traversal(std::span<const Sphere> spheres, const Hierarchy& hierarchy);

  /// The record of a ray in modes nearest, farthest and any; in mode hits those of all its hits by
  /// ascending index. Error kUsage in mode all, whose records are those of all triangles.
  [[nodiscard]] std::vector<Record> trace(const Ray& ray, std::uint32_t number, Mode mode);
  /// Of solids mode nearest has the triangle of the least signed gap, whether they meet or not, and
  /// any and hits those that they meet. Error kUsage in mode farthest as well, and for an OBB or a
  /// triangle where spheres are in the tree.
  template <class Solid>
  requires std::same_as<Solid, Sphere> || std::same_as<Solid, Obb> || std::same_as<Solid, Triangle>
  [[nodiscard]] std::vector<Record> trace(const Solid& solid, std::uint32_t number, Mode mode) {
    return trace_any(solid, number, mode);
  }
  /// Whether it meets any triangle: ends at the first.
  [[nodiscard]] bool occluded(const Ray& ray);
  template <class Solid>
  requires std::same_as<Solid, Sphere> || std::same_as<Solid, Obb> || std::same_as<Solid, Triangle>
  [[nodiscard]] bool occluded(const Solid& solid) { return meets_any(solid); }

  [[nodiscard]] const TraversalCounts& counts() const { return counts_; }

 private:
  enum class Goal { kNearest, kFarthest, kHits, kAny, kOccluded };
  template <class P>
  class Walk;
  template <class P>  // of these four
  std::vector<Record> trace_any(const P& primary, std::uint32_t number, Mode mode);
  template <class P>
  bool meets_any(const P& primary);
  [[nodiscard]] Shape leaf() const { return spheres_.empty() ? Shape::kTriangle : Shape::kSphere; }
  TriangleView triangles_;  // or
  std::span<const Sphere> spheres_;
  const Hierarchy& hierarchy_;
  Algorithm algorithm_;
  TraversalCounts counts_;
};

}  // namespace cde::reference
