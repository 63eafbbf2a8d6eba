// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <bit>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cde/scene/plan.hpp"
#include "cde/scene/scene.hpp"
#include "cde/scene/scene_pair.hpp"

/// How a record of a scene came about, on the card and in the reference.
namespace cde::cli {

/// Of two T as they are compared, as -0 and +0 differ.
[[nodiscard]] inline std::uint32_t bits(float x) {
  return std::bit_cast<std::uint32_t>(x);
}

/// RUN:QUERY:FRAME:PRIMARY.
struct RecordName {
  std::string run, query;
  std::uint32_t frame = 0, primary = 0;
};
/// Error kUsage for what has another form.
[[nodiscard]] RecordName record_named(const std::string& text);

/// A pair of the primary on both sides.
struct StoryPair {
  std::uint32_t secondary = 0;
  /// What a side has of the pair. T as it is compared: of solids the signed gap.
  struct Side {
    bool f = false, bad = false;
    bool candidate = false;  ///< it may be kept; in modes all and hits: it has a record
    bool kept = false;       ///< it is better than what was kept before
    float t = 0;
    friend bool operator==(const Side&, const Side&);
  };
  std::optional<Side> card, reference;  ///< none: that side has not tested it
  // Of the card, in modes with one record per primary:
  std::uint64_t pass = 0, clock = 0;  ///< when it came to the update engine, counted from go
  float held = 0;                     ///< T that the engine had of the primary then
};

struct RecordStory {
  Scene scene;
  BoardConfig board;
  std::optional<BuiltCard> stands_in_for;
  std::size_t query = 0;
  std::uint32_t frame = 0, primary = 0;
  std::uint32_t first_frame = 0;        ///< that was played
  std::vector<Record> card, reference;  ///< of the primary; one in modes with one a primary
  std::vector<StoryPair> arrived;       ///< at the update engine or at the records, in their order
  std::vector<StoryPair> missing;  ///< the reference has them as candidates, the card not at all
  std::uint64_t passes = 0;        ///< of the packet
  std::uint64_t swept = 0, candidates = 0;  ///< pairs of the primary in the reference
  bool swept_instead = false;   ///< of a way through a hierarchy, of which pairs tell nothing
  bool chosen_by_host = false;  ///< some pairs do not count: the host chooses among records
  std::vector<float> words;     ///< of the primary
  Shapes secondaries;

  [[nodiscard]] const SceneQuery& asked() const { return scene.queries[query]; }
  /// Whether records are of pairs.
  [[nodiscard]] bool of_pairs() const;
  [[nodiscard]] bool same() const;
  /// Whether the sides have the same of a pair, as far as that can be said.
  [[nodiscard]] bool same(const StoryPair& pair) const;
  /// The pair that the record is of in the reference.
  [[nodiscard]] std::optional<std::uint32_t> winner() const;
  /// The first pair that the sides differ in, else the winner.
  [[nodiscard]] std::optional<std::uint32_t> telling() const;
};

/// Plays the record's packet again, on a card that writes waves of it. `exact`: on the planned card
/// and no other. Errors kUsage and kFile for a name that there is no such record of.
[[nodiscard]] RecordStory record_story(const RecordName& name, bool exact, bool quiet);

}  // namespace cde::cli
