// SPDX-License-Identifier: Apache-2.0
#include "scene/plan_card.hpp"

#include <algorithm>
#include <vector>

namespace cde::plan_card {
namespace {

bool has(const BoardConfig& card, Pair pair) {
  return std::find(card.pairs.begin(), card.pairs.end(), pair) != card.pairs.end();
}
bool has_all(const BoardConfig& card, const std::vector<Pair>& pairs) {
  return std::all_of(pairs.begin(), pairs.end(), [&](Pair p) { return has(card, p); });
}

double cost(const char* effect) {
  return simulation_cost(effect).value_or(1);
}

/// Cost of idle pipes beside a working one. The first idle pipe adds the operand registers.
double pipes_cost(std::size_t pipes) {
  constexpr double kFirst = 1.15;
  if (pipes <= 1) return 1;
  return kFirst + (cost("pipes") - kFirst) * static_cast<double>(pipes - 2) / (kPairs - 2);
}

/// Cost of simulating a row of the planned card. Without large pipes, the rest of the card costs as
/// much as 20 lanes.
double row_cost(const BoardConfig& planned, unsigned lanes) {
  const double around = std::any_of(planned.pairs.begin(), planned.pairs.end(), is_large) ? 1 : 20;
  return around + lanes;
}

double effects_cost(const BoardConfig& card) {
  return pipes_cost(card.pairs.size()) * (card.swap ? cost("exchange of roles") : 1) *
         (card.normals ? cost("normals") : 1) * (card.parallel ? cost("two pairs at a time") : 1) *
         (card.trace ? cost("trace") : 1);
}

}  // namespace

bool is_large(Pair pair) {
  switch (pair) {
    case Pair::kObbObb:
    case Pair::kTriangleAabb:
    case Pair::kTriangleObb:
    case Pair::kTriangleTriangle:
    case Pair::kTriangleCylinder:
    case Pair::kCylinderCylinder:
    case Pair::kObbCylinder:
      return true;
    default:
      return false;
  }
}

bool serves(const BoardConfig& card, const BoardConfig& planned, const SceneCard& asked) {
  const bool rays = has(planned, Pair::kRayTriangle);
  return has_all(card, planned.pairs) && (asked.pairs.empty() || has_all(planned, card.pairs)) &&
         (asked.lanes ? card.lanes == planned.lanes : card.lanes <= asked.device.lanes) &&
         card.arithmetic == planned.arithmetic && card.format == planned.format &&
         card.filter == planned.filter && (!rays || card.algorithm == planned.algorithm) &&
         std::all_of(planned.pairs.begin(), planned.pairs.end(),
                     [&](Pair p) { return card.box_rule(p) == planned.box_rule(p); }) &&
         (card.swap || !planned.swap) && (card.normals || !planned.normals) &&
         (card.trace || !planned.trace) && card.sat_interval == planned.sat_interval &&
         card.transform == planned.transform && card.objects >= planned.objects &&
         card.primary_objects >= planned.primary_objects && card.latency == planned.latency &&
         card.ddr_slots == planned.ddr_slots && card.sram_records == planned.sram_records &&
         card.bus == planned.bus && card.ecc == planned.ecc &&
         card.traversal_units == planned.traversal_units && card.nodes >= planned.nodes &&
         card.node_cycles == planned.node_cycles && card.node_cache == planned.node_cache &&
         card.node_ways == planned.node_ways && card.pinned_nodes == planned.pinned_nodes &&
         card.contexts == planned.contexts && card.shared_lane == planned.shared_lane &&
         card.ray_places == planned.ray_places;
}

double times(const BoardConfig& card, const BoardConfig& planned, const Rows& rows) {
  const double device =
      static_cast<double>(rows(card.lanes)) / static_cast<double>(rows(planned.lanes));
  const double row = row_cost(planned, card.lanes) / row_cost(planned, planned.lanes);
  return device * std::max(1.0, row * effects_cost(card) / effects_cost(planned));
}

}  // namespace cde::plan_card

namespace cde {

std::optional<BuiltCard> built_card(const BoardConfig& planned, const SceneCard& asked,
                                    const Rows& rows) {
  if (model_file(planned.top(), planned.parameters()).built) return std::nullopt;
  std::vector<BuiltCard> some;
  for (const std::vector<std::string>& parameters : built_models(planned.top())) {
    std::optional<BoardConfig> card = BoardConfig::of(parameters);
    if (!card) continue;
    card->bus = planned.bus;  // only the simulation model depends on it
    if (!plan_card::serves(*card, planned, asked)) continue;
    const double t = plan_card::times(*card, planned, rows);
    if (t <= plan_card::kMostTimes) some.push_back({*card, t});
  }
  // Equal cards keep the order of their parameters, so the choice does not depend on the folder.
  std::stable_sort(some.begin(), some.end(),
                   [](const BuiltCard& a, const BuiltCard& b) { return a.times < b.times; });
  for (const BuiltCard& card : some)
    if (model_file(card.board.top(), card.board.parameters()).built) return card;
  return std::nullopt;
}

}  // namespace cde
