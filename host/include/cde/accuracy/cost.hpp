// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cde/accuracy/tally.hpp"
#include "cde/costs/costed_pipe.hpp"

/// @file
/// Cost of a pipe, to compare with its accuracy.
namespace cde::accuracy {

/// Cost of a pipe's lanes on a target.
struct Cost {
  PipeFigures figures = {};
  Target target = {};
  std::optional<LaneCost> lane = {};  ///< none for an assumed clock, or if nothing was measured
  std::string why_not = {};           ///< reason if there is no cost

  /// Lanes of the times below: those that fit, or one if the clock is assumed. 0: none fits.
  [[nodiscard]] unsigned lanes() const;
  [[nodiscard]] std::optional<double> mhz() const;
  /// Modelled seconds of this many tests on those lanes, without transfers. None if there is no
  /// cost or no lane fits. The latency assumes that every operator is as slow as the slowest.
  [[nodiscard]] std::optional<double> seconds(double tests) const {
    return seconds(tests, lanes());
  }
  [[nodiscard]] std::optional<double> seconds(double tests, unsigned on_lanes) const;
  /// "83.1 MHz on ecp5-85, estimated from its operators".
  [[nodiscard]] std::string clock_source() const;

  [[nodiscard]] nlohmann::ordered_json to_json() const;
};

/// Figures from the RTL if `elaborate`: seconds per pipe the first time, then cached.
[[nodiscard]] std::vector<PipeFigures> figures_of(const std::vector<AccuracyPipe>& pipes,
                                                  bool elaborate);
[[nodiscard]] Cost cost_of(const AccuracyPipe& pipe, const PipeFigures& figures,
                           const Target& target, const CostTable& table);

}  // namespace cde::accuracy
