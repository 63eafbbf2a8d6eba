// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// Charts as inline SVG for pages (page.hpp). Positions along x are percentages and text has the
/// size of the page's, so a chart fills whatever width it gets and can be read on a phone. Colours
/// are the classes s0, s1, ... of the page's style sheet. Each carries its figures as CSV, seconds
/// and counts in full, for the script of the page (kChartScript) to save.
namespace cde::cli {

/// A part of every bar, from the axis outwards.
struct Series {
  std::string name;
  int colour = 0;              ///< class s<colour>
  std::vector<double> values;  ///< a bar each, seconds, >= 0
};

/// Bars that stand beside each other, of parts in seconds on a linear axis, with a legend that has
/// the mean of every part. `label` is what a screen reader says; a bar is called `what` ("frame")
/// and its number.
[[nodiscard]] std::string stacked_bars(std::string_view label, std::string_view what,
                                       const std::vector<std::uint32_t>& numbers,
                                       const std::vector<Series>& series);

/// A measurement or a modelled time, with what it is above it.
struct Dot {
  std::string name;
  int colour = 0;
  double seconds = 0;        ///< > 0
  double low = 0, high = 0;  ///< a line through the dot, if low > 0
  bool hollow = false;       ///< not to be compared with the others
  std::string note;          ///< behind the value
};

/// Times on a logarithmic axis of whole decades. Dots, as a bar's length would say nothing there.
[[nodiscard]] std::string log_dots(std::string_view label, const std::vector<Dot>& dots);

/// A line through points; all of a chart have the same x.
struct Line {
  std::string name;
  int colour = 0;
  bool dashed = false;
  std::vector<double> x, y;  ///< on logarithmic axes > 0, y in seconds
};

/// Values over x, both axes linear, with a line at 0; not finite: a hole in the line.
[[nodiscard]] std::string linear_lines(std::string_view label, std::string_view x_name,
                                       const std::vector<Line>& lines);

/// Times over a count, both axes logarithmic.
[[nodiscard]] std::string log_lines(std::string_view label, std::string_view x_name,
                                    const std::vector<Line>& lines);

}  // namespace cde::cli
