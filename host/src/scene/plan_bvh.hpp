// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "cde/scene/plan.hpp"
#include "cde/scene/scene.hpp"

/// Whether queries of a scene traverse a BVH of their secondaries. Private to the planner.
namespace cde::plan_bvh {

struct Choice {
  std::vector<bool> queries;  ///< by query: whether it traverses
  unsigned nodes = 0;         ///< words of node memory that the card needs; 0 without a BVH
  Effect effect;
};

/// Decides for the card as planned so far, including which secondaries the card moves
/// (Plan::card_moves). Sets QueryWork::bvh_cycles of the queries that could traverse. Error
/// kUsage if the scene asks for a BVH and no query can use one.
[[nodiscard]] Choice choose(const Scene& scene, Plan& plan);

}  // namespace cde::plan_bvh
