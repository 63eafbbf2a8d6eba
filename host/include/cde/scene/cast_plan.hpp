// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "cde/bvh/bvh.hpp"
#include "cde/mesh/mesh.hpp"
#include "cde/scene/plan.hpp"

/// @file
/// Chooses the card for a cast of rays at a mesh: lanes, BVH or brute force, built or not. `cde
/// cast` uses these functions.
namespace cde {

/// Requirements of a cast. Empty values are chosen.
struct CastRequest {
  Mode mode = Mode::kNearest;
  Algorithm algorithm = kLeakFree;
  Arithmetic arithmetic = Arithmetic::kHost;
  FpFormat format = {};
  bool box = true;     ///< the box rule
  bool trace = false;  ///< waves are written
  Device device = default_device();
  std::optional<unsigned> lanes = {};
  std::optional<bool> bvh = {};  ///< true: must traverse a BVH; false: must not
  bool parts = false;            ///< the mesh is distributed among cards
  bool exact_card = false;       ///< an existing model may not stand in for one that must be built
};

/// To use it, open `card`, upload the mesh, with `*bvh` if there is one, and cast with the
/// Query of the request's mode:
///
///     Board board = Board::open(plan.card);
///     plan.bvh ? board.upload(mesh, *plan.bvh) : board.upload(mesh);
///     board.cast(rays, {.mode = request.mode}, take);
struct CastPlan {
  BoardConfig card = {};
  std::shared_ptr<const Bvh> bvh = {};          ///< of the mesh; null: brute force
  std::optional<BuiltCard> stands_in_for = {};  ///< the planned card that `card` replaces
  std::string warning = {};  ///< why a requested BVH could not be built; empty: none
};

/// Why rays cannot traverse a BVH with the same records; nothing if they can.
[[nodiscard]] std::optional<std::string> why_not_traversable(const CastRequest& request);

/// Whether rays at a mesh of this many triangles should traverse a BVH, before the number of rays
/// is known. Error kUsage if the request needs a BVH that is impossible, with the reason.
[[nodiscard]] bool may_traverse(const CastRequest& request, std::uint64_t triangles);

/// The card and BVH for this many rays. Building a BVH takes about a microsecond per triangle.
/// Error kUsage as for may_traverse. Error kCapacity and others of Bvh::build if the request
/// needs a BVH that cannot be built.
[[nodiscard]] CastPlan plan_cast(const CastRequest& request, const Mesh& mesh, std::uint64_t rays);

}  // namespace cde
