// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <concepts>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "cde/bvh/bvh.hpp"
#include "cde/contract/pairs.hpp"
#include "cde/geometry/primitives.hpp"
#include "cde/image/ray_view.hpp"
#include "cde/mesh/triangle_view.hpp"
#include "cde/query/query.hpp"

namespace cde::reference {

/// Work of traversals.
struct TraversalCounts {
  std::uint64_t nodes = 0;        ///< nodes read
  std::uint64_t secondaries = 0;  ///< secondaries tested
  unsigned deepest = 0;           ///< most groups on the stack at a time
};

/// A shape with a signed distance to others, as a primary and in a BVH.
template <class P>
concept Solid = std::same_as<P, Sphere> || std::same_as<P, Aabb> || std::same_as<P, Obb> ||
    std::same_as<P, Triangle>;

/// Traverses a BVH over triangles, spheres, AABBs or OBBs with rays, spheres, AABBs, OBBs and
/// triangles, for the pairs of traversal_shapes(), with the box rule. Results are bit-identical to
/// the results of BruteForce or Pass with that rule, ties included.
class Traversal {
 public:
  /// Both arguments must outlive the object. The algorithm is for rays. Error kUsage if the BVH has
  /// another number of secondaries.
  Traversal(const TriangleView& triangles, const Bvh& bvh,
            Algorithm algorithm = Algorithm::kMoller);
  Traversal(std::span<const Sphere> spheres, const Bvh& bvh);
  Traversal(std::span<const Aabb> boxes, const Bvh& bvh);
  Traversal(std::span<const Obb> boxes, const Bvh& bvh);

  /// The record of a ray in modes nearest, farthest and any; in mode hits the records of all its
  /// hits by ascending index. Error kUsage in mode all, whose records cover all triangles.
  [[nodiscard]] std::vector<Record> trace(const Ray& ray, std::uint32_t number, Mode mode);
  /// For solids, mode nearest returns the secondary of the least signed distance, hit or not. Modes
  /// any and hits return hits. Error kUsage also in mode farthest, and for a pair that a card
  /// cannot traverse.
  template <Solid P>
  [[nodiscard]] std::vector<Record> trace(const P& solid, std::uint32_t number, Mode mode) {
    return trace_any(solid, number, mode);
  }
  /// Whether it hits any secondary; stops at the first hit.
  [[nodiscard]] bool occluded(const Ray& ray);
  template <Solid P>
  [[nodiscard]] bool occluded(const P& solid) {
    return meets_any(solid);
  }

  [[nodiscard]] const TraversalCounts& counts() const { return counts_; }

 private:
  enum class Goal { kNearest, kFarthest, kHits, kAny, kOccluded };
  template <class P>
  class Trace;
  using Secondaries = std::variant<TriangleView, std::span<const Sphere>, std::span<const Aabb>,
                                   std::span<const Obb>>;
  Traversal(Secondaries secondaries, std::size_t count, std::string_view shape, const Bvh& bvh,
            Algorithm algorithm);
  template <class P>  // of these five
  std::vector<Record> trace_any(const P& primary, std::uint32_t number, Mode mode);
  template <class P>
  bool meets_any(const P& primary);
  Secondaries secondaries_;
  const Bvh& bvh_;
  Algorithm algorithm_;
  TraversalCounts counts_;
};

/// What trace_rays() is asked, beside the rays.
struct TraceRaysOptions {
  Mode mode = Mode::kNearest;  ///< nearest, farthest, any or occluded: one record per ray
  Algorithm algorithm = kLeakFree;
  unsigned threads = 0;  ///< 0: one per processor
  /// Called by the calling thread about ten times per second. The trace ends early, with some
  /// records unwritten, if it returns true.
  std::function<bool()> stop = {};
};

/// Traces rays through a BVH on several threads. Record i is of ray i, the same for any number of
/// threads. Returns whether all rays were traced. Error kUsage in a mode with another number of
/// records, for fewer or more records than rays, or if the BVH has another number of secondaries.
bool trace_rays(const TriangleView& triangles, const Bvh& bvh, const RayView& rays,
                std::span<Record> records, const TraceRaysOptions& options = {});

}  // namespace cde::reference
