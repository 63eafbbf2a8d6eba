// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cde/fp/fp_format.hpp"
#include "cde/geometry/pair.hpp"

/// @file
/// Measured costs of operators and lanes: docs/costs.json (docs/background/costs.md).
namespace cde {

/// Cells of a design. Kinds that a target lacks are 0.
struct CellCounts {
  double lut = 0, carry = 0, ff = 0, dsp = 0, ram = 0, lutram = 0;
  void add(const CellCounts& other, double times);
};

/// Cost of one operator or one lane, measured by tools/synthesis.
struct CostRow {
  std::string what, algorithm, format, lat, target;
  CellCounts cells;
  /// Median over the seeds; none if only the area is known for the target.
  std::optional<double> mhz;
};

/// Target of a clock or a cost: a measured device, or an assumed clock.
struct Target {
  std::string name = "assumed:100MHz";
  std::optional<double> assumed_mhz = 100;
};
inline constexpr const char* kDefaultTarget = "ecp5-85";  ///< for costs

/// Parses "ecp5-85", "hx8k" or "assumed:NUMBERMHz". Error kUsage for anything else, naming these.
[[nodiscard]] Target parse_target(const std::string& text);

/// How many copies of a lane fit on a device, and which resource limits them. A design may use 85 %
/// of logic and registers, and all multipliers and memories.
struct LanesThatFit {
  unsigned lanes = 0;
  std::string limit;
  double share = 0;  ///< of the limiting resource, used by one lane; 1: all that may be used
};
[[nodiscard]] LanesThatFit lanes_that_fit(const CellCounts& lane, const std::string& target);

/// Operators of a pipe by kind.
struct OperatorCounts {
  unsigned add = 0, mul = 0, div = 0, sqrt = 0, cmp = 0;  ///< cmp: comparisons, minima and maxima
  [[nodiscard]] unsigned total() const { return add + mul + div + sqrt + cmp; }
};
/// A pipe, reduced to what its cost depends on.
struct CostedPipe {
  Pair pair = Pair::kRayTriangle;
  Algorithm algorithm = Algorithm::kMoller;
  bool box = false;
  FpFormat format = {};
  std::optional<OperatorCounts> operators = {};  ///< none: not counted
};

/// Cost of one lane on a target.
struct LaneCost {
  bool estimated = false;  ///< the sum of its operators, and the lowest of their clock frequencies
  CellCounts cells = {};
  double mhz = 0;
  LanesThatFit fit = {};
  unsigned longest = 1;  ///< latency of the slowest operator in cycles
  std::string of = {};   ///< the rows, as text
};
/// A cost, or why there is none.
struct LaneCostOr {
  std::optional<LaneCost> cost;
  std::string why_not;
};

class CostTable {
 public:
  /// The table of $CDE_COSTS, or docs/costs.json beside the RTL; without that file no rows. Error
  /// kFile for an unreadable table, with the row number.
  static CostTable of_project();

  /// The cost of a whole lane if it was measured, at the fastest operator latencies. Otherwise the
  /// sum of its operators, each at its fastest.
  [[nodiscard]] LaneCostOr lane(const CostedPipe& pipe, const std::string& target) const;

 private:
  [[nodiscard]] const CostRow* fastest(std::string_view what, std::string_view algorithm,
                                       const std::string& format, const std::string& target) const;
  [[nodiscard]] LaneCostOr estimate(const CostedPipe& pipe, const std::string& target) const;
  std::string file_;
  std::vector<CostRow> rows_;
};

}  // namespace cde
