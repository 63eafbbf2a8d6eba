// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cde/accuracy/tally.hpp"
#include "cde/prices/card_clock.hpp"

/// What a pipe costs, beside what it is worth.
namespace cde::accuracy {

/// What lanes of a pipe take on a target.
struct Price {
  PipeFigures figures = {};
  Target target = {};
  std::optional<LanePrice> lane = {};  ///< none of an assumed clock, and where nothing was measured
  std::string why_not = {};            ///< then why

  /// Lanes that the times below are of: those that fit; one where the clock is assumed. 0: none.
  [[nodiscard]] unsigned lanes() const;
  [[nodiscard]] std::optional<double> mhz() const;
  /// Modelled seconds of so many tests on those lanes, without transfers; none if it is not priced
  /// or does not fit. The latency counts as if every operator had the clocks of the longest.
  [[nodiscard]] std::optional<double> seconds(double tests) const {
    return seconds(tests, lanes());
  }
  [[nodiscard]] std::optional<double> seconds(double tests, unsigned on_lanes) const;
  /// "83.1 MHz on ecp5-85, estimated from its operators".
  [[nodiscard]] std::string clock_is() const;

  [[nodiscard]] nlohmann::ordered_json to_json() const;
};

/// Read in the RTL if `elaborate` says so: seconds a pipe the first time, kept in the cache.
[[nodiscard]] std::vector<PipeFigures> figures_of(const std::vector<AccuracyPipe>& pipes,
                                                  bool elaborate);
[[nodiscard]] Price price_of(const AccuracyPipe& pipe, const PipeFigures& figures,
                             const Target& target, const PriceTable& table);

}  // namespace cde::accuracy
