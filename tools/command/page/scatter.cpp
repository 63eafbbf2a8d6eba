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

/// A logarithmic axis. Its ends are 1, 2 or 5 times a power of ten, or powers of ten if it has more
/// than two decades.
class Axis {
 public:
  /// Extends the axis to a value; ignores a value that is not finite and > 0.
  void add(double value) {
    if (!(value > 0) || !std::isfinite(value)) return;
    least_ = std::min(least_, value), most_ = std::max(most_, value);
  }
  void close() {
    if (most_ == 0) least_ = 1, most_ = 10;
    const int first = static_cast<int>(std::floor(std::log10(least_) + 1e-9)),
              last = static_cast<int>(std::ceil(std::log10(most_) - 1e-9));
    const bool fine = std::log10(most_ / least_) <= 2;
    for (int power = first; power <= std::max(last, first + 1); ++power)
      for (const double factor : {1.0, 2.0, 5.0})
        if (fine || factor == 1) ticks_.push_back(factor * std::pow(10, power));
    const auto last_below = std::upper_bound(ticks_.begin(), ticks_.end(), 1.0001 * least_);
    if (last_below > ticks_.begin() + 1) ticks_.erase(ticks_.begin(), last_below - 1);
    const auto first_above = std::lower_bound(ticks_.begin() + 1, ticks_.end(), 0.9999 * most_);
    if (first_above != ticks_.end()) ticks_.erase(first_above + 1, ticks_.end());
  }
  [[nodiscard]] double share(double value) const {
    const double all = std::log(ticks_.back() / ticks_.front());
    return value > 0 ? std::clamp(std::log(value / ticks_.front()) / all, 0.0, 1.0) : 0;
  }
  [[nodiscard]] const std::vector<double>& ticks() const { return ticks_; }
  /// "1e-06 0.1", for the page's script.
  [[nodiscard]] std::string range() const {
    return fmt::format("{} {}", ticks_.front(), ticks_.back());
  }
  /// Every step()-th tick has a label.
  [[nodiscard]] std::size_t step() const { return (ticks_.size() + kMostTicks - 1) / kMostTicks; }

 private:
  double least_ = std::numeric_limits<double>::infinity(), most_ = 0;
  std::vector<double> ticks_;
};

/// The text of 1, 2 or 5 times a power of ten.
std::string round_number(double value) {
  if (value >= 0.99 && value < 9999) return fmt::format("{:g}", value);
  const int power = static_cast<int>(std::floor(std::log10(value) + 1e-9));
  return fmt::format("{:.0f}e{}", value / std::pow(10, power), power);
}

/// Vertical grid lines, with labels at `y`.
std::string columns(const Axis& axis, double top, double bottom, double y, bool seconds) {
  std::string svg;
  const auto& ticks = axis.ticks();
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const double x = 100 * axis.share(ticks[i]);
    svg += fmt::format(
        "<line class=\"grid\" x1=\"{0:.4g}%\" x2=\"{0:.4g}%\" y1=\"{1:g}\" y2=\"{2:g}\"/>", x, top,
        bottom);
    if (i % axis.step() != 0) continue;
    const char* anchor = i == 0 ? "start" : i + 1 == ticks.size() ? "end" : "middle";
    svg += label_below(x, y, seconds ? tick(ticks[i]) : round_number(ticks[i]), anchor);
  }
  return svg;
}

/// The plot's frame: levels, columns, names of the axes.
template <class AtY>
std::string frame(const Axis& x, const Axis& y, const ScatterAxes& axes, AtY at_y) {
  std::string svg;
  const auto& ticks = y.ticks();
  for (std::size_t i = 0; i < ticks.size(); ++i)
    svg += level(at_y(ticks[i]), i % y.step() == 0 ? round_number(ticks[i]) : "");
  svg += columns(x, kTop, kTop + kTall, kTop + kTall + 16, axes.x_seconds);
  return svg + label_below(50, kTop + kTall + 34, axes.x_name);
}

/// The number of the mark's entry in the page's data, as an attribute.
std::string entry_of(const Mark& m) {
  return m.of ? fmt::format(" data-of=\"{}\"", *m.of) : "";
}

std::string dot(const Mark& m, double x, double y, double r, const std::string& title) {
  std::string svg = m.of ? fmt::format(
                               "<g class=\"mark\"{} tabindex=\"0\" role=\"button\" "
                               "aria-label=\"{}\">",
                               entry_of(m), escaped(m.name))
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

/// The Pareto-optimal marks, by x: no other mark is better in one figure and as good in the other.
std::vector<const Mark*> best_of(const std::vector<Mark>& marks, bool hollow) {
  std::vector<const Mark*> sorted;
  for (const Mark& m : marks)
    if (m.hollow == hollow) sorted.push_back(&m);
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
  Axis x, y;
  for (const Mark& m : marks) {
    x.add(m.x / 1.15), x.add(1.15 * m.x);
    for (const double value : {m.y, m.low, m.high}) y.add(value);
  }
  x.close(), y.close();
  const auto at_x = [&](double value) { return 100 * x.share(value); };
  const auto at_y = [&](double value) { return kTop + kTall * (1 - y.share(value)); };
  std::string svg =
      start("lines", label, kTop + kTall + 42) +
      fmt::format(
          "<g class=\"scatter\" data-x=\"{}\" data-y=\"{}\" data-top=\"{:g}\" "
          "data-tall=\"{:g}\"{}>\n",
          x.range(), y.range(), kTop, kTall, axes.x_seconds ? " data-seconds=\"\"" : "") +
      frame(x, y, axes, at_y);
  const auto line = [&](const std::string& looks, double x1, double y1, double x2, double y2) {
    svg += fmt::format(
        "<line class=\"{}\" x1=\"{:.5g}%\" y1=\"{:.2f}\" x2=\"{:.5g}%\" y2=\"{:.2f}\"/>", looks, x1,
        y1, x2, y2);
  };
  // Estimates are compared only with estimates.
  for (const bool hollow : {true, false}) {
    const std::string looks = hollow ? "pareto dashed" : "pareto";
    const std::vector<const Mark*> best = best_of(marks, hollow);
    for (std::size_t i = 0; i < best.size(); ++i) {
      const Mark* next = i + 1 < best.size() ? best[i + 1] : nullptr;
      const double here = at_y(best[i]->y), right = next != nullptr ? at_x(next->x) : 100;
      line(looks, at_x(best[i]->x), here, right, here);
      if (next != nullptr) line(looks, right, here, right, at_y(next->y));
    }
  }
  for (const Mark& m : marks)
    if (m.high > 0)
      svg += fmt::format(
          "<line class=\"whisker l{0}\"{1} x1=\"{2:.5g}%\" y1=\"{3:.2f}\" x2=\"{2:.5g}%\" "
          "y2=\"{4:.2f}\"/>",
          m.colour, entry_of(m), at_x(m.x), at_y(m.low), at_y(m.high));
  std::string csv = row({"configuration", axes.x_name, axes.y_name, "from", "to"});
  for (const Mark& m : marks) {
    svg += dot(m, at_x(m.x), at_y(m.y), m.letter.empty() ? 6 : 8,
               fmt::format("{}: {:.3g}; {}", m.name, m.y,
                           axes.x_seconds ? duration(m.x) : fmt::format("{:.3g}", m.x)));
    csv += csv_of(m.name, m);
  }
  return with_figures(svg + "</g></svg></div>\n" + keys(legend), csv);
}

std::string log_rows(std::string_view label, std::string_view y_name,
                     const std::vector<MarkRow>& rows,
                     const std::vector<std::pair<int, std::string>>& legend) {
  Axis axis;
  for (const MarkRow& r : rows)
    for (const Mark& m : r.marks)
      for (const double value : {m.y, m.low, m.high}) axis.add(value);
  axis.close();
  constexpr double kRow = 34, kAxis = 18;
  const double height = kAxis + kRow * static_cast<double>(rows.size());
  const auto at = [&](double value) { return value > 0 ? 100 * axis.share(value) : 0; };
  std::string svg = start("rows", label, height) + columns(axis, kAxis, height, 12, false);
  std::string csv = row({"row", std::string(y_name), "from", "to", "mark"});
  double y = kAxis;
  for (const MarkRow& r : rows) {
    svg += fmt::format(
        "<g class=\"row\" data-tall=\"{:g}\" transform=\"translate(0 {:g})\"><text class=\"name\" "
        "x=\"0\" y=\"14\">{}<tspan class=\"value\" dx=\"10\">{}</tspan></text>\n",
        kRow, y, escaped(r.name), escaped(r.value));
    for (const Mark& m : r.marks) {
      if (m.high > 0)
        svg += fmt::format(
            "<line class=\"l{} spread\"{} x1=\"{:.4g}%\" x2=\"{:.4g}%\" y1=\"24\" y2=\"24\"/>",
            m.colour, entry_of(m), at(m.low), at(m.high));
      svg += dot(m, at(m.y), 24, 5, fmt::format("{}: {:.4g}", m.name, m.y));
      const bool spread = m.high > 0;
      csv += row({r.name, figure(m.y), figure(spread ? m.low : NAN), figure(spread ? m.high : NAN),
                  m.name});
    }
    svg += "</g>";
    y += kRow;
  }
  return with_figures(svg + "</svg></div>\n" + keys(legend), csv);
}

std::string log_log_lines(std::string_view label, std::string_view x_name, std::string_view y_name,
                          const std::vector<Line>& lines) {
  Axis x, y;
  for (const Line& line : lines) {
    for (const double value : line.x) x.add(value);
    for (const double value : line.y) y.add(value);
  }
  x.close(), y.close();
  const auto at_x = [&](double value) { return 100 * x.share(value); };
  const auto at_y = [&](double value) { return kTop + kTall * (1 - y.share(value)); };
  std::string svg = start("lines", label, kTop + kTall + 42) +
                    frame(x, y, {std::string(x_name), "", false}, at_y);
  std::string csv = row({"line", std::string(x_name), std::string(y_name)});
  for (const Line& line : lines)
    for (std::size_t i = 0; i < line.x.size(); ++i)
      csv += row({line.name, figure(line.x[i]), figure(line.y[i])});
  svg +=
      draw(lines, {at_x, at_y, [](double y) { return y > 0 && std::isfinite(y); },
                   [](double x, double y) { return fmt::format("{:.3g}: {:.3g}", x, y); }, 3.5, 2});
  return with_figures(svg, csv);
}

}  // namespace cde::cli
