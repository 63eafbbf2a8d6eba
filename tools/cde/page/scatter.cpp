// SPDX-License-Identifier: Apache-2.0
#include "page/scatter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "page/chart.hpp"
#include "page/chart_parts.hpp"
#include "page/page.hpp"

namespace cde::cli {

using namespace chart;

namespace {

constexpr double kTall = 1.5 * kHeight;
constexpr int kMostTicks = 8;

/// Least and most of what is > 0 and finite.
struct Range {
  double least = std::numeric_limits<double>::infinity(), most = 0;

  void add(double value) {
    if (!(value > 0) || !std::isfinite(value)) return;
    least = std::min(least, value), most = std::max(most, value);
  }
  [[nodiscard]] Decades decades() const { return most > 0 ? Decades(least, most) : Decades(1, 10); }
};

/// Every how many decades there is a label.
int step_of(const Decades& axis) {
  return (axis.high - axis.low + kMostTicks - 1) / kMostTicks;
}

std::string power_of_ten(int power) {
  return power >= 0 && power <= 3 ? fmt::format("{:g}", std::pow(10, power))
                                  : fmt::format("1e{}", power);
}

/// Lines up and down with labels at `y`.
std::string columns(const Decades& axis, double top, double bottom, double y, bool seconds) {
  std::string svg;
  const int step = step_of(axis);
  for (int power = axis.low; power <= axis.high; ++power) {
    const double x = 100.0 * (power - axis.low) / (axis.high - axis.low);
    svg += fmt::format(
        "<line class=\"grid\" x1=\"{0:.4g}%\" x2=\"{0:.4g}%\" y1=\"{1:g}\" y2=\"{2:g}\"/>", x, top,
        bottom);
    if ((power - axis.low) % step != 0) continue;
    const char* anchor = power == axis.low ? "start" : power == axis.high ? "end" : "middle";
    svg +=
        fmt::format("<text class=\"tick\" x=\"{:.4g}%\" y=\"{:g}\" text-anchor=\"{}\">{}</text>\n",
                    x, y, anchor, seconds ? tick(std::pow(10, power)) : power_of_ten(power));
  }
  return svg;
}

/// The plot's frame: levels, columns, names of the axes.
template <class AtY>
std::string frame(const Decades& x, const Decades& y, const ScatterAxes& axes, AtY at_y) {
  std::string svg;
  const int step = step_of(y);
  for (int power = y.low; power <= y.high; ++power)
    svg += level(at_y(std::pow(10, power)), (power - y.low) % step == 0 ? power_of_ten(power) : "");
  svg += columns(x, kTop, kTop + kTall, kTop + kTall + 16, axes.x_seconds);
  svg += fmt::format("<text class=\"tick\" x=\"50%\" y=\"{:g}\" text-anchor=\"middle\">{}</text>\n",
                     kTop + kTall + 34, escaped(axes.x_name));
  return svg;
}

std::string dot(const Mark& m, double x, double y, double r, const std::string& title) {
  std::string svg = m.of ? fmt::format(
                               "<g class=\"mark\" data-of=\"{}\" tabindex=\"0\" role=\"button\" "
                               "aria-label=\"{}\">",
                               *m.of, escaped(m.name))
                         : "<g>";
  if (m.ring)
    svg += fmt::format("<circle class=\"ring l{}\" cx=\"{:.5g}%\" cy=\"{:.2f}\" r=\"{:g}\"/>",
                       m.colour, x, y, r + 3);
  svg += fmt::format(
      "<circle class=\"s{0} l{0}{1}\" cx=\"{2:.5g}%\" cy=\"{3:.2f}\" r=\"{4:g}\">"
      "<title>{5}</title></circle>",
      m.colour, m.hollow ? " hollow" : "", x, y, r, escaped(title));
  if (!m.letter.empty())
    svg += fmt::format(
        "<text class=\"letter{}\" x=\"{:.5g}%\" y=\"{:.2f}\" "
        "text-anchor=\"middle\">{}</text>",
        m.hollow ? " dark" : "", x, y + 3.5, escaped(m.letter));
  return svg + "</g>\n";
}

std::string keys(const std::vector<std::pair<int, std::string>>& legend) {
  std::string html = "<ul class=\"legend\">\n";
  for (const auto& [colour, text] : legend) html += key(colour, text);
  return html + "</ul>\n";
}

/// Those that no other is better than in one figure and as good in the other, by x.
std::vector<const Mark*> best_of(const std::vector<Mark>& marks) {
  std::vector<const Mark*> sorted;
  for (const Mark& m : marks) sorted.push_back(&m);
  std::stable_sort(sorted.begin(), sorted.end(), [](const Mark* a, const Mark* b) {
    return a->x != b->x ? a->x < b->x : a->y < b->y;
  });
  std::vector<const Mark*> best;
  for (const Mark* m : sorted)
    if (best.empty() || m->y < best.back()->y) best.push_back(m);
  return best;
}

std::string csv_of(const std::string& first, const Mark& m) {
  const bool spread = m.high > 0;
  std::vector<std::string> fields = {first};
  if (m.x > 0) fields.push_back(figure(m.x));
  fields.insert(fields.end(),
                {figure(m.y), figure(spread ? m.low : NAN), figure(spread ? m.high : NAN)});
  return row(fields);
}

}  // namespace

std::string log_scatter(std::string_view label, const ScatterAxes& axes,
                        const std::vector<Mark>& marks,
                        const std::vector<std::pair<int, std::string>>& legend) {
  Range xs, ys;
  for (const Mark& m : marks) {
    xs.add(m.x / 1.25), xs.add(1.25 * m.x);
    for (const double y : {m.y, m.low, m.high}) ys.add(y);
  }
  const Decades x = xs.decades(), y = ys.decades();
  const auto at_x = [&](double value) { return 100 * x.share(value); };
  const auto at_y = [&](double value) { return kTop + kTall * (1 - y.share(value)); };
  std::string svg = start("lines", label, kTop + kTall + 42) + frame(x, y, axes, at_y);
  const auto line = [&](const char* looks, double x1, double y1, double x2, double y2) {
    svg += fmt::format(
        "<line class=\"{}\" x1=\"{:.5g}%\" y1=\"{:.2f}\" x2=\"{:.5g}%\" y2=\"{:.2f}\"/>", looks, x1,
        y1, x2, y2);
  };
  const std::vector<const Mark*> best = best_of(marks);
  for (std::size_t i = 0; i < best.size(); ++i) {
    const double next = i + 1 < best.size() ? at_x(best[i + 1]->x) : 100;
    line("pareto", at_x(best[i]->x), at_y(best[i]->y), next, at_y(best[i]->y));
    if (i + 1 < best.size()) line("pareto", next, at_y(best[i]->y), next, at_y(best[i + 1]->y));
  }
  for (const Mark& m : marks)
    if (m.high > 0)
      line(fmt::format("whisker l{}", m.colour).c_str(), at_x(m.x), at_y(m.low), at_x(m.x),
           at_y(m.high));
  std::string csv = row({"configuration", axes.x_name, axes.y_name, "from", "to"});
  for (const Mark& m : marks) {
    svg += dot(m, at_x(m.x), at_y(m.y), m.letter.empty() ? 6 : 8,
               fmt::format("{}: {:.3g}; {}", m.name, m.y,
                           axes.x_seconds ? duration(m.x) : fmt::format("{:.3g}", m.x)));
    csv += csv_of(m.name, m);
  }
  return with_figures(svg + "</svg></div>\n" + keys(legend), csv);
}

std::string log_rows(std::string_view label, std::string_view y_name,
                     const std::vector<MarkRow>& rows,
                     const std::vector<std::pair<int, std::string>>& legend) {
  Range range;
  for (const MarkRow& r : rows)
    for (const Mark& m : r.marks)
      for (const double y : {m.y, m.low, m.high}) range.add(y);
  const Decades axis = range.decades();
  constexpr double kRow = 34, kAxis = 18;
  const double height = kAxis + kRow * static_cast<double>(rows.size());
  const auto at = [&](double value) { return value > 0 ? 100 * axis.share(value) : 0; };
  std::string svg = start("rows", label, height) + columns(axis, kAxis, height, 12, false);
  std::string csv = row({"row", std::string(y_name), "from", "to", "mark"});
  double y = kAxis;
  for (const MarkRow& r : rows) {
    svg += fmt::format(
        "<text class=\"name\" x=\"0\" y=\"{:g}\">{}<tspan class=\"value\" dx=\"10\">{}</tspan>"
        "</text>\n",
        y + 14, escaped(r.name), escaped(r.value));
    for (const Mark& m : r.marks) {
      if (m.high > 0)
        svg += fmt::format(
            "<line class=\"l{0} spread\" x1=\"{1:.4g}%\" x2=\"{2:.4g}%\" y1=\"{3:g}\" "
            "y2=\"{3:g}\"/>",
            m.colour, at(m.low), at(m.high), y + 24);
      svg += dot(m, at(m.y), y + 24, 5, fmt::format("{}: {:.4g}", m.name, m.y));
      const bool spread = m.high > 0;
      csv += row({r.name, figure(m.y), figure(spread ? m.low : NAN), figure(spread ? m.high : NAN),
                  m.name});
    }
    y += kRow;
  }
  return with_figures(svg + "</svg></div>\n" + keys(legend), csv);
}

std::string log_log_lines(std::string_view label, std::string_view x_name, std::string_view y_name,
                          const std::vector<Line>& lines) {
  Range xs, ys;
  for (const Line& line : lines) {
    for (const double value : line.x) xs.add(value);
    for (const double value : line.y) ys.add(value);
  }
  const Decades x = xs.decades(), y = ys.decades();
  const auto at_x = [&](double value) { return 100 * x.share(value); };
  const auto at_y = [&](double value) { return kTop + kTall * (1 - y.share(value)); };
  std::string svg = start("lines", label, kTop + kTall + 42) +
                    frame(x, y, {std::string(x_name), "", false}, at_y);
  const auto drawn = [](double value) { return value > 0 && std::isfinite(value); };
  std::string csv = row({"line", std::string(x_name), std::string(y_name)});
  for (const Line& line : lines) {
    for (std::size_t i = 0; i < line.x.size(); ++i) {
      csv += row({line.name, figure(line.x[i]), figure(line.y[i])});
      if (!drawn(line.y[i])) continue;
      if (i + 1 < line.x.size() && drawn(line.y[i + 1]))
        svg += fmt::format(
            "<line class=\"l{}{}\" x1=\"{:.5g}%\" y1=\"{:.2f}\" x2=\"{:.5g}%\" y2=\"{:.2f}\"/>",
            line.colour, line.dashed ? " dashed" : "", at_x(line.x[i]), at_y(line.y[i]),
            at_x(line.x[i + 1]), at_y(line.y[i + 1]));
      svg += fmt::format(
          "<circle class=\"s{}\" cx=\"{:.5g}%\" cy=\"{:.2f}\" r=\"{}\"><title>{}, {:.3g}: {:.3g}"
          "</title></circle>\n",
          line.colour, at_x(line.x[i]), at_y(line.y[i]), line.dashed ? "2" : "3.5",
          escaped(line.name), line.x[i], line.y[i]);
    }
  }
  svg += "</svg></div>\n<ul class=\"legend\">\n";
  for (const Line& line : lines) svg += key(line.colour, line.name, line.dashed);
  return with_figures(svg + "</ul>\n", csv);
}

}  // namespace cde::cli
