// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "cde/scene/plan.hpp"
#include "cde/scene/scene.hpp"

/// Whether rays and solids of a scene go through a hierarchy of its triangles. Private to the
/// planner.
namespace cde::plan_hierarchy {

struct Choice {
  std::vector<bool> queries;  ///< which of them
  unsigned nodes = 0;         ///< words of node memory that the card needs; 0: none do
  Effect effect;
};

/// For the card as it is planned so far, with who moves secondaries (Plan::card_moves). Sets
/// QueryWork::hierarchy_clocks of the queries that could. Error kUsage if the scene asks for one,
/// and no query can have it.
[[nodiscard]] Choice choose(const Scene& scene, Plan& plan);

}  // namespace cde::plan_hierarchy
