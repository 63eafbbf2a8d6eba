// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "accuracy/tally.hpp"

/// What a pipe costs, beside what it is worth.
namespace cde::cli {

/// Of one lane, operators of one clock. What nobody measured is empty.
struct Price {
  std::optional<unsigned> latency;   ///< clocks from operands to the answer
  std::optional<unsigned> interval;  ///< clocks from a row of pairs to the next
  std::optional<unsigned> operators;
  std::optional<double> luts, dsps, fmax_mhz;
  std::string target;  ///< what area and clock are of; empty if they were not measured

  /// Clocks of a million tests on one lane.
  [[nodiscard]] std::optional<double> clocks_per_million() const;
  [[nodiscard]] nlohmann::ordered_json to_json() const;
};

/// Of each of them. Clocks and operators are read in the RTL if `elaborate` says so (seconds a pipe
/// the first time; kept in the cache), area and Fmax from docs/prices.json beside the RTL, if it is
/// there and has a row for the pipe. Error kFile for one that cannot be read.
[[nodiscard]] std::vector<Price> prices_of(const std::vector<AccuracyPipe>& pipes, bool elaborate);

}  // namespace cde::cli
