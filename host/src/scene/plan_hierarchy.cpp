// SPDX-License-Identifier: Apache-2.0
#include "scene/plan_hierarchy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "scene/player_objects.hpp"

namespace cde::plan_hierarchy {
namespace {

/// From so many triangles on a tree wins.
constexpr std::uint64_t kWorthATree = 2048;
/// Clocks that the last rays of a packet take for a level of the tree, when no others are left.
constexpr double kClocksALevel = 30;
/// Visits that a ray makes in vain for each thing that has moved anywhere among the others (8, 40
/// and 200 of them: 0, 5.6 and 34 nodes more than in a tree that is built anew, which
/// cde_numerics_tests prints: HierarchyOfObjects).
constexpr double kVisitsAMovingPart = 1.0 / 6;

/// Why the query meets all secondaries; nothing if it need not.
std::optional<std::string> against(const SceneQuery& q, const Plan& plan) {
  if (q.pair != Pair::kRayTriangle) return "it is of rays with triangles";
  if (q.swap) return "its primaries are triangles";
  if (q.mode == Mode::kAll) return "mode all has records of all secondaries, hit or not";
  if (q.normals) return "rays have no normals";
  if (!plan.resident) return "queries have different secondaries, and each would need another tree";
  return std::nullopt;
}

/// Why the card cannot have one; nothing if it can.
std::optional<std::string> against(BoardConfig board, unsigned nodes) {
  board.node_units = kNodeUnits;
  board.nodes = nodes;
  try {
    (void)board.parameters();
  } catch (const Error& e) {
    return e.what();
  }
  return std::nullopt;
}

/// The tree that the player builds in the first frame; nothing, and why, if there is none.
std::optional<Hierarchy> tree_of(const Scene& scene, const Plan& plan, std::string& why) {
  player::Row row(scene, plan.card_moves, player::Table::kAll);
  (void)row.show(scene.queries.front().secondaries, 0);
  try {
    return player::tree_of(row);
  } catch (const Error& e) {
    why = e.what();
    return std::nullopt;
  }
}

/// Things that move by themselves, and so away from those that they are beside in the tree.
std::uint64_t moving_parts(const Scene& scene) {
  std::uint64_t sum = 0;
  for (const std::size_t i : scene.queries.front().secondaries) {
    const SceneObject& object = scene.objects[i];
    if (!is_still(scene, object)) sum += has_member_poses(object) ? size(object.shapes) : 1;
  }
  return sum;
}

/// Clocks of a frame of packets: what is read and tested by as many as there are, and the way of
/// the last ones. The tree stays as it was in the first frame.
std::uint64_t clocks(const QueryWork& w, const Scene& scene, const Hierarchy& tree) {
  const Hierarchy::Visits visits = tree.expected_visits();
  const double more = kVisitsAMovingPart * static_cast<double>(moving_parts(scene));
  const double a_ray = std::max((visits.nodes + more) / kNodeUnits, visits.secondaries + more);
  return static_cast<std::uint64_t>(
      std::ceil(a_ray * static_cast<double>(w.primaries - w.masked) +
                kClocksALevel * tree.depth() * static_cast<double>(w.packets)));
}

/// Clocks of boxes anew in a frame: one a secondary that moves, and 1.2 a node above it.
std::uint64_t refit_clocks(const QueryWork& w, const Scene& scene, const Plan& plan,
                           const Hierarchy& tree) {
  std::uint64_t moving = 0;
  for (const std::size_t i : scene.queries.front().secondaries)
    if (!is_still(scene, scene.objects[i]) || !deforming(scene.objects[i]).empty())
      moving += size(scene.objects[i].shapes);
  if (moving == 0) return 0;
  const bool parts =
      std::find(plan.card_moves.begin(), plan.card_moves.end(), true) != plan.card_moves.end();
  const double share =
      parts ? static_cast<double>(moving) / static_cast<double>(w.secondaries) : 1.0;
  return static_cast<std::uint64_t>(
      std::ceil(share * (static_cast<double>(w.secondaries) +
                         1.2 * static_cast<double>(tree.nodes().size()))));
}

}  // namespace

Choice choose(const Scene& scene, Plan& plan) {
  Choice choice{
      std::vector<bool>(scene.queries.size(), false), 0, {"hierarchy", false, "none", "", ""}};
  Effect& e = choice.effect;
  const bool asked = scene.card.hierarchy == UseHierarchy::kOn;
  const auto none = [&](const std::string& why) {
    if (asked)
      throw Error(ErrorCode::kUsage,
                  fmt::format("{}: card, hierarchy = \"on\": {}", printable_name(scene.file), why));
    e.why = why;
    e.cost = "none";
    choice.nodes = 0;
    choice.queries.assign(scene.queries.size(), false);
    return choice;
  };
  if (scene.card.hierarchy == UseHierarchy::kOff) return none("hierarchy = \"off\"");
  std::string first_why;
  for (std::size_t q = 0; q < scene.queries.size(); ++q) {
    const auto why = against(scene.queries[q], plan);
    choice.queries[q] = !why;
    if (why && first_why.empty()) first_why = fmt::format("{}: {}", scene.queries[q].name, *why);
  }
  if (std::find(choice.queries.begin(), choice.queries.end(), true) == choice.queries.end())
    return none(first_why);
  const QueryWork& work = plan.queries.front();
  if (!asked && work.secondaries < kWorthATree)
    return none(fmt::format("a tree wins from about {} triangles on, there are {}", kWorthATree,
                            work.secondaries));
  if (const auto why = against(plan.board, BoardConfig{}.nodes)) return none(*why);
  std::string why;
  const auto tree = tree_of(scene, plan, why);
  if (!tree) return none("there is no tree: " + why);
  // Room for what other poses make of it is not needed: a tree stays as it is.
  choice.nodes = static_cast<unsigned>(
      std::max<std::uint64_t>({BoardConfig{}.nodes, std::bit_ceil(tree->nodes().size()),
                               std::bit_ceil((work.secondaries + 7) / 8)}));
  if (const auto reason = against(plan.board, choice.nodes)) return none(*reason);

  const std::uint64_t refit = refit_clocks(work, scene, plan, *tree);
  std::uint64_t rows = 0, through = refit;
  for (std::size_t q = 0; q < scene.queries.size(); ++q) {
    if (!choice.queries[q]) continue;
    plan.queries[q].hierarchy_clocks = clocks(plan.queries[q], scene, *tree);
    rows += plan.queries[q].rows;
    through += *plan.queries[q].hierarchy_clocks;
  }
  const std::string both =
      fmt::format("about {} clocks a frame{}; sweeps of {} lanes take {}", through,
                  refit == 0 ? ""
                             : fmt::format(", {} of them for boxes of "
                                           "what moves",
                                           refit),
                  plan.board.lanes, rows);
  if (!asked && through >= rows) {
    choice.nodes = 0;
    e.cost = both;
    e.why = "sweeps take less";
    choice.queries.assign(scene.queries.size(), false);
    return choice;
  }
  std::vector<std::string_view> names;
  for (std::size_t q = 0; q < scene.queries.size(); ++q)
    if (choice.queries[q]) names.push_back(scene.queries[q].name);
  e = {"hierarchy", true, fmt::format("{} node units", kNodeUnits),
       fmt::format("{}rays of {} go through a tree of {} nodes", asked ? "asked for: " : "",
                   fmt::join(names, ", "), tree->nodes().size()),
       both};
  return choice;
}

}  // namespace cde::plan_hierarchy
