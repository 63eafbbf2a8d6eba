// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "cde/prices/price_table.hpp"

/// Latency and operators of pipes, and the clock of a card on a device.
namespace cde {

/// A pipe of the card.
struct PipeChoice {
  Pair pair = Pair::kRayTriangle;
  Algorithm algorithm = Algorithm::kMoller;
  bool box = false;
  FpFormat format = {};
  PairBudget budget = {};

  /// "ray-triangle moller box fp32", "obb-cylinder fp16 8,8,8".
  [[nodiscard]] std::string name() const;
};

/// Figures of a pipe with one lane, elaborated with operators that take one cycle each.
/// A figure that was not measured is empty.
struct PipeFigures {
  std::optional<unsigned> latency;   ///< clocks from operands to the answer
  std::optional<unsigned> interval;  ///< clocks from a row of pairs to the next
  std::optional<OperatorCounts> operators;

  /// Clocks of a million tests on one lane.
  [[nodiscard]] std::optional<double> clocks_per_million() const;
};

/// Figures of the elaborated RTL: seconds per pipe the first time, kept in the cache.
[[nodiscard]] std::vector<PipeFigures> figures_of(const std::vector<PipeChoice>& pipes);

/// The pipe with its operators, as the price table takes it.
[[nodiscard]] PricedPipe priced(const PipeChoice& pipe, const PipeFigures& figures);

/// The clock of a card: the least of its pipes' lanes on the target, at these clocks of operators.
struct CardClock {
  double mhz = 100;
  std::string is;  ///< where it is from
};
/// Error kUsage if a pipe is not priced, naming what there is.
[[nodiscard]] CardClock clock_on(const Target& target, const std::vector<PipeChoice>& pipes,
                                 const OperatorClocks& clocks);

}  // namespace cde
