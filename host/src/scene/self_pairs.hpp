// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "cde/scene/scene.hpp"

/// Pairs of a shape with itself, in queries with an object on both sides. Private to planner and
/// scene runner.
namespace cde {

/// Decides which pairs of a query count (SceneQuery::self). A shape of an object on both sides has
/// a twin: the same shape on the other side. A shape is not tested with its twin. Modes all and
/// hits report a pair of such shapes twice. There only the record of the lower primary counts,
/// unless that primary is masked.
class SelfPairs {
 public:
  SelfPairs(const Scene& scene, const SceneQuery& query);

  /// Whether some pairs do not count.
  [[nodiscard]] bool any() const { return !shared_.empty(); }
  [[nodiscard]] bool counts(std::uint32_t primary, std::uint32_t secondary) const;
  /// Number of pairs that do not count, except for masked primaries.
  [[nodiscard]] std::uint64_t left_out() const;

  /// Secondaries of one pass. `pairwise`: some pairs among them do not count. One record per
  /// primary could not leave them out, so the pass reports pairs.
  struct PassRange {
    std::uint64_t first = 0, count = 0;
    bool pairwise = false;
  };
  /// The passes for the primaries [first, first + count), at least one of which is not masked. They
  /// are the fewest and shortest passes that give every pair that counts; empty if no pair counts.
  /// `whole`: a pass must test all secondaries, as it does with objects.
  [[nodiscard]] std::vector<PassRange> passes(std::uint64_t first, std::uint64_t count,
                                              bool whole) const;

 private:
  /// An object on both sides: the numbers of its first shape, and its number of shapes.
  struct Shared {
    std::uint64_t primary, secondary, count;
  };
  /// The twin's number on the other side, or -1.
  [[nodiscard]] std::int64_t twin(std::uint64_t number, std::uint64_t Shared::*side,
                                  std::uint64_t Shared::*other) const;
  [[nodiscard]] std::uint64_t first_needed(std::uint64_t first, std::uint64_t count) const;

  std::vector<Shared> shared_;  ///< by primaries
  std::vector<Range> mask_;
  std::uint64_t secondaries_ = 0;
  bool once_ = false;  ///< records are per pair, and each pair counts once
};

}  // namespace cde
