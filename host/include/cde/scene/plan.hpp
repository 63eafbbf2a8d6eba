// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cde/model/model.hpp"
#include "cde/scene/scene.hpp"

namespace cde {

/// An option of a simulated card, and why this card has it or not.
struct Effect {
  std::string name;
  bool used = false;
  std::string choice;  ///< "sphere-sphere", "128 lanes", "none"
  std::string why;
  std::string cost;  ///< its cost, counted or measured; "not measured" with the reason otherwise
};

/// Work of one query in a frame, counted from the scene.
struct QueryWork {
  std::string name;
  std::uint64_t primaries = 0, masked = 0, secondaries = 0;
  std::uint64_t packets = 0;  ///< of 256 primaries
  std::uint64_t passes = 0;   ///< one per packet; more with self_pairs
  bool self_pairs = false;    ///< pairs of a shape with itself do not count
  std::uint64_t tests = 0;    ///< pairs that the card tests, without masked primaries
  std::uint64_t rows = 0;     ///< cycles in which rows enter the pipe
  bool bvh = false;           ///< rays traverse a BVH: tests and rows then count brute force
  std::optional<std::uint64_t> bvh_cycles;  ///< estimated cycles of a traversal, if possible
  std::uint64_t most_records = 0;           ///< most records of the result mode
  std::uint64_t secondary_words = 0;        ///< words of an upload of all secondaries
  std::uint64_t moved_words = 0;    ///< words per frame if they stay in DDR: changed shapes, and 12
                                    ///< words per object that the card moves
  std::uint64_t primary_words = 0;  ///< words per frame after the first
};

/// A simulation model that exists, and its estimated time.
struct BuiltCard {
  BoardConfig board;
  double times = 1;  ///< relative to the planned card's time
};

/// The smallest card that serves a scene, from the few sizes that scenes share.
struct Plan {
  BoardConfig board;
  /// Set if use_built_card() chose another card. It is the planned card, which `effects` describes,
  /// and the estimated ratio of times.
  std::optional<BuiltCard> stands_in_for;
  std::vector<Effect> effects;
  std::vector<QueryWork> queries;
  bool resident = true;  ///< all queries share the same secondaries, which stay in DDR
  /// Objects that the card's transformer moves as secondaries, and as primaries. The host poses the
  /// others and writes what changed.
  std::vector<bool> card_moves, card_moves_primaries;
};

/// Decides what the scene needs, without building or running anything. Error kUsage: the scene
/// needs what this version does not have, a pipe that its requested model lacks, or more objects
/// than the card moves. Error kCapacity: the secondaries exceed DDR.
[[nodiscard]] Plan plan(const Scene& scene);

/// Cycles in which rows enter the pipes, by number of lanes.
using Rows = std::function<std::uint64_t(unsigned lanes)>;

/// If the planned card is not built: the cheapest built card that gives the same records. By an
/// estimate it takes at most 1.3 times the simulation time and device time. Nothing if there is
/// none. Lanes and pairs of `asked` are kept. Built cards are read from the comments beside the
/// models (built_models). The chosen one is found by its key and verified by its checksum.
[[nodiscard]] std::optional<BuiltCard> built_card(const BoardConfig& planned,
                                                  const SceneCard& asked, const Rows& rows);

/// Applies built_card() to a plan, if there is one: `board` and the rows of `queries` are then
/// the built card's. It applies only if each query has at most 256 primaries: larger scenes
/// gain more from their own card than its build costs. Requests in the scene's [card] are kept.
void use_built_card(const Scene& scene, Plan& plan);

/// Factor by which an effect, by its name in a plan, lengthens the simulation of a frame. It was
/// measured once with `cde bench effects` (conditions and machine: docs/tables/effects.md). None
/// for effects whose cost is counted from the scene.
[[nodiscard]] std::optional<double> simulation_cost(std::string_view effect);
/// The same as text; "not measured" without a figure.
[[nodiscard]] std::string simulation_text(std::string_view effect);

}  // namespace cde
