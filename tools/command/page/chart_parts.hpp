// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "page/chart.hpp"

/// Parts shared by the charts (chart.hpp, scatter.hpp).
namespace cde::cli::chart {

inline constexpr double kTop = 10,
                        kHeight = 220;  ///< pixels: space above the plot, height of the plot

[[nodiscard]] std::string start(std::string_view kind, std::string_view label, double height);

/// A line across the plot. Its label is left of it, in the margin that the style sheet leaves.
[[nodiscard]] std::string level(double y, std::string_view text);

/// 1, 2 or 5 times a power of ten, so that `most` takes two to five steps.
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

/// A text label at x percent and y pixels.
[[nodiscard]] std::string label_below(double x, double y, std::string_view text,
                                      const char* anchor = "middle");

/// Positions of the points of lines, which of them are drawn, and their titles.
struct LinePlot {
  std::function<double(double)> at_x, at_y;  ///< positions in percent and pixels
  std::function<bool(double y)> drawn;       ///< whether a point is drawn, or leaves a hole
  std::function<std::string(double x, double y)> title;
  double radius, dashed_radius;
};
/// Draws lines with a dot per point, the end of the chart, and its legend.
[[nodiscard]] std::string draw(const std::vector<Line>& lines, const LinePlot& plot);

/// An entry of the legend.
[[nodiscard]] std::string key(int colour, std::string_view text, bool dashed = false);

/// A line of CSV. Fields with separators are quoted.
[[nodiscard]] std::string row(const std::vector<std::string>& fields);
/// A number in full precision; empty if it is not finite.
[[nodiscard]] std::string figure(double value);

/// The chart with its figures as CSV, which the page's script offers to save.
[[nodiscard]] std::string with_figures(const std::string& chart, const std::string& csv);

}  // namespace cde::cli::chart
