// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <bitset>
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>

#include "cde/contract/records.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/query/record.hpp"

namespace cde {

/// Primaries left out of a pass (1 = masked): neither tested, updated nor downloaded.
using Stencil = std::bitset<card::kMostPrimaries>;

/// A second pair for a pass: its pipe works beside the first one's, on the same secondaries and
/// with primaries of its own (Board::load_second_shapes).
struct SecondPair {
  Pair pair = Pair::kRayTriangle;
  bool swap = false;
};

/// Whether rays go through the hierarchy of what was uploaded, or meet all of it.
enum class Through : std::uint8_t {
  kAuto,       ///< the hierarchy, where there is one that can answer the query
  kHierarchy,  ///< error kUsage, with the reason, where it cannot
  kSweep,
};

/// What a pass does.
struct Query {
  Mode mode = Mode::kNearest;
  std::optional<Pair> pair = {};  ///< which of the card's pipes; by default its only one
  bool swap = false;              ///< the pair's first shape is uploaded, its second one loaded
  bool normals = false;           ///< records have n
  std::optional<SecondPair> second = {};  ///< BoardConfig::parallel; modes nearest, farthest, any
  PairBudget budget = {};  ///< of pairs with a cylinder that is no ray's (has_budget)
  Stencil stencil = {};
  std::uint32_t first_secondary =
      0;  ///< the pass sweeps the uploaded secondaries from this one on,
  std::uint32_t secondary_count = 0;  ///< so many of them (0: all behind it); not with objects.
                                      ///< Records have their numbers in upload order all the same
  Through through = Through::kAuto;
  std::uint64_t deadline_clocks =
      0;  ///< for one pass; 0: several times what the pass can take at worst, or in a hierarchy a
          ///< million in which nothing is read
  std::chrono::duration<double> watchdog = std::chrono::hours(1);  ///< wall clock, for one pass
  std::uint32_t drain_records =
      65536;  ///< taken off a full ring at a time, rounded up to an even number
  std::function<void(double)> progress =
      {};  ///< called now and then with the estimated share done, 0 to 1
};

}  // namespace cde
