// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/scene/plan.hpp"

/// Which cards do a scene's work, and what they cost beside the planned one.
namespace cde::plan_card {

/// Pipes of facets or rings: a lane takes as long to simulate, and to build, as tens of others'.
[[nodiscard]] bool is_large(Pair pair);

/// More than this many times the planned card's time is not worth what its building takes.
inline constexpr double kMostTimes = 1.3;

/// Whether a card gives the records and, lanes apart, the clocks of the planned one. What the
/// scene's [card] asks for is kept as it is.
[[nodiscard]] bool serves(const BoardConfig& card, const BoardConfig& planned,
                          const SceneCard& asked);

/// How many times as long a frame takes as on the planned card, estimated from what was measured:
/// by the simulation or by the device's clocks, whichever is more.
[[nodiscard]] double times(const BoardConfig& card, const BoardConfig& planned, const Rows& rows);

}  // namespace cde::plan_card
