// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "cde/costs/cost_table.hpp"

/// @file
/// Latency and operators of pipes, from the elaborated RTL.
namespace cde {

/// A pipe of the card.
struct PipeChoice {
  Pair pair = Pair::kRayTriangle;
  Algorithm algorithm = Algorithm::kMoller;
  bool box = false;
  FpFormat format = {};
  PairIterations iterations = {};

  /// "ray-triangle moller box fp32", "obb-cylinder fp16 8,8,8".
  [[nodiscard]] std::string name() const;
};

/// Figures of a one-lane pipe, elaborated with operators that take one cycle each. A figure that
/// was not measured is empty.
struct PipeFigures {
  std::optional<unsigned> latency;   ///< cycles from operands to the result
  std::optional<unsigned> interval;  ///< cycles from one row of pairs to the next
  std::optional<OperatorCounts> operators;

  /// Cycles for a million tests on one lane.
  [[nodiscard]] std::optional<double> cycles_per_million() const;
};

/// Figures of the elaborated RTL. They take seconds per pipe the first time and are then cached.
[[nodiscard]] std::vector<PipeFigures> figures_of(const std::vector<PipeChoice>& pipes);

/// The pipe with its operators, as the cost table takes it.
[[nodiscard]] CostedPipe costed(const PipeChoice& pipe, const PipeFigures& figures);

}  // namespace cde
