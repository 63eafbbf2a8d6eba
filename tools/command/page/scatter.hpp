// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Charts of what is compared by two figures, or a row each. As those of chart.hpp; a mark that is
/// of an entry of the page's data has its number, for the page's script to show.
namespace cde::cli {

/// A figure that charts mark with a dot.
struct Mark {
  std::string name;
  int colour = 0;
  std::string letter = {};  ///< in the dot
  bool ring = false;        ///< around it
  bool hollow = false;
  double x = 0, y = 0;       ///< > 0; y alone in rows
  double low = 0, high = 0;  ///< of y, a line through the dot, if high > 0
  std::optional<std::size_t> of = {};
};

/// Marks by two logarithmic axes, and the line of those that nothing is better than in both: hollow
/// ones, which are estimates, have a line of their own, dashed. `x_seconds`: x is a time.
struct ScatterAxes {
  std::string x_name, y_name;
  bool x_seconds = false;
};
[[nodiscard]] std::string log_scatter(std::string_view label, const ScatterAxes& axes,
                                      const std::vector<Mark>& marks,
                                      const std::vector<std::pair<int, std::string>>& legend);

/// A row with its marks on a logarithmic axis; a y of 0 is set to the axis' left end.
struct MarkRow {
  std::string name, value;
  std::vector<Mark> marks;
};
[[nodiscard]] std::string log_rows(std::string_view label, std::string_view y_name,
                                   const std::vector<MarkRow>& rows,
                                   const std::vector<std::pair<int, std::string>>& legend);

struct Line;
/// Lines on two logarithmic axes of whole decades; what is not > 0 and finite is a hole.
[[nodiscard]] std::string log_log_lines(std::string_view label, std::string_view x_name,
                                        std::string_view y_name, const std::vector<Line>& lines);

}  // namespace cde::cli
