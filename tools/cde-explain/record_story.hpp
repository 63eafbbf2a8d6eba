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

/// The origin of a record of a scene, on the card and in the reference.
namespace cde::cli {

/// The bits of T, to compare two T: -0 and +0 differ.
[[nodiscard]] inline std::uint32_t bits(float x) {
  return std::bit_cast<std::uint32_t>(x);
}

/// RUN:QUERY:FRAME:PRIMARY.
struct RecordName {
  std::string run, query;
  std::uint32_t frame = 0, primary = 0;
};
/// Error kUsage for a text of another form.
[[nodiscard]] RecordName record_named(const std::string& text);

/// A pair of the primary, on both sides.
struct StoryPair {
  std::uint32_t secondary = 0;
  /// The values of the pair on a side. T is the compared value: for solids the signed distance.
  struct Side {
    bool f = false, bad = false;
    bool candidate = false;  ///< may be kept; in modes all and hits it has a record
    bool kept = false;       ///< better than the best before it
    float t = 0;
    friend bool operator==(const Side&, const Side&);
  };
  std::optional<Side> card, reference;  ///< empty: not tested on that side
  // On the card, in modes with one record per primary:
  std::uint64_t pass = 0, cycle = 0;  ///< arrival at the update engine; cycles from go
  float held = 0;                     ///< the primary's T before that
};

struct RecordStory {
  Scene scene;
  BoardConfig board;
  std::optional<BuiltCard> stands_in_for;
  std::size_t query = 0;
  std::uint32_t frame = 0, primary = 0;
  std::uint32_t first_frame = 0;                         ///< first simulated frame
  std::vector<Record> card, reference;                   ///< of the primary
  std::vector<StoryPair> arrived;                        ///< pairs, in order of arrival
  std::vector<StoryPair> missing;                        ///< candidates that the card did not test
  std::uint64_t passes = 0;                              ///< of the packet
  std::uint64_t pairs_in_reference = 0, candidates = 0;  ///< pairs of the primary in the reference
  bool brute_force_instead =
      false;  ///< brute force replaced the run's BVH traversal, which shows no pairs
  bool chosen_by_host = false;  ///< the host chose among records, because some pairs do not count
  std::vector<float> words;     ///< words of the primary
  Shapes secondaries;

  [[nodiscard]] const SceneQuery& asked() const { return scene.queries[query]; }
  /// Whether each pair or hit has a record.
  [[nodiscard]] bool of_pairs() const;
  [[nodiscard]] bool same() const;
  /// Whether the two sides agree about a pair, as far as it is known.
  [[nodiscard]] bool same(const StoryPair& pair) const;
  /// The secondary of the reference's record.
  [[nodiscard]] std::optional<std::uint32_t> winner() const;
  /// The secondary of the first pair in which the sides differ, else the winner.
  [[nodiscard]] std::optional<std::uint32_t> telling() const;
};

/// Plays the record's packet again on a card with waves. `exact`: only on the planned card. Errors
/// kUsage and kFile if there is no such record.
[[nodiscard]] RecordStory record_story(const RecordName& name, bool exact, bool quiet);

}  // namespace cde::cli
