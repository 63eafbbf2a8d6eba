// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

/// What charts (chart.hpp, scatter.hpp) are made of.
namespace cde::cli::chart {

inline constexpr double kTop = 10, kHeight = 220;  ///< pixels: above the plot, of the plot

[[nodiscard]] std::string start(std::string_view kind, std::string_view label, double height);

/// A line across the plot with its label left of it, in the margin that the style sheet leaves.
[[nodiscard]] std::string level(double y, std::string_view text);

/// 1, 2 or 5 times a power of ten such that `most` takes two to five steps.
[[nodiscard]] double step_for(double most);

/// A round value and its unit: "20 ms".
[[nodiscard]] std::string tick(double seconds);

/// A logarithmic axis of whole decades.
struct Decades {
  int low = 0, high = 0;

  Decades(double least, double most) {
    low = static_cast<int>(std::floor(std::log10(least) + 1e-9));
    high = std::max(low + 1, static_cast<int>(std::ceil(std::log10(most) - 1e-9)));
  }
  [[nodiscard]] double share(double value) const {
    return std::clamp((std::log10(value) - low) / (high - low), 0.0, 1.0);
  }
};

/// An entry of the legend.
[[nodiscard]] std::string key(int colour, std::string_view text, bool dashed = false);

/// A line of CSV; what would end a field is quoted.
[[nodiscard]] std::string row(const std::vector<std::string>& fields);
/// A number in full; nothing if it is not finite.
[[nodiscard]] std::string figure(double value);

/// The chart with its figures in CSV, which the page's script offers to save.
[[nodiscard]] std::string with_figures(const std::string& chart, const std::string& csv);

}  // namespace cde::cli::chart
