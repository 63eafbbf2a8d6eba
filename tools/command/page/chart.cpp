// SPDX-License-Identifier: Apache-2.0
#include "page/chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "page/chart_parts.hpp"
#include "page/page.hpp"

namespace cde::cli {

using namespace chart;

namespace {

/// Lines as CSV, over the x of the first line.
std::string lines_csv(std::string_view x_name, const std::vector<Line>& lines,
                      std::string_view unit) {
  std::vector<std::string> fields = {std::string(x_name)};
  for (const Line& line : lines) fields.push_back(fmt::format("{}{}", line.name, unit));
  std::string csv = row(fields);
  for (std::size_t i = 0; i < lines.front().x.size(); ++i) {
    fields = {figure(lines.front().x[i])};
    for (const Line& line : lines) fields.push_back(figure(line.y[i]));
    csv += row(fields);
  }
  return csv;
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

}  // namespace

std::string stacked_bars(std::string_view label, std::string_view what,
                         const std::vector<std::uint32_t>& numbers,
                         const std::vector<Series>& series) {
  const std::size_t count = numbers.size();
  std::vector<double> sums(count, 0);
  for (const Series& s : series)
    for (std::size_t i = 0; i < count; ++i) sums[i] += s.values[i];
  const double most = count == 0 ? 0 : *std::max_element(sums.begin(), sums.end());
  std::string svg = start("bars", label, kTop + kHeight + 20);
  const double scale = most > 0 ? kHeight / most : 0;
  if (most > 0) {
    const double step = step_for(most);
    for (int i = 0; i * step <= most * 1.0001; ++i)
      svg += level(kTop + kHeight - scale * i * step, i == 0 ? "0" : tick(i * step));
  }
  const double slot = 100.0 / static_cast<double>(std::max<std::size_t>(count, 1));
  const double width = slot * (count > 200 ? 1.0 : 0.82);
  for (std::size_t i = 0; i < count; ++i) {
    double y = kTop + kHeight;
    svg += fmt::format("<g class=\"bar\"><title>{} {}: {}</title>", escaped(what), numbers[i],
                       duration(sums[i]));
    for (const Series& s : series) {
      const double height = scale * s.values[i];
      y -= height;
      if (height > 0) {
        svg += fmt::format(
            "<rect class=\"s{}\" x=\"{:.4g}%\" width=\"{:.4g}%\" y=\"{:.2f}\" height=\"{:.2f}\"/>",
            s.colour, slot * static_cast<double>(i) + (slot - width) / 2, width, y, height);
      }
    }
    svg += "</g>\n";
  }
  for (const bool last : {false, true}) {
    if (count > (last ? 1u : 0u))
      svg +=
          fmt::format("<text class=\"tick\" x=\"{}\" y=\"{:g}\" text-anchor=\"{}\">{} {}</text>\n",
                      last ? "100%" : "0", kTop + kHeight + 16, last ? "end" : "start",
                      escaped(what), last ? numbers.back() : numbers.front());
  }
  svg += "</svg></div>\n<ul class=\"legend\">\n";
  for (const Series& s : series)
    svg += key(s.colour, fmt::format("{}, mean {}", s.name, duration(mean(s.values))));
  std::vector<std::string> fields = {std::string(what)};
  for (const Series& s : series) fields.push_back(s.name + " (s)");
  std::string csv = row(fields);
  for (std::size_t i = 0; i < count; ++i) {
    fields = {fmt::format("{}", numbers[i])};
    for (const Series& s : series) fields.push_back(figure(s.values[i]));
    csv += row(fields);
  }
  return with_figures(svg + "</ul>\n", csv);
}

std::string log_dots(std::string_view label, const std::vector<Dot>& dots) {
  double least = 1e300, most = 0;
  for (const Dot& d : dots) {
    least = std::min(least, d.low > 0 ? d.low : d.seconds);
    most = std::max(most, std::max(d.high, d.seconds));
  }
  const Decades axis(least / 1.5, 1.2 * most);
  constexpr double kRow = 46, kAxis = 18;
  const double height = kAxis + kRow * static_cast<double>(dots.size());
  const bool crowded = axis.high - axis.low > 4;  // on a narrow screen
  std::string svg = start("rows", label, height);
  for (int power = axis.low; power <= axis.high; ++power) {
    const double x = 100.0 * (power - axis.low) / (axis.high - axis.low);
    const char* anchor = power == axis.low ? "start" : power == axis.high ? "end" : "middle";
    svg += fmt::format(
        "<line class=\"grid\" x1=\"{0:.4g}%\" x2=\"{0:.4g}%\" y1=\"{1:g}\" y2=\"{2:g}\"/>"
        "<text class=\"tick{5}\" x=\"{0:.4g}%\" y=\"12\" text-anchor=\"{3}\">{4}</text>\n",
        x, kAxis, height, anchor, tick(std::pow(10, power)),
        crowded && (power - axis.low) % 2 != 0 ? " aside" : "");
  }
  double y = kAxis;
  for (const Dot& d : dots) {
    svg += fmt::format(
        "<text class=\"name\" x=\"0\" y=\"{:g}\">{}<tspan class=\"value\" dx=\"10\">{}</tspan>"
        "<tspan class=\"tick aside\" dx=\"8\">{}</tspan></text>\n",
        y + 18, escaped(d.name), duration(d.seconds), escaped(d.note));
    if (d.low > 0) {
      svg += fmt::format(
          "<line class=\"l{0} spread\" x1=\"{1:.4g}%\" x2=\"{2:.4g}%\" y1=\"{3:g}\" y2=\"{3:g}\"/>",
          d.colour, 100 * axis.share(d.low), 100 * axis.share(d.high), y + 31);
    }
    svg += fmt::format(
        "<circle class=\"s{0} l{0}{1}\" cx=\"{2:.4g}%\" cy=\"{3:g}\" r=\"6\"><title>{4}: "
        "{5}</title></circle>\n",
        d.colour, d.hollow ? " hollow" : "", 100 * axis.share(d.seconds), y + 31, escaped(d.name),
        duration(d.seconds));
    y += kRow;
  }
  std::string csv = row({"name", "seconds", "from (s)", "to (s)", "note"});
  for (const Dot& d : dots) {
    const bool spread = d.low > 0;
    csv += row({d.name, figure(d.seconds), figure(spread ? d.low : NAN),
                figure(spread ? d.high : NAN), d.note});
  }
  return with_figures(svg + "</svg></div>\n", csv);
}

std::string linear_lines(std::string_view label, std::string_view x_name,
                         const std::vector<Line>& lines) {
  double low = 0, high = 0;
  for (const Line& line : lines)
    for (const double y : line.y)
      if (std::isfinite(y)) low = std::min(low, y), high = std::max(high, y);
  if (high == low) high = low + 1;
  const double tall = 0.7 * kHeight, first = lines.front().x.front(), last = lines.front().x.back();
  const auto at_x = [&](double x) {
    return last > first ? 100 * (x - first) / (last - first) : 50;
  };
  const auto at_y = [&](double y) { return kTop + tall * (high - y) / (high - low); };
  std::string svg = start("lines", label, kTop + tall + 36);
  const double step = step_for(high - low);
  for (double y = std::ceil(low / step) * step; y <= high + 1e-9 * step; y += step)
    svg += level(at_y(y), std::abs(y) < 1e-9 * step ? "0" : fmt::format("{:.4g}", y));
  svg += fmt::format("<line class=\"zero\" x1=\"0\" x2=\"100%\" y1=\"{0:.1f}\" y2=\"{0:.1f}\"/>\n",
                     at_y(0));
  const double across = last > first ? step_for(last - first) : 1;
  for (double x = std::ceil(first / across - 1e-9) * across; x <= last + 1e-9 * across; x += across)
    svg += label_below(at_x(x), kTop + tall + 16,
                       fmt::format("{:.4g}", std::abs(x) < 1e-9 * across ? 0.0 : x));
  svg += label_below(50, kTop + tall + 32, x_name);
  svg +=
      draw(lines, {at_x, at_y, [](double y) { return std::isfinite(y); },
                   [](double x, double y) { return fmt::format("{:g}: {:g}", x, y); }, 2.5, 2.5});
  return with_figures(svg, lines_csv(x_name, lines, ""));
}

std::string log_lines(std::string_view label, std::string_view x_name,
                      const std::vector<Line>& lines) {
  double least = 1e300, most = 0, first = 1e300, last = 0;
  for (const Line& line : lines) {
    for (const double y : line.y) least = std::min(least, y), most = std::max(most, y);
    for (const double x : line.x) first = std::min(first, x), last = std::max(last, x);
  }
  const Decades axis(least, most);
  constexpr double kLeft = 3, kWide = 94;  // percent
  const auto at_x = [&](double x) {
    return kLeft + kWide * std::log(x / first) / std::log(std::max(last / first, 1.001));
  };
  const double tall = kHeight * 1.3;
  const auto at_y = [&](double y) { return kTop + tall * (1 - axis.share(y)); };
  std::string svg = start("lines", label, kTop + tall + 40);
  for (int power = axis.low; power <= axis.high; ++power)
    svg += level(at_y(std::pow(10, power)), tick(std::pow(10, power)));
  const auto count = [](double x) { return grouped(static_cast<std::uint64_t>(std::llround(x))); };
  for (const double x : lines.front().x) svg += label_below(at_x(x), kTop + tall + 16, count(x));
  svg += label_below(50, kTop + tall + 34, x_name);
  svg += draw(lines, {at_x, at_y, [](double) { return true; },
                      [&](double x, double y) { return count(x) + ": " + duration(y); }, 4, 4});
  return with_figures(svg, lines_csv(x_name, lines, " (s)"));
}

}  // namespace cde::cli
