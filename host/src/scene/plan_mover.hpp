// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cde/scene/plan.hpp"
#include "cde/scene/scene.hpp"

/// Who moves the objects of a scene, the host or the card's transformer. Private to the planner.
namespace cde::plan_mover {

struct Movers {
  std::vector<bool> secondaries, primaries;  ///< objects of the scene that the card moves, by role
  unsigned entries = 0;                      ///< of the secondaries' object table, the most in use
  /// Written in a frame for primaries that stay in the register file; none if they are loaded.
  std::optional<std::uint64_t> primary_words;
  std::vector<Effect> effects;
};

/// `resident`: all queries have the same secondaries. Errors kUsage if the scene asks for
/// mover = "card" and it cannot be.
[[nodiscard]] Movers choose(const Scene& scene, bool resident);

/// No primary is moved by the card, for a reason that overrides all others.
void leave_primaries(Movers& movers, const std::string& why);

/// Words written in a frame for an object among the secondaries that stay in DDR.
[[nodiscard]] std::uint64_t words_a_frame(const Scene& scene, const SceneObject& object,
                                          bool by_card);

}  // namespace cde::plan_mover
