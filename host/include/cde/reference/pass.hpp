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

/// Parameters of one pass of the card. The first shape of `pair` is the primaries' shape, or with
/// `swap` the secondaries' shape. `algorithm` is for ray-triangle, `box` for pairs with the box
/// rule.
struct PassQuery {
  Pair pair = Pair::kRayTriangle;
  Algorithm algorithm = Algorithm::kMoller;
  bool box = false;
  bool swap = false;
  Mode mode = Mode::kNearest;
  bool normals = false;
  PairIterations iterations = {};
  FpFormat format = {};  ///< format of the card, no wider than fp32; words are first rounded to it
  /// Selects the pairs that count, by the numbers of primary and secondary. The others are treated
  /// as untested. Empty: all.
  std::function<bool(std::uint32_t, std::uint32_t)> counts = {};
};

/// Records of one pass of any pair, computed in software, bit-exact and in the card's order.
class Pass {
 public:
  /// `numbers` are the primaries' numbers in records; masked primaries are in neither list. Shapes
  /// must outlive the pass. Error kUsage if the shapes do not match the pair, there are more than
  /// 256 primaries, or no card has the format.
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

/// A pair of a primary, and its treatment in a pass that keeps one record per primary.
struct BruteForcePair {
  std::uint32_t secondary = 0;
  Record record;           ///< of the pair
  bool candidate = false;  ///< it may be kept
  bool kept = false;       ///< it is better than all pairs before it
};

/// All pairs of one primary, in the card's order: they explain its record.
struct BruteForcePrimary {
  std::vector<BruteForcePair> pairs;  ///< pairs that count. In modes all and hits candidates are
                                      ///< pairs with a record, and none is kept
  std::vector<Record> records;        ///< records of the primary in a Pass of the query
};
/// Errors as for Pass.
[[nodiscard]] BruteForcePrimary brute_force(const PassQuery& query, const Shapes& primaries,
                                            std::uint32_t number, const Shapes& secondaries);

}  // namespace cde::reference
