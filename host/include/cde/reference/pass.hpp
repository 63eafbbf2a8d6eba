// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "cde/fp/fp_format.hpp"
#include "cde/geometry/shapes.hpp"
#include "cde/query/query.hpp"

namespace cde::reference {

/// What one pass of the card asks. `pair`'s first shape is the primaries', with `swap` the
/// secondaries'; `algorithm` is of ray-triangle, `box` of pairs with the box rule.
struct PassQuery {
  Pair pair = Pair::kRayTriangle;
  Algorithm algorithm = Algorithm::kMoller;
  bool box = false;
  bool swap = false;
  Mode mode = Mode::kNearest;
  bool normals = false;
  PairBudget budget = {};
  FpFormat format = {};  ///< of the card, no wider than fp32: words are rounded to it first
  /// Pairs that count, by the number of the primary and that of the secondary; the others are left
  /// out as if they were not tested. Empty: all.
  std::function<bool(std::uint32_t, std::uint32_t)> counts = {};
};

/// The records of one pass of any pair, computed in software, every bit and in the card's order.
class Pass {
 public:
  /// `numbers` are what records call the primaries; masked primaries are left out of both. Shapes
  /// must outlive the pass. Error kUsage if the shapes are not those of the pair, there are more
  /// than 256 primaries, or no card has the format.
  Pass(const PassQuery& query, Shapes primaries, std::vector<std::uint32_t> numbers,
       const Shapes& secondaries);
  ~Pass();
  Pass(Pass&&) noexcept;
  Pass& operator=(Pass&&) noexcept;

  /// The next records; empty at the end. Valid until the next call.
  [[nodiscard]] std::span<const Record> next();

  class Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

/// A pair of a primary, and what a pass that keeps one record a primary does with it.
struct SweptPair {
  std::uint32_t secondary = 0;
  Record record;           ///< of the pair
  bool candidate = false;  ///< it may be kept
  bool kept = false;       ///< it is better than all before it
};

/// All of one primary, in the card's order: why a record is what it is.
struct SweptPrimary {
  std::vector<SweptPair> pairs;  ///< that count. In modes all and hits candidates are those that
                                 ///< have records, and nothing is kept
  std::vector<Record> records;   ///< of the primary in a Pass of the query
};
/// Errors as Pass.
[[nodiscard]] SweptPrimary sweep(const PassQuery& query, const Shapes& primaries,
                                 std::uint32_t number, const Shapes& secondaries);

}  // namespace cde::reference
