// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// Charts as inline SVG for pages (page.hpp). Positions along x are percentages, and text has the
/// size of the page's text. A chart therefore fits any width and can be read on a phone. Colours
/// are the classes s0, s1, ... of the page's style sheet. Each chart holds its figures as CSV,
/// seconds and counts in full. The page's script (kChartScript) saves them.
namespace cde::cli {

/// One part of every bar. Parts are stacked from the axis outwards.
struct Series {
  std::string name;
  int colour = 0;              ///< class s<colour>
  std::vector<double> values;  ///< one per bar, seconds, >= 0
};

/// Stacked bars side by side, in seconds on a linear axis. The legend has the mean of every part.
/// `label` is the text for screen readers. A bar is named by `what` ("frame") and its number.
[[nodiscard]] std::string stacked_bars(std::string_view label, std::string_view what,
                                       const std::vector<std::uint32_t>& numbers,
                                       const std::vector<Series>& series);

/// A measured or modelled time, with its name above it.
struct Dot {
  std::string name;
  int colour = 0;
  double seconds = 0;        ///< > 0
  double low = 0, high = 0;  ///< ends of a line through the dot, if low > 0
  bool hollow = false;       ///< drawn hollow: not comparable with the others
  std::string note;          ///< printed after the value
};

/// Times as dots on a logarithmic axis of whole decades. On such an axis the length of a bar would
/// be meaningless.
[[nodiscard]] std::string log_dots(std::string_view label, const std::vector<Dot>& dots);

/// A line through points. All lines of a chart have the same x.
struct Line {
  std::string name;
  int colour = 0;
  bool dashed = false;
  std::vector<double> x, y;  ///< > 0 on logarithmic axes; y in seconds there
};

/// Values over x, both axes linear, with a line at 0. A value that is not finite leaves a hole in
/// the line.
[[nodiscard]] std::string linear_lines(std::string_view label, std::string_view x_name,
                                       const std::vector<Line>& lines);

/// Times over a count, both axes logarithmic.
[[nodiscard]] std::string log_lines(std::string_view label, std::string_view x_name,
                                    const std::vector<Line>& lines);

}  // namespace cde::cli
