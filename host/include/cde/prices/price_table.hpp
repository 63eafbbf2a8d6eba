// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cde/fp/fp_format.hpp"
#include "cde/geometry/pair.hpp"

/// What operators and lanes were measured to take: docs/prices.json (docs/background/costs.md).
namespace cde {

/// Cells of a design; of what a target does not have, none.
struct CellCounts {
  double lut = 0, carry = 0, ff = 0, dsp = 0, ram = 0, lutram = 0;
  void add(const CellCounts& other, double times);
};

/// Of one operator or one lane, as tools/synthesis measured it.
struct PriceRow {
  std::string what, algorithm, format, lat, target;
  CellCounts cells;
  std::optional<double> mhz;  ///< median over the seeds; none of a target whose area alone is known
};

/// Where a clock or a price is of: a device that was measured, or a clock that is assumed.
struct Target {
  std::string name = "assumed:100MHz";
  std::optional<double> assumed_mhz = 100;
};
inline constexpr const char* kDefaultTarget = "ecp5-85";  ///< of prices

/// "ecp5-85", "hx8k" or "assumed:NUMBERMHz"; error kUsage for anything else, naming these.
[[nodiscard]] Target parse_target(const std::string& text);
[[nodiscard]] std::vector<std::string> target_words();

/// How many of a lane a device has place for, and what runs out first: at most 85 % of logic and
/// registers, all multipliers and memories.
struct LanesThatFit {
  unsigned lanes = 0;
  std::string limit;
  double share = 0;  ///< of what runs out first, that one lane takes; 1: all that may be used
};
[[nodiscard]] LanesThatFit lanes_that_fit(const CellCounts& lane, const std::string& target);

/// Operators of a pipe by kind.
struct OperatorCounts {
  unsigned add = 0, mul = 0, div = 0, sqrt = 0, cmp = 0;  ///< cmp: comparisons, minima and maxima
  [[nodiscard]] unsigned total() const { return add + mul + div + sqrt + cmp; }
};
/// Clocks of operators, in the same order as a card's parameters.
struct OperatorClocks {
  unsigned add = 1, mul = 1, div = 1, sqrt = 1, cmp = 1;
};

/// A pipe, as far as its price goes.
struct PricedPipe {
  Pair pair = Pair::kRayTriangle;
  Algorithm algorithm = Algorithm::kMoller;
  bool box = false;
  FpFormat format = {};
  std::optional<OperatorCounts> operators = {};  ///< none: nobody counted them
};

/// What one lane takes on a target.
struct LanePrice {
  bool estimated = false;  ///< the sum of its operators, and the least of their clocks
  CellCounts cells = {};
  double mhz = 0;
  LanesThatFit fit = {};
  unsigned longest = 1;  ///< clocks of the operator that has the most
  std::string of = {};   ///< the rows, as text
};
/// A price, or why there is none.
struct LanePriceOr {
  std::optional<LanePrice> price;
  std::string why_not;
};

class PriceTable {
 public:
  /// $CDE_PRICES, or docs/prices.json beside the RTL; no rows if that is not there. Error kFile
  /// for one that cannot be read, with the number of the row.
  static PriceTable of_project();

  /// The whole lane where it was measured, at the clocks of operators that are fastest; else the
  /// sum of its operators, each at its fastest. `clocks`: only rows of these.
  [[nodiscard]] LanePriceOr lane(const PricedPipe& pipe, const std::string& target,
                                 const std::optional<OperatorClocks>& clocks = {}) const;

  /// "there are: add fp32 LAT 8, ...": rows of a target that have a clock.
  [[nodiscard]] std::string rows_of(const std::string& target) const;

 private:
  [[nodiscard]] const PriceRow* fastest(std::string_view what, std::string_view algorithm,
                                        const std::string& format, const std::string& target,
                                        const std::string& lat) const;
  [[nodiscard]] LanePriceOr estimate(const PricedPipe& pipe, const std::string& target,
                                     const std::optional<OperatorClocks>& clocks) const;
  std::string file_;
  std::vector<PriceRow> rows_;
};

}  // namespace cde
