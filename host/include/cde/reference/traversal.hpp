// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <concepts>
#include <cstdint>
#include <span>
#include <string_view>
#include <variant>
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

/// A shape that has a signed gap to others, as a primary and in a hierarchy.
template <class P>
concept Solid = std::same_as<P, Sphere> || std::same_as<P, Aabb> || std::same_as<P, Obb> ||
    std::same_as<P, Triangle>;

/// Rays, spheres, AABBs, OBBs and triangles through a hierarchy over triangles, spheres, AABBs or
/// OBBs, by the pairs that way_through() says, with the box rule: records are those of Sweep or
/// Pass, with the rule, every bit, ties included.
class Traversal {
 public:
  /// Both must outlive it; the algorithm is that of rays. Error kUsage if the hierarchy is of
  /// another number of secondaries.
  Traversal(const TriangleView& triangles, const Hierarchy& hierarchy,
            Algorithm algorithm = Algorithm::kMoller);
  Traversal(std::span<const Sphere> spheres, const Hierarchy& hierarchy);
  Traversal(std::span<const Aabb> boxes, const Hierarchy& hierarchy);
  Traversal(std::span<const Obb> boxes, const Hierarchy& hierarchy);

  /// The record of a ray in modes nearest, farthest and any; in mode hits those of all its hits by
  /// ascending index. Error kUsage in mode all, whose records are those of all triangles.
  [[nodiscard]] std::vector<Record> trace(const Ray& ray, std::uint32_t number, Mode mode);
  /// Of solids mode nearest has the secondary of the least signed gap, whether they meet or not,
  /// and any and hits those that they meet. Error kUsage in mode farthest as well, and where the
  /// card has no such pair.
  template <Solid P>
  [[nodiscard]] std::vector<Record> trace(const P& solid, std::uint32_t number, Mode mode) {
    return trace_any(solid, number, mode);
  }
  /// Whether it meets any secondary: ends at the first.
  [[nodiscard]] bool occluded(const Ray& ray);
  template <Solid P>
  [[nodiscard]] bool occluded(const P& solid) {
    return meets_any(solid);
  }

  [[nodiscard]] const TraversalCounts& counts() const { return counts_; }

 private:
  enum class Goal { kNearest, kFarthest, kHits, kAny, kOccluded };
  template <class P>
  class Walk;
  using Secondaries = std::variant<TriangleView, std::span<const Sphere>, std::span<const Aabb>,
                                   std::span<const Obb>>;
  Traversal(Secondaries secondaries, std::size_t count, std::string_view shape,
            const Hierarchy& hierarchy, Algorithm algorithm);
  template <class P>  // of these five
  std::vector<Record> trace_any(const P& primary, std::uint32_t number, Mode mode);
  template <class P>
  bool meets_any(const P& primary);
  Secondaries secondaries_;
  const Hierarchy& hierarchy_;
  Algorithm algorithm_;
  TraversalCounts counts_;
};

}  // namespace cde::reference
