#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cde/bitstream.hpp"
#include "cde/scene.hpp"

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
  std::uint64_t packets = 0;          ///< of 256 primaries, a pass each
  std::uint64_t tests = 0;            ///< pairs, masked primaries apart
  std::uint64_t rows = 0;             ///< clocks that the pipe is fed
  std::uint64_t most_records = 0;     ///< that the result mode can keep
  std::uint64_t secondary_words = 0;  ///< of an upload of all of them
  std::uint64_t moved_words = 0;      ///< of them that are uploaded again in every frame
  std::uint64_t primary_words = 0;    ///< loaded in every frame
};

/// The smallest card that serves a scene.
struct Plan {
  BoardConfig board;
  std::vector<Effect> effects;
  std::vector<QueryWork> queries;
  bool resident = true;  ///< all queries have the same secondaries, which stay in DDR
};

/// Decides what the scene needs; nothing is built or run. Errors, before anything runs: kUsage (the
/// scene asks for what this version of the card does not have, or for a pipe that the bitstream it
/// asks for lacks), kCapacity (secondaries beyond DDR).
[[nodiscard]] Plan plan(const Scene& scene);

/// How many times as long the simulation of a frame takes with an effect, by its name in a plan,
/// as without: measured once, with `cde bench effects` (docs/scenes.md has conditions and machine).
/// None for effects whose cost is counted from the scene.
[[nodiscard]] std::optional<double> simulation_cost(std::string_view effect);

}  // namespace cde
