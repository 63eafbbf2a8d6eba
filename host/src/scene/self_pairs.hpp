// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "cde/scene/scene.hpp"

/// Pairs of a thing with itself, in queries that have an object on both sides. Private to planner
/// and player.
namespace cde {

/// Which pairs of a query count (SceneQuery::self). A shape of an object that is on both sides has
/// a twin: its number on the other side. It does not meet its twin; and where records are of pairs
/// (modes all and hits), of the two records of a pair of such shapes that of the lower primary
/// counts, unless that one is masked.
class SelfPairs {
 public:
  SelfPairs(const Scene& scene, const SceneQuery& query);

  /// Whether any pair does not count.
  [[nodiscard]] bool any() const { return !shared_.empty(); }
  [[nodiscard]] bool counts(std::uint32_t primary, std::uint32_t secondary) const;
  /// Pairs that do not count, those of masked primaries apart.
  [[nodiscard]] std::uint64_t left_out() const;

  /// Secondaries that a pass sweeps. `pairwise`: among them are pairs that do not count, which a
  /// record a primary cannot leave out: the pass gives records of pairs.
  struct Sweep {
    std::uint64_t first = 0, count = 0;
    bool pairwise = false;
  };
  /// The passes of the primaries [first, first + count), of which one is not masked: as few, and as
  /// short, as give every pair that counts; none if there are none. `whole`: a pass can only sweep
  /// all secondaries, as it does with objects.
  [[nodiscard]] std::vector<Sweep> sweeps(std::uint64_t first, std::uint64_t count,
                                          bool whole) const;

 private:
  /// An object on both sides: its first shape's numbers, and how many it has.
  struct Shared {
    std::uint64_t primary, secondary, count;
  };
  /// Number on the other side, or none.
  [[nodiscard]] std::int64_t twin(std::uint64_t number, std::uint64_t Shared::*side,
                                  std::uint64_t Shared::*other) const;
  [[nodiscard]] std::uint64_t first_needed(std::uint64_t first, std::uint64_t count) const;

  std::vector<Shared> shared_;  ///< by primaries
  std::vector<Range> mask_;
  std::uint64_t secondaries_ = 0;
  bool once_ = false;  ///< records are of pairs, and each counts once
};

}  // namespace cde
