// SPDX-License-Identifier: Apache-2.0
// The accuracy and cost list as a page.
#include "accuracy/accuracy_page.hpp"
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "accuracy/accuracy_report.hpp"
#include "cde/accuracy/profiles.hpp"
#include "cde/fp/number_text.hpp"
#include "output/streams.hpp"
#include "page/chart.hpp"
#include "page/page.hpp"
#include "page/scatter.hpp"

namespace cde::cli {
namespace {

using Json = nlohmann::ordered_json;
using Rows = std::vector<std::vector<Cell>>;
using Legend = std::vector<std::pair<int, std::string>>;

int colour_of(FpFormat format) {
  const std::vector<std::string> all = pair_formats();
  return static_cast<int>(std::ranges::find(all, format.name()) - all.begin()) % 6;
}

std::string letter_of(const AccuracyPipe& pipe) {
  if (pipe.pair != Pair::kRayTriangle) return "";
  return std::string(1, static_cast<char>(std::toupper(name(pipe.algorithm).front())));
}

/// The name of a pipe without the pair: "watertight box fp24".
std::string short_name(const AccuracyPipe& pipe) {
  return pipe.name().substr(name(pipe.pair).size() + 1);
}

std::string wrong_text(const SavedTally& t) {
  if (t.judged == 0) return "-";
  const Interval95 share = t.wrong_interval();
  return fmt::format("{}..{}", compact(share.low), compact(share.high));
}

std::string error_text(const SavedTally& t, double Quantiles::*quantile, double unit = 1) {
  if (t.t.count == 0) return "-";
  bool bounded = false;
  const double value = t.error(quantile, &bounded);
  return fmt::format("{}{}", bounded ? "<" : "", compact(unit * value));
}

/// The x axis of a chart.
struct Basis {
  bool seconds = false;
  std::string axis, words;
};

std::optional<double> x_of(const SavedPipe& k, const Basis& basis) {
  if (basis.seconds) return k.cost.seconds(1e6);
  if (!k.figures.operators || !k.figures.interval) return std::nullopt;
  return static_cast<double>(k.figures.operators->total()) * k.pipe.format.width() *
         *k.figures.interval;
}

class AccuracyPage {
 public:
  AccuracyPage(const SavedSweep& sweep, const Target& target) : sweep_(sweep), target_(target) {
    for (std::size_t i = 0; i < sweep.pipes.size(); ++i) {
      const std::string pair(name(sweep.pipes[i].pipe.pair));
      if (std::ranges::find(pairs_, pair) == pairs_.end()) pairs_.push_back(pair);
    }
  }

  [[nodiscard]] std::string html() const {
    std::string body = head();
    for (const std::string& pair : pairs_) body += pair_section(pair);
    body += profile_section() + tail();
    Json entries = Json::array();
    for (const SavedPipe& k : sweep_.pipes) entries.push_back(entry(k));
    return page("What accuracy costs", body, Json{{"entries", entries}},
                {&kChartScript, &kAccuracyScript, &kFilterScript});
  }

 private:
  [[nodiscard]] std::vector<std::size_t> of(const std::string& pair) const {
    std::vector<std::size_t> list;
    for (std::size_t i = 0; i < sweep_.pipes.size(); ++i)
      if (name(sweep_.pipes[i].pipe.pair) == pair) list.push_back(i);
    return list;
  }
  [[nodiscard]] Legend formats_of(const std::vector<std::size_t>& list) const {
    Legend legend;
    for (const std::size_t i : list) {
      const FpFormat format = sweep_.pipes[i].pipe.format;
      const std::pair<int, std::string> entry(colour_of(format), format.name());
      if (std::ranges::find(legend, entry) == legend.end()) legend.push_back(entry);
    }
    return legend;
  }

  [[nodiscard]] std::string head() const;
  [[nodiscard]] std::string pair_section(const std::string& pair) const;
  [[nodiscard]] Basis basis_of(const std::vector<std::size_t>& list) const;
  [[nodiscard]] std::string scatters(const std::string& pair, const std::vector<std::size_t>& list,
                                     const Basis& basis) const;
  [[nodiscard]] std::string decisions(const std::string& pair,
                                      const std::vector<std::size_t>& list) const;
  [[nodiscard]] std::string families(const std::string& pair,
                                     const std::vector<std::size_t>& list) const;
  [[nodiscard]] std::string tables(const std::vector<std::size_t>& list) const;
  [[nodiscard]] std::string profile_section() const;
  [[nodiscard]] std::string tail() const;
  [[nodiscard]] Json entry(const SavedPipe& k) const;

  const SavedSweep& sweep_;
  const Target& target_;
  std::vector<std::string> pairs_;
};

std::string cost_kind(const Cost& cost) {
  if (!cost.lane) return cost.target.assumed_mhz ? "assumed" : "no cost";
  return cost.lane->estimated ? "estimated" : "measured";
}

std::string AccuracyPage::head() const {
  const std::string seeds =
      fmt::format("{} cases per configuration, seed {}", grouped(sweep_.cases), sweep_.seed);
  std::string html = fmt::format(
      "<main>\n<header><h1>What accuracy costs</h1>\n<p class=\"lead\">{} configurations of pair, "
      "number format, algorithm and iterations: {}. Errors compare with exact or certified "
      "arithmetic, and equal the card's, bit by bit. Times are modelled times of the "
      "device.</p></header>\n",
      sweep_.pipes.size(), seeds);
  html += fmt::format(
      "<p class=\"note\">u is the unit roundoff of the format, and S is the size of the pair, so u "
      "S is the error of rounding one length. An error in S is relative to the size of the pair, "
      "in any format. A decision is wrong only beyond the band |s| ≤ 16 u S. Half of the cases are "
      "aimed at hard decisions, so these shares are higher than in a scene. Costs are for {}: "
      "{}.</p>\n",
      escaped(target_.name),
      target_.assumed_mhz
          ? "one lane at an assumed clock, no device"
          : "lanes that fit into 85 % of its logic and registers and all of its multipliers, "
            "without the rest of a card. A <em>measured</em> lane was placed and routed. An "
            "<em>estimated</em> lane is the sum of its operators at the slowest of their clocks, "
            "without the delays between them");
  return html +
         "<div class=\"controls choose\" data-of=\"pair\" data-label=\"Pair\" hidden></div>\n"
         "<div class=\"controls formats\" role=\"group\" aria-label=\"Formats\" hidden></div>\n";
}

Basis AccuracyPage::basis_of(const std::vector<std::size_t>& list) const {
  for (const std::size_t i : list)
    if (!target_.assumed_mhz && sweep_.pipes[i].cost.seconds(1e6))
      return {
          true, fmt::format("modelled time of a million tests on {}", target_.name),
          fmt::format("Time is for the lanes that fit into {}, without transfers.", target_.name)};
  std::string why = target_.assumed_mhz ? "the clock is assumed and the area is unknown" : "";
  for (const std::size_t i : list) {
    const Cost& p = sweep_.pipes[i].cost;
    if (why.empty()) why = p.lane ? "no lane fits" : p.why_not;
  }
  return {false, "operators × bits × cycles per row",
          fmt::format("None of these has a cost on {} ({}). The axis is therefore a substitute for "
                      "time: operators of a lane, times bits of the format, times cycles per row.",
                      target_.name, why)};
}

std::string AccuracyPage::scatters(const std::string& pair, const std::vector<std::size_t>& list,
                                   const Basis& basis) const {
  std::string html;
  for (const bool relative : {true, false}) {
    std::vector<Mark> marks;
    std::vector<std::size_t> drawn;
    std::map<std::string, std::vector<std::string>> absent;  // by why
    for (const std::size_t i : list) {
      const SavedPipe& k = sweep_.pipes[i];
      const double unit = relative ? k.u() : 1, p999 = k.all.error(&Quantiles::p999);
      const std::optional<double> x = x_of(k, basis);
      if (!x || !(p999 > 0) || !std::isfinite(p999) || k.all.t.count == 0) {
        absent[x                ? "no error to show"
               : !basis.seconds ? "operators were not counted"
               : k.cost.lane    ? "a lane does not fit"
                                : k.cost.why_not]
            .push_back(short_name(k.pipe));
        continue;
      }
      const double most = k.all.error(&Quantiles::largest);
      Mark mark{.name = k.pipe.name(),
                .colour = colour_of(k.pipe.format),
                .letter = letter_of(k.pipe),
                .ring = k.pipe.box,
                .hollow = k.cost.lane && k.cost.lane->estimated,
                .x = *x,
                .y = unit * p999,
                .of = i};
      if (std::isfinite(most)) {
        mark.low = unit * k.all.error(&Quantiles::median);
        mark.high = unit * most;
      }
      marks.push_back(std::move(mark));
      drawn.push_back(i);
    }
    const std::string what = relative ? "error of T over S" : "error of T in u S";
    if (!marks.empty())
      html += log_scatter(
          fmt::format("{}: {} against {}", pair, what, basis.seconds ? "time" : "cost"),
          {basis.axis, fmt::format("{}, p99.9", what), basis.seconds}, marks, formats_of(drawn));
    if (relative)
      for (const auto& [why, names] : absent)
        html += fmt::format("<p class=\"note\">Not in the chart ({}): {}.</p>\n", escaped(why),
                            escaped(fmt::format("{}", fmt::join(names, ", "))));
    if (relative && !marks.empty())
      html +=
          "<h3>The same in u S</h3>\n<p>This shows how well the bits of a format are used. Far "
          "above 1, an answer has lost more than single roundings.</p>\n";
  }
  return html;
}

std::string AccuracyPage::decisions(const std::string& pair,
                                    const std::vector<std::size_t>& list) const {
  std::vector<MarkRow> rows, none;  // none: rows without an observed wrong decision
  for (const std::size_t i : list) {
    const SavedPipe& k = sweep_.pipes[i];
    if (k.all.judged == 0) continue;
    const Interval95 share = k.all.wrong_interval();
    Mark mark{.name = k.pipe.name(),
              .colour = colour_of(k.pipe.format),
              .hollow = k.all.wrong == 0,
              .y = k.all.wrong_per_million(),
              .low = share.low,
              .high = share.high,
              .of = i};
    (k.all.wrong == 0 ? none : rows)
        .push_back({short_name(k.pipe),
                    fmt::format("{} of {}", k.all.wrong, grouped(k.all.judged)),
                    {mark}});
  }
  if (rows.empty() && none.empty()) return "";
  const auto chart = [&](const std::string& what, const std::vector<MarkRow>& some) {
    return some.empty() ? ""
                        : log_rows(fmt::format("{}: {}", pair, what), "wrong decisions per million",
                                   some, formats_of(list));
  };
  std::string html =
      "<h3>Wrong decisions per million</h3>\n<p>Decisions beyond the band. The line is the 95 % "
      "confidence interval. Hollow: none was found.</p>\n" +
      chart("wrong decisions per million", rows);
  if (!none.empty())
    html += fmt::format(
        "<details><summary>{} configuration{} without an observed wrong decision</summary>\n{}"
        "</details>\n",
        none.size(), none.size() == 1 ? "" : "s", chart("no wrong decision observed", none));
  return html;
}

std::string AccuracyPage::families(const std::string& pair,
                                   const std::vector<std::size_t>& list) const {
  std::vector<MarkRow> rows;
  for (const std::size_t i : list) {
    const SavedPipe& k = sweep_.pipes[i];
    for (const SavedTally& t : k.families) {
      const double p999 = t.error(&Quantiles::p999);
      if (t.t.count == 0 || !(p999 > 0) || !std::isfinite(p999)) continue;
      auto row = std::ranges::find(rows, t.family, &MarkRow::name);
      if (row == rows.end()) row = rows.insert(rows.end(), {t.family, "", {}});
      row->marks.push_back({.name = k.pipe.name(),
                            .colour = colour_of(k.pipe.format),
                            .ring = false,
                            .x = 0,
                            .y = p999,
                            .of = i});
    }
  }
  if (rows.empty()) return "";
  return "<h3>Error by family of cases</h3>\n<p>p99.9 of T in u S. It shows where errors come "
         "from.</p>\n" +
         log_rows(pair + ": error by family", "error of T in u S, p99.9", rows, formats_of(list));
}

std::string AccuracyPage::tables(const std::vector<std::size_t>& list) const {
  Rows errors, costs, cases;
  for (const std::size_t i : list) {
    const SavedPipe& k = sweep_.pipes[i];
    const std::string name = short_name(k.pipe);
    const auto figures = [&](Rows& rows, const std::vector<std::string>& texts) {
      std::vector<Cell> row = {name};
      for (const std::string& text : texts) row.push_back(Cell::figure(text));
      rows.push_back(std::move(row));
    };
    figures(errors,
            {error_text(k.all, &Quantiles::p999, k.u()), error_text(k.all, &Quantiles::median),
             error_text(k.all, &Quantiles::p99), error_text(k.all, &Quantiles::p999),
             error_text(k.all, &Quantiles::largest), wrong_text(k.all),
             k.all.leak_rays == 0 ? std::string("-")
                                  : fmt::format("{}/{}", k.all.leaks, k.all.leak_rays)});
    const Cost& p = k.cost;
    const auto lane = [&](double CellCounts::*cells) {
      return p.lane ? grouped(static_cast<std::uint64_t>(p.lane->cells.*cells)) : "-";
    };
    const std::optional<double> seconds = p.seconds(1e6);
    figures(costs, {k.figures.operators ? grouped(k.figures.operators->total()) : "-",
                    k.figures.interval ? grouped(*k.figures.interval) : "-", lane(&CellCounts::lut),
                    lane(&CellCounts::ff), lane(&CellCounts::dsp),
                    p.mhz() ? fmt::format("{:.1f}", *p.mhz()) : "-",
                    p.mhz() ? grouped(p.lanes()) : "-", seconds ? duration(*seconds) : "-"});
    costs.back().emplace_back(cost_kind(p));
    for (const auto& [what, worst] : {std::pair{"T", &k.all.worst_t},
                                      {"decision", &k.all.worst_decision},
                                      {"leak", &k.all.worst_leak}}) {
      if (!*worst) continue;
      Cell command("");
      command.html = fmt::format("<code>{}</code>", escaped((*worst)->command));
      cases.push_back({name, what, (*worst)->family, Cell::figure(grouped((*worst)->index)),
                       Cell::figure(compact((*worst)->size)), command});
    }
  }
  return "<h3>All figures</h3>\n" +
         table(
             "T in u S, in the first column over S; wrong decisions per million with 95 % "
             "confidence",
             {"configuration", "p99.9 over S", "T p50", "p99", "p99.9", "max", "wrong/M", "leaks"},
             errors) +
         table(fmt::format(
                   "Costs of a lane on {}; modelled time of a million tests on the lanes that fit",
                   target_.name),
               {"configuration", "operators", "cycles per row", "LUT", "FF", "DSP", "MHz", "lanes",
                "million tests", "cost"},
               costs) +
         "<details><summary>Worst cases, with the commands that repeat them</summary>" +
         table("Sizes in u S", {"configuration", "value", "family", "case", "size", "command"},
               cases) +
         "</details>\n";
}

std::string AccuracyPage::pair_section(const std::string& pair) const {
  const std::vector<std::size_t> list = of(pair);
  const Basis basis = basis_of(list);
  std::string html =
      fmt::format("<section data-choice=\"pair\" data-name=\"{0}\"><h2>{0}</h2>\n", pair);
  html += fmt::format(
      "<h3>Accuracy against {}</h3>\n<p>{} A dot is the p99.9 of T's error; its line goes from the "
      "median to the largest error. Dark line: best trade-offs{}. Select a dot for its figures and "
      "commands.{}</p>\n",
      basis.seconds ? "time" : "cost", escaped(basis.words),
      basis.seconds ? ". Solid dots are measured; hollow dots are estimates (optimistic: without "
                      "the delays between operators)"
                    : "",
      pair == "ray-triangle"
          ? " Letters: M Möller, B Badouel, P Plücker, W watertight. A ring: with the box rule."
          : "");
  html += scatters(pair, list, basis);
  html += "<div class=\"chosen\" aria-live=\"polite\" hidden></div>\n";
  return html + decisions(pair, list) + families(pair, list) + tables(list) + "</section>\n";
}

std::string AccuracyPage::profile_section() const {
  const auto at = sweep_.json.find("profiles");
  if (at == sweep_.json.end() || at->empty()) return "";
  std::vector<std::string> formats;
  for (const Json& p : *at) {
    const auto format = p.at("format").get<std::string>();
    if (std::ranges::find(formats, format) == formats.end()) formats.push_back(format);
  }
  std::string html =
      "<section id=\"profiles\"><h2>ray-triangle: where errors come from</h2>\n<p>Each chart "
      "varies one parameter. Rays of length 1 from well above aim at the inside of a triangle of "
      "size 0.5 near the world's origin. The error is |t − T| / T, for rays that hit their "
      "triangle in exact arithmetic. Solid lines: p99. Dashed lines: median. A hole: no error, or "
      "too few hits.</p>\n<div class=\"controls choose\" data-of=\"format\" data-label=\"Format\" "
      "data-first=\"fp32\" hidden></div>\n";
  for (const std::string& format : formats) {
    html += fmt::format("<div data-choice=\"format\" data-name=\"{0}\"><h3>{0}</h3>\n",
                        escaped(format));
    for (const ProfileAxis& axis : profile_axes()) {
      std::vector<Line> lines;
      int colour = 0;
      for (const Json& p : *at) {
        if (p.at("format") != format || p.at("along") != axis.name) continue;
        for (const bool median : {false, true}) {
          Line line{.name = p.at("algorithm").get<std::string>() + (median ? ", median" : ", p99"),
                    .colour = colour,
                    .dashed = median,
                    .x = {},
                    .y = {}};
          for (const Json& point : p.at("profile_points")) {
            const Json& y = point.at(median ? "median" : "p99");
            line.x.push_back(point.at("axis_value"));
            line.y.push_back(y.is_null() ? NAN : y.get<double>());
          }
          lines.push_back(std::move(line));
        }
        ++colour;
      }
      if (lines.empty()) continue;
      html += fmt::format("<h4>{}</h4>\n{}", axis.title,
                          log_log_lines(fmt::format("{}, {}", axis.title, format), axis.x_name,
                                        "relative error of T", lines));
    }
    html += "</div>\n";
  }
  return html + "</section>\n";
}

std::string AccuracyPage::tail() const {
  Rows rows = {{"target", target_.name}};
  const auto text = [](const Json& v) {
    return v.is_string() ? v.get<std::string>() : json_text(v, -1);
  };
  for (const char* key : {"version", "commit", "seed", "cases"})
    if (sweep_.json.contains(key)) rows.push_back({key, text(sweep_.json.at(key))});
  const Json machine = sweep_.json.value("machine", Json::object());
  for (const auto& [key, value] : machine.items()) rows.push_back({key, text(value)});
  return fmt::format(
      "<section><h2>Made with</h2>\n{}</section>\n</main>\n",
      table("Errors and decisions depend only on the seed, not on the machine", {}, rows));
}

Json AccuracyPage::entry(const SavedPipe& k) const {
  const SavedTally& t = k.all;
  const Cost& p = k.cost;
  Json figures = Json::array();
  const auto add = [&](const char* name, const std::string& value) {
    figures.push_back({name, value});
  };
  add("error of T, p99.9, over S", error_text(t, &Quantiles::p999, k.u()));
  add("error of T, largest, over S", error_text(t, &Quantiles::largest, k.u()));
  add("error of T in u S: p50, p99, p99.9, largest",
      fmt::format("{}, {}, {}, {}", error_text(t, &Quantiles::median),
                  error_text(t, &Quantiles::p99), error_text(t, &Quantiles::p999),
                  error_text(t, &Quantiles::largest)));
  add("wrong decisions",
      fmt::format("{} of {}; {} per million", t.wrong, grouped(t.judged), wrong_text(t)));
  if (t.leak_rays > 0) add("leaks", fmt::format("{} of {} rays", t.leaks, grouped(t.leak_rays)));
  if (k.figures.operators)
    add("operators per lane",
        fmt::format("{} sums, {} products, {} quotients, {} roots, {} comparisons",
                    k.figures.operators->add, k.figures.operators->mul, k.figures.operators->div,
                    k.figures.operators->sqrt, k.figures.operators->cmp));
  add("clock", p.clock_source());
  if (p.lane) {
    add(p.lane->estimated ? "area per lane, estimated" : "area per lane, measured",
        fmt::format("{} LUT, {} carry, {} FF, {} DSP",
                    grouped(static_cast<std::uint64_t>(p.lane->cells.lut)),
                    grouped(static_cast<std::uint64_t>(p.lane->cells.carry)),
                    grouped(static_cast<std::uint64_t>(p.lane->cells.ff)),
                    grouped(static_cast<std::uint64_t>(p.lane->cells.dsp))));
    add("from", p.lane->of);
    add("lanes that fit",
        fmt::format("{} ({} runs out first)", p.lane->fit.lanes, p.lane->fit.limit));
  }
  if (const auto seconds = p.seconds(1e6))
    add("million tests, modelled",
        fmt::format("{} on {} lane{}", duration(*seconds), p.lanes(), p.lanes() == 1 ? "" : "s"));
  Json commands = Json::array();
  commands.push_back({"Measure it again", sweep_.command(k.pipe)});
  for (const auto& [what, worst] :
       {std::pair{"T", &t.worst_t}, {"a decision", &t.worst_decision}, {"a leak", &t.worst_leak}})
    if (*worst)
      commands.push_back({fmt::format("Worst of {}: {} u S, {}, case {}", what,
                                      compact((*worst)->size), (*worst)->family, (*worst)->index),
                          (*worst)->command});
  return {{"name", k.pipe.name()},
          {"format", k.pipe.format.name()},
          {"figures", figures},
          {"commands", commands}};
}

}  // namespace

std::string accuracy_html(const SavedSweep& sweep, const Target& target) {
  return AccuracyPage(sweep, target).html();
}

}  // namespace cde::cli
