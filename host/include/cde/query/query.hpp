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

/// Primaries left out of a pass (1 = masked): not tested, updated or downloaded.
using Stencil = std::bitset<card::kMostPrimaries>;

/// A second pair for a pass. Its pipe works beside the first one, on the same secondaries and with
/// its own primaries (Board::load_second_shapes).
struct SecondPair {
  Pair pair = Pair::kRayTriangle;
  bool swap = false;
};

/// Whether primaries traverse a BVH of the uploaded secondaries, or a brute-force pass tests all of
/// them.
enum class Through : std::uint8_t {
  kAuto,  ///< traverses the BVH if there is one that can answer the query
  kBvh,   ///< error kUsage, with the reason, if the BVH cannot answer the query
  kBruteForce,
};

/// What a pass does.
struct Query {
  Mode mode = Mode::kNearest;
  std::optional<Pair> pair = {};  ///< which of the card's pipes; by default its only one
  bool swap = false;     ///< the pair's first shape is the secondary, its second one the primary
  bool normals = false;  ///< records include n
  std::optional<SecondPair> second = {};  ///< BoardConfig::parallel; modes nearest, farthest, any
  PairIterations iterations =
      {};  ///< iterations of pairs with a cylinder and no ray (has_iterations)
  Stencil stencil = {};
  std::uint32_t first_secondary = 0;  ///< first uploaded secondary of the brute-force pass
  std::uint32_t secondary_count = 0;  ///< secondaries from there on (0: all); not with objects.
                                      ///< Record indices still count in upload order
  Through through = Through::kAuto;
  std::uint64_t deadline_cycles = 0;  ///< per pass; 0: several times the worst case, or for a BVH a
                                      ///< million cycles in which nothing is read
  std::chrono::duration<double> watchdog = std::chrono::hours(1);  ///< wall-clock limit per pass
  std::uint32_t drain_records =
      65536;  ///< records read from a full ring at a time, rounded up to an even number
  std::function<void(double)> progress =
      {};  ///< called from time to time with the estimated share done, 0 to 1
};

}  // namespace cde
