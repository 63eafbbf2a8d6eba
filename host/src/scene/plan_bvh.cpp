// SPDX-License-Identifier: Apache-2.0
#include "scene/plan_bvh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>

#include "cde/reference/traversal.hpp"
#include "cde/support/counted.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "scene/bvh_choice.hpp"
#include "scene/scene_runner_objects.hpp"

namespace cde::plan_bvh {
namespace {

// The cycles below hold for operators that take one cycle. `slowness` scales them.
//
/// Cycles per level of the BVH for the last rays of a packet, when no other rays remain.
constexpr double kCyclesPerLevel = 50;
/// Cycles of a solid per secondary that it is tested with, including the nodes above it, if it
/// waits for each leaf.
constexpr double kCyclesPerSolid = 75, kCyclesTwoSpheres = 25;
/// In a pass of at most kAhead solids, traversal does not wait for leaves (bvh_pkg::AHEAD).
/// It takes kCyclesToFirst cycles until the first test, then kCyclesAhead cycles per test.
constexpr std::uint64_t kAhead = 16;
constexpr double kCyclesToFirst = 250, kCyclesAhead = 4.5;
/// Cycles to write a node over the bus, with its share of slots, for a BVH that is not over
/// triangles.
constexpr std::uint64_t kCyclesPerNode = 18;
/// Solids of a query whose traversal is sampled.
constexpr std::size_t kSampledSolids = 32;
/// Extra visits per ray for each independently moving part in the BVH, relative to a BVH that is
/// built anew.
constexpr double kVisitsAMovingPart = 1.0 / 6;

/// How many times as long a primary waits for a node and a leaf as with operators of one cycle. A
/// node takes 17 cycles and a ray-triangle pipe 10; 5 additions, 3 products and a quotient follow
/// each other.
double slowness(const OperatorLatencies& l) {
  constexpr double kNodeAndLeaf = 27;
  return (kNodeAndLeaf + 5 * (l.add - 1) + 3 * (l.mul - 1) + (l.div - 1)) / kNodeAndLeaf;
}

bool is_ray(const SceneQuery& q) {
  return !is_solid(q.pair);
}
/// The shape of the secondaries in the leaves.
Shape leaf_of(const SceneQuery& q) {
  return q.swap ? primary_shape(q.pair) : secondary_shape(q.pair);
}
bool meets_triangles(const SceneQuery& q) {
  return leaf_of(q) == Shape::kTriangle;
}

/// Why the query must test all secondaries; nothing if it can traverse.
std::optional<std::string> against(const SceneQuery& q, const QueryWork& work, const Plan& plan) {
  if (!traversal_shapes(q.pair, q.swap))
    return fmt::format("{}{} cannot traverse a BVH", name(q.pair),
                       q.swap ? " with its roles swapped" : "");
  if (q.mode == Mode::kAll) return "mode all reports every secondary, hit or not";
  if (q.normals && is_ray(q)) return "rays have no normals";
  if (!is_ray(q) && q.mode == Mode::kFarthest)
    return "no box can be culled in a search for the farthest shape from a solid";
  if (has_filter(q.pair) && plan.board.filter)
    return "pairs with the certified filter use brute force";
  if (work.self_pairs)
    return "no shape is tested with itself, which needs passes over ranges of secondaries";
  if (!plan.resident) return "queries have different secondaries, and each would need its own BVH";
  return std::nullopt;
}

/// Why the card cannot have a BVH; nothing if it can.
std::optional<std::string> against(const Scene& scene, BoardConfig board, unsigned nodes) {
  board.box = scene.card.box && std::any_of(board.pairs.begin(), board.pairs.end(), has_box_rule);
  add_traversal_units(scene.card.device, nodes, board);
  try {
    (void)board.parameters();
  } catch (const Error& e) {
    return e.what();
  }
  return std::nullopt;
}

/// The BVH that the scene runner builds in the first frame. If there is none, `why` says so.
std::optional<Bvh> bvh_of_scene(const Scene& scene, const Plan& plan, std::string& why) {
  scene_runner::Row row(scene, plan.card_moves, scene_runner::Table::kAll);
  (void)row.show(scene.queries.front().secondaries, 0);
  try {
    return scene_runner::bvh_of_row(row);
  } catch (const Error& e) {
    why = e.what();
    return std::nullopt;
  }
}

/// Number of parts that move on their own, and so away from their neighbours in the BVH.
std::uint64_t moving_parts(const Scene& scene) {
  std::uint64_t sum = 0;
  for (const std::size_t i : scene.queries.front().secondaries) {
    const SceneObject& object = scene.objects[i];
    if (!is_still(scene, object)) sum += has_member_poses(object) ? size(object.shapes) : 1;
  }
  return sum;
}

/// Visits per primary, and the cycles of a packet's last primaries when no others remain.
struct TraversalCost {
  double nodes = 0, secondaries = 0, last = 0;
};

/// For rays: expected values from the BVH's boxes.
TraversalCost cost_of_rays(const Bvh& bvh) {
  const Bvh::Visits visits = bvh.expected_visits();
  return {visits.nodes, visits.secondaries, kCyclesPerLevel * bvh.depth()};
}

/// For solids: from sampled solids of the first frame.
TraversalCost cost_of_solids(const SceneQuery& q, const Plan& plan, const Scene& scene,
                             const Bvh& bvh, bool ahead) {
  scene_runner::Row met(scene, plan.card_moves, scene_runner::Table::kAll),
      solids(scene, std::vector<bool>(scene.objects.size(), false), scene_runner::Table::kMoved);
  (void)met.show(q.secondaries, 0);
  (void)solids.show(q.primaries, 0);
  const auto traversal_of = [&] {
    return std::visit(
        [&](const auto& list) -> reference::Traversal {
          using P = typename std::decay_t<decltype(list)>::value_type;
          if constexpr (reference::Solid<P>)
            return reference::Traversal(list, bvh);
          else
            throw Error(ErrorCode::kUsage, "such shapes cannot be in a BVH");
        },
        met.placed());
  };
  const double each = ahead                           ? kCyclesAhead
                      : q.pair == Pair::kSphereSphere ? kCyclesTwoSpheres
                                                      : kCyclesPerSolid;
  TraversalCost cost;
  std::visit(
      [&](const auto& list) {
        using P = typename std::decay_t<decltype(list)>::value_type;
        if constexpr (reference::Solid<P>) {
          const std::size_t step = (list.size() + kSampledSolids - 1) / kSampledSolids;
          std::size_t sampled = 0;
          for (std::size_t i = 0; i < list.size(); i += std::max<std::size_t>(step, 1), ++sampled) {
            reference::Traversal traversal = traversal_of();
            (void)traversal.trace(list[i], 0, q.mode);
            const auto tested = static_cast<double>(traversal.counts().secondaries);
            cost.nodes += static_cast<double>(traversal.counts().nodes);
            cost.secondaries += tested;
            cost.last = std::max(cost.last, (ahead ? kCyclesToFirst : 0) + each * tested);
          }
          sampled = std::max<std::size_t>(sampled, 1);
          cost.nodes /= static_cast<double>(sampled);
          cost.secondaries /= static_cast<double>(sampled);
        }
      },
      solids.placed());
  return cost;
}

/// Cycles per frame: visits of all primaries, plus the last primaries of each packet. A BVH over
/// triangles keeps the structure of the first frame.
std::uint64_t cycles(const SceneQuery& q, const QueryWork& w, const Plan& plan, const Scene& scene,
                     const Bvh& bvh) {
  const std::uint64_t primaries = w.primaries - w.masked;
  const TraversalCost cost =
      is_ray(q) ? cost_of_rays(bvh) : cost_of_solids(q, plan, scene, bvh, primaries <= kAhead);
  const double more =
      meets_triangles(q) ? kVisitsAMovingPart * static_cast<double>(moving_parts(scene)) : 0;
  const double each =
      bvh_choice::cycles(scene.card.device, cost.nodes + more, cost.secondaries + more);
  return static_cast<std::uint64_t>(std::ceil(each * static_cast<double>(primaries) +
                                              slowness(scene.card.device.latencies) * cost.last *
                                                  static_cast<double>(w.packets)));
}

/// Cycles per frame to refit the BVH. Over triangles: one per moving triangle and 1.2 per node
/// above it. Any other BVH, or one with nodes in DDR, is written over the bus.
std::uint64_t refit_cycles(const QueryWork& w, const Scene& scene, const Plan& plan,
                           const Bvh& bvh) {
  std::uint64_t moving = 0;
  for (const std::size_t i : scene.queries.front().secondaries)
    if (!is_still(scene, scene.objects[i]) || !deforming(scene.objects[i]).empty())
      moving += size(scene.objects[i].shapes);
  if (moving == 0) return 0;
  const Device& device = scene.card.device;
  const bool in_ddr = device.node_cache != 0 && bvh.nodes().size() > device.pinned_nodes;
  if (in_ddr || !meets_triangles(scene.queries.front())) return kCyclesPerNode * bvh.nodes().size();
  const bool parts =
      std::find(plan.card_moves.begin(), plan.card_moves.end(), true) != plan.card_moves.end();
  const double share =
      parts ? static_cast<double>(moving) / static_cast<double>(w.secondaries) : 1.0;
  return static_cast<std::uint64_t>(
      std::ceil(share * (static_cast<double>(w.secondaries) +
                         1.2 * static_cast<double>(bvh.nodes().size()))));
}

}  // namespace

Choice choose(const Scene& scene, Plan& plan) {
  Choice choice{std::vector<bool>(scene.queries.size(), false), 0, {"bvh", false, "none", "", ""}};
  Effect& e = choice.effect;
  const bool asked = scene.card.bvh == UseBvh::kOn;
  const auto none = [&](const std::string& why) {
    if (asked)
      throw Error(ErrorCode::kUsage,
                  fmt::format("{}: card, bvh = \"on\": {}", printable_name(scene.file), why));
    e.why = why;
    e.cost = "none";
    choice.nodes = 0;
    choice.queries.assign(scene.queries.size(), false);
    return choice;
  };
  if (scene.card.bvh == UseBvh::kOff) return none("bvh = \"off\"");
  std::string first_why;
  for (std::size_t q = 0; q < scene.queries.size(); ++q) {
    const auto why = against(scene.queries[q], plan.queries[q], plan);
    choice.queries[q] = !why;
    if (why && first_why.empty()) first_why = fmt::format("{}: {}", scene.queries[q].name, *why);
  }
  if (std::find(choice.queries.begin(), choice.queries.end(), true) == choice.queries.end())
    return none(first_why);
  const QueryWork& work = plan.queries.front();
  const Shape leaf = leaf_of(scene.queries.front());
  const auto traverses = [&](std::uint64_t traversal, std::uint64_t brute_force) {
    return bvh_choice::traverses(
        asked, leaf, work.secondaries,
        bvh_choice::Cost{static_cast<double>(traversal), static_cast<double>(brute_force)});
  };
  if (!bvh_choice::traverses(asked, leaf, work.secondaries))
    return none(fmt::format("a BVH pays off from about {} {}s on; there are {}",
                            bvh_choice::fewest(leaf), name(leaf), work.secondaries));
  if (const auto why = against(scene, plan.board, BoardConfig{}.nodes)) return none(*why);
  std::string why;
  const auto bvh = bvh_of_scene(scene, plan, why);
  if (!bvh) return none("there is no BVH: " + why);
  // A BVH keeps its structure, so other poses need no extra room.
  choice.nodes = bvh_choice::node_memory(*bvh, work.secondaries);
  if (const auto reason = against(scene, plan.board, choice.nodes)) return none(*reason);

  const std::uint64_t refit = refit_cycles(work, scene, plan, *bvh);
  const std::uint64_t row_cycles = std::max(1u, plan.board.shared_lane);
  std::uint64_t brute_force = 0, through = refit;
  std::string least;  // cost of the first query for which brute force is faster
  for (std::size_t q = 0; q < scene.queries.size(); ++q) {
    if (!choice.queries[q]) continue;
    plan.queries[q].bvh_cycles = cycles(scene.queries[q], plan.queries[q], plan, scene, *bvh);
    const std::uint64_t of_rows = row_cycles * plan.queries[q].rows;
    if (!traverses(*plan.queries[q].bvh_cycles, of_rows)) {
      choice.queries[q] = false;  // this query alone is faster with brute force
      least = least.empty()
                  ? fmt::format("about {} cycles per frame; brute force on {} lanes takes {}",
                                *plan.queries[q].bvh_cycles, plan.board.lanes, of_rows)
                  : least;
      continue;
    }
    brute_force += of_rows;
    through += *plan.queries[q].bvh_cycles;
  }
  const std::string both =
      fmt::format("about {} cycles per frame{}; brute force on {} lanes takes {}", through,
                  refit == 0 ? "" : fmt::format(", {} of them to refit boxes", refit),
                  plan.board.lanes, brute_force);
  if (!traverses(through, brute_force)) {
    choice.nodes = 0;
    e.cost = brute_force == 0 ? least : both;
    e.why = "brute force takes less";
    choice.queries.assign(scene.queries.size(), false);
    return choice;
  }
  std::vector<std::string_view> names;
  bool rays = true;
  for (std::size_t q = 0; q < scene.queries.size(); ++q) {
    if (!choice.queries[q]) continue;
    names.push_back(scene.queries[q].name);
    rays = rays && is_ray(scene.queries[q]);
  }
  e = {"bvh", true, counted(scene.card.device.traversal_units, "traversal unit"),
       fmt::format("{}{} of {} traverse a BVH of {} nodes", asked ? "asked for: " : "",
                   rays ? "rays" : "primaries", fmt::join(names, ", "), bvh->nodes().size()),
       both};
  return choice;
}

}  // namespace cde::plan_bvh
