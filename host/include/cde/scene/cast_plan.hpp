// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "cde/hierarchy/hierarchy.hpp"
#include "cde/mesh/mesh.hpp"
#include "cde/scene/plan.hpp"

/// The card that a cast of rays at a mesh should have: lanes, BVH or brute force, built or not.
/// `cde cast` chooses by these functions.
namespace cde {

/// What a cast must have; what is empty is chosen.
struct CastRequest {
  Mode mode = Mode::kNearest;
  Algorithm algorithm = kLeakFree;
  Arithmetic arithmetic = Arithmetic::kHost;
  FpFormat format = {};
  bool box = true;     ///< the box rule
  bool trace = false;  ///< waves are written
  std::optional<unsigned> lanes = {};
  std::optional<bool> hierarchy = {};  ///< true: must traverse one; false: must not
  bool parts = false;                  ///< the mesh is shared out among cards
  bool exact_card = false;             ///< no built card may stand in for one that is not built
};

/// Open `card`, upload the mesh, with `*hierarchy` if there is one, and cast with the Query of the
/// request's mode:
///
///     Board board = Board::open(plan.card);
///     plan.hierarchy ? board.upload(mesh, *plan.hierarchy) : board.upload(mesh);
///     board.cast(rays, {.mode = request.mode}, take);
struct CastPlan {
  BoardConfig card = {};
  std::shared_ptr<const Hierarchy> hierarchy = {};  ///< of the mesh; null: brute force
  std::optional<BuiltCard> stands_in_for = {};      ///< the card that `card` is used instead of
  std::string warning = {};  ///< why a wanted hierarchy could not be built; empty: none
};

/// Why rays cannot traverse a hierarchy and keep their records; nothing if they can.
[[nodiscard]] std::optional<std::string> why_not_traversable(const CastRequest& request);

/// Whether rays at a mesh of so many triangles should traverse a hierarchy, before their number is
/// known. Error kUsage if the request needs one that cannot be, naming why.
[[nodiscard]] bool may_traverse(const CastRequest& request, std::uint64_t triangles);

/// The card and hierarchy for so many rays. Building a hierarchy takes about a microsecond per
/// triangle. Errors: kUsage as may_traverse; kCapacity and others of Hierarchy::build if the
/// request needs a hierarchy that cannot be built.
[[nodiscard]] CastPlan plan_cast(const CastRequest& request, const Mesh& mesh, std::uint64_t rays);

}  // namespace cde
