// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/scene/plan.hpp"

/// Which built cards can do a scene's work, and their cost relative to the planned card.
namespace cde::plan_card {

/// Whether the pipe tests candidate axes (SAT) or is an iterative pipeline. Each of its lanes takes
/// as long to simulate and to build as tens of other lanes.
[[nodiscard]] bool is_large(Pair pair);

/// Gates take minutes to build, so a card of gates gets no more lanes by default.
inline constexpr unsigned kMostLanesOfGates = 8;

/// A card that takes more times as long as this is not worth using: building the planned one is.
inline constexpr double kMostTimes = 1.3;

/// Whether a card gives the records of the planned one and, apart from lanes, the same cycles.
/// Settings of the scene's [card] must be kept.
[[nodiscard]] bool serves(const BoardConfig& card, const BoardConfig& planned,
                          const SceneCard& asked);

/// Estimates how many times as long a frame takes as on the planned card: by simulation or by the
/// card's cycles, whichever is more.
[[nodiscard]] double times(const BoardConfig& card, const BoardConfig& planned, const Rows& rows);

}  // namespace cde::plan_card
