// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cde/bitstream/bitstream.hpp"
#include "cde/scene/scene.hpp"

namespace cde {

/// Something that a simulated card can have, and why this one has it or not.
struct Effect {
  std::string name;
  bool used = false;
  std::string choice;  ///< "sphere-sphere", "128 lanes", "none"
  std::string why;
  std::string cost;  ///< of having it, counted or measured; "not measured" and why where nobody did
};

/// What one query asks of the card in a frame, counted from the scene.
struct QueryWork {
  std::string name;
  std::uint64_t primaries = 0, masked = 0, secondaries = 0;
  std::uint64_t packets = 0;  ///< of 256 primaries
  std::uint64_t passes = 0;   ///< one a packet, others where self_pairs
  bool self_pairs = false;    ///< pairs of a thing with itself do not count
  std::uint64_t tests = 0;    ///< pairs that the card tests, masked primaries apart
  std::uint64_t rows = 0;     ///< clocks that the pipe is fed
  bool hierarchy = false;     ///< rays go through one: tests and rows are what is left out
  std::optional<std::uint64_t> hierarchy_clocks;  ///< estimated of that, if it could
  std::uint64_t most_records = 0;                 ///< that the result mode can keep
  std::uint64_t secondary_words = 0;              ///< of an upload of all of them
  std::uint64_t moved_words = 0;    ///< written in every frame if they stay in DDR: shapes again,
                                    ///< and 12 words an object that the card moves
  std::uint64_t primary_words = 0;  ///< written in every frame after the first
};

/// A card that is built, and how long it takes.
struct BuiltCard {
  BoardConfig board;
  double times = 1;  ///< a planned card's time, estimated
};

/// The smallest card that serves a scene, of the few sizes that scenes share.
struct Plan {
  BoardConfig board;
  /// Where use_built_card has taken another card: the one that it stands in for, which `effects`
  /// describes, and how many times that one's time it is estimated to take.
  std::optional<BuiltCard> stands_in_for;
  std::vector<Effect> effects;
  std::vector<QueryWork> queries;
  bool resident = true;  ///< all queries have the same secondaries, which stay in DDR
  /// Objects of the scene that the card's transformer moves where they are secondaries, and where
  /// they are primaries; the host poses the others and writes what changed.
  std::vector<bool> card_moves, card_moves_primaries;
};

/// Decides what the scene needs; nothing is built or run. Errors, before anything runs: kUsage (the
/// scene asks for what this version of the card does not have, or for a pipe that the bitstream it
/// asks for lacks, or for more objects than the card moves), kCapacity (secondaries beyond DDR).
[[nodiscard]] Plan plan(const Scene& scene);

/// Clocks that the pipes are fed, by a card's lanes.
using Rows = std::function<std::uint64_t(unsigned lanes)>;

/// Where the planned card is not built, the cheapest of those that are which give the same records
/// for at most 1.3 times the simulation's and the device's time by an estimate; nothing where there
/// is none. What `asked` says of lanes and pairs is kept. Which cards are built is read from the
/// comments beside bitstreams (kept_bitstreams); what is taken is found again by its key and held
/// against its checksum.
[[nodiscard]] std::optional<BuiltCard> built_card(const BoardConfig& planned,
                                                  const SceneCard& asked, const Rows& rows);

/// Takes the built_card of a plan, if there is one: `board` and the rows of `queries` are its own
/// then. Only for scenes whose queries have up to 256 primaries each: larger ones gain more by a
/// card of their own than its building takes. What the scene's [card] asks for is kept.
void use_built_card(const Scene& scene, Plan& plan);

/// How many times as long the simulation of a frame takes with an effect, by its name in a plan,
/// as without: measured once, with `cde bench effects` (docs/tables/effects.md has conditions and
/// machine). None for effects whose cost is counted from the scene.
[[nodiscard]] std::optional<double> simulation_cost(std::string_view effect);
/// The same for people; "not measured" without a figure.
[[nodiscard]] std::string simulation_text(std::string_view effect);

}  // namespace cde
