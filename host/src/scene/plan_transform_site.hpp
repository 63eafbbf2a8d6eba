// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cde/scene/plan.hpp"
#include "cde/scene/scene.hpp"

/// Whether the host or the card's transformer moves the objects of a scene. Private to the planner.
namespace cde::plan_transform_site {

struct TransformSites {
  std::vector<bool> secondaries, primaries;  ///< by object: whether the card moves it, in this role
  unsigned entries = 0;  ///< the most entries in use in the object table of the secondaries
  /// Words written per frame for primaries that stay in the register file; none if they are loaded.
  std::optional<std::uint64_t> primary_words;
  std::vector<Effect> effects;
};

/// `resident`: all queries have the same secondaries. Error kUsage if the scene asks for
/// `transform_site = "card"` and the card cannot move them.
[[nodiscard]] TransformSites choose(const Scene& scene, bool resident);

/// Makes the host move all primaries, for a reason that overrides all others.
void leave_primaries(TransformSites& sites, const std::string& why);

/// Words written per frame for an object among secondaries that stay in DDR.
[[nodiscard]] std::uint64_t words_per_frame(const Scene& scene, const SceneObject& object,
                                            bool by_card);

}  // namespace cde::plan_transform_site
