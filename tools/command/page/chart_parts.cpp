// SPDX-License-Identifier: Apache-2.0
#include "page/chart_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cde/support/columns.hpp"
#include "page/page.hpp"

namespace cde::cli::chart {

std::string start(std::string_view kind, std::string_view label, double height) {
  return fmt::format(
      "<div class=\"chart {}\"><svg width=\"100%\" height=\"{:g}\" role=\"img\" "
      "aria-label=\"{}\">\n",
      kind, height, escaped(label));
}

std::string level(double y, std::string_view text) {
  return fmt::format(
      "<line class=\"grid\" x1=\"0\" x2=\"100%\" y1=\"{0:.1f}\" y2=\"{0:.1f}\"/>"
      "<text class=\"tick\" x=\"-8\" y=\"{1:.1f}\" text-anchor=\"end\">{2}</text>\n",
      y, y + 4, escaped(text));
}

double step_for(double most) {
  const double power = std::pow(10, std::floor(std::log10(most)));
  for (const double factor : {0.2, 0.5, 1.0})
    if (most / (factor * power) <= 5) return factor * power;
  return 2 * power;
}

std::string tick(double seconds) {
  constexpr const char* kUnits[] = {"ns", "µs", "ms", "s"};
  const int unit =
      std::clamp(static_cast<int>(std::floor(std::log10(seconds) + 1e-9) + 9) / 3, 0, 3);
  return fmt::format("{:.3g} {}", seconds * std::pow(10, 9 - 3 * unit), kUnits[unit]);
}

std::string label_below(double x, double y, std::string_view text, const char* anchor) {
  return fmt::format("<text class=\"tick\" x=\"{:.4g}%\" y=\"{:g}\" text-anchor=\"{}\">{}</text>\n",
                     x, y, anchor, escaped(text));
}

std::string draw(const std::vector<Line>& lines, const LinePlot& plot) {
  std::string svg;
  for (const Line& line : lines) {
    for (std::size_t i = 0; i < line.x.size(); ++i) {
      if (!plot.drawn(line.y[i])) continue;
      const double x = plot.at_x(line.x[i]), y = plot.at_y(line.y[i]);
      if (i + 1 < line.x.size() && plot.drawn(line.y[i + 1]))
        svg += fmt::format(
            "<line class=\"l{}{}\" x1=\"{:.5g}%\" y1=\"{:.2f}\" x2=\"{:.5g}%\" y2=\"{:.2f}\"/>",
            line.colour, line.dashed ? " dashed" : "", x, y, plot.at_x(line.x[i + 1]),
            plot.at_y(line.y[i + 1]));
      svg += fmt::format(
          "<circle class=\"s{}\" cx=\"{:.5g}%\" cy=\"{:.2f}\" r=\"{:g}\"><title>{}, {}</title>"
          "</circle>\n",
          line.colour, x, y, line.dashed ? plot.dashed_radius : plot.radius, escaped(line.name),
          plot.title(line.x[i], line.y[i]));
    }
  }
  svg += "</svg></div>\n<ul class=\"legend\">\n";
  for (const Line& line : lines) svg += key(line.colour, line.name, line.dashed);
  return svg + "</ul>\n";
}

std::string key(int colour, std::string_view text, bool dashed) {
  return fmt::format(
      "<li><svg width=\"14\" height=\"12\" aria-hidden=\"true\"><rect class=\"s{}{}\" y=\"{}\" "
      "width=\"14\" height=\"{}\"/></svg>{}</li>\n",
      colour, dashed ? " dashed" : "", dashed ? 5 : 0, dashed ? 3 : 12, escaped(text));
}

std::string row(const std::vector<std::string>& fields) {
  std::string text;
  for (const std::string& field : fields) text += (text.empty() ? "" : ",") + csv_field(field);
  return text + "\n";
}
std::string figure(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : std::string();
}

std::string with_figures(const std::string& chart, const std::string& csv) {
  return fmt::format("<figure class=\"plot\">{}<pre class=\"figures\" hidden>\n{}</pre></figure>\n",
                     chart, escaped(csv));
}

}  // namespace cde::cli::chart
