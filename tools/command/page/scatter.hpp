// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Charts of marks by two figures, or in rows by one figure. They are drawn like the charts of
/// chart.hpp. A mark may carry the number of an entry of the page's data, which the page's script
/// shows.
namespace cde::cli {

/// A dot in a chart, with its figures.
struct Mark {
  std::string name;
  int colour = 0;
  std::string letter = {};  ///< drawn in the dot
  bool ring = false;        ///< draws a ring around the dot
  bool hollow = false;
  double x = 0, y = 0;       ///< > 0; rows use only y
  double low = 0, high = 0;  ///< range of y: a line through the dot, if high > 0
  std::optional<std::size_t> of = {};
};

/// Marks on two logarithmic axes, and the line through the Pareto-optimal ones. Hollow marks are
/// estimates, with a dashed line of their own. `x_seconds`: x is a time.
struct ScatterAxes {
  std::string x_name, y_name;
  bool x_seconds = false;
};
[[nodiscard]] std::string log_scatter(std::string_view label, const ScatterAxes& axes,
                                      const std::vector<Mark>& marks,
                                      const std::vector<std::pair<int, std::string>>& legend);

/// A row of marks on a logarithmic axis. A y of 0 is drawn at the left end of the axis.
struct MarkRow {
  std::string name, value;
  std::vector<Mark> marks;
};
[[nodiscard]] std::string log_rows(std::string_view label, std::string_view y_name,
                                   const std::vector<MarkRow>& rows,
                                   const std::vector<std::pair<int, std::string>>& legend);

struct Line;
/// Lines on two logarithmic axes of whole decades. A value that is not finite and > 0 leaves a
/// hole.
[[nodiscard]] std::string log_log_lines(std::string_view label, std::string_view x_name,
                                        std::string_view y_name, const std::vector<Line>& lines);

}  // namespace cde::cli
