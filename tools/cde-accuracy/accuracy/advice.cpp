// SPDX-License-Identifier: Apache-2.0
#include "accuracy/advice.hpp"
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "accuracy/accuracy_report.hpp"
#include "cde/support/counted.hpp"
#include "page/page.hpp"

namespace cde::cli {
namespace {

constexpr unsigned kMostLanes = 256;  // lanes of a card
constexpr std::size_t kMisses = 3;

/// The number of cases without a wrong decision that shows at most `per_million` wrong decisions
/// per million.
std::uint64_t cases_to_show(double per_million) {
  constexpr double kZ2 = 3.841458820694124;  // as in wilson(), with no wrong decision
  return static_cast<std::uint64_t>(std::ceil(std::min(kZ2 * (1e6 / per_million - 1), 1e18)));
}

std::string quantile_name(const Demands& d) {
  return d.quantile == &Quantiles::largest ? "largest"
         : d.quantile == &Quantiles::p99   ? "p99"
                                           : "p99.9";
}

double error_of(const SavedPipe& k, const Demands& d) {
  return k.u() * k.all.error(d.quantile);
}

void check_error(Candidate& c, const Demands& d) {
  if (!d.max_error) return;
  if (c.of->all.t.count == 0) {
    c.unmet.push_back({"error", "no T was judged", std::numeric_limits<double>::infinity()});
    return;
  }
  const double error = error_of(*c.of, d);
  if (error > *d.max_error)
    c.unmet.push_back({"error",
                       fmt::format("error {} of S ({}); at most {} demanded", compact(error),
                                   quantile_name(d), compact(*d.max_error)),
                       error / *d.max_error});
}

void check_decisions(Candidate& c, const Demands& d) {
  const SavedTally& t = c.of->all;
  if (d.no_leaks && t.leak_rays == 0)
    c.unmet.push_back(
        {"leaks", "leaks were not measured", std::numeric_limits<double>::infinity()});
  if (d.no_leaks && t.leaks > 0)
    c.unmet.push_back({"leaks", fmt::format("{} of {} leak", t.leaks, counted(t.leak_rays, "ray")),
                       1 + static_cast<double>(t.leaks)});
  if (!d.max_wrong) return;
  if (t.judged == 0) {
    c.unmet.push_back(
        {"decisions", "no decision was judged", std::numeric_limits<double>::infinity()});
    return;
  }
  const double wrong = d.sure ? t.wrong_interval().high : t.wrong_per_million();
  if (wrong <= *d.max_wrong) return;
  const std::string may_be =
      fmt::format("{} of {} decisions wrong, {}..{} per million", t.wrong, grouped(t.judged),
                  compact(t.wrong_interval().low), compact(t.wrong_interval().high));
  c.unmet.push_back({"decisions",
                     fmt::format("{}; at most {} demanded{}", may_be, compact(*d.max_wrong),
                                 d.sure ? " for sure" : ""),
                     wrong / std::max(*d.max_wrong, 1e-3)});
}

/// Chooses the fewest lanes that run the tests in time, or the most that are possible.
void choose_lanes(Candidate& c, const Demands& d) {
  const Cost& cost = c.of->cost;
  const unsigned most = cost.target.assumed_mhz ? kMostLanes
                        : cost.lane             ? std::min(kMostLanes, cost.lane->fit.lanes)
                                                : 0;
  if (most == 0) {
    c.lanes = 0;
    c.unmet.push_back(
        {"area",
         cost.lane ? fmt::format("a lane does not fit into {}: it needs {:.0f} % of the usable {}",
                                 cost.target.name, 100 * cost.lane->fit.share, cost.lane->fit.limit)
                   : fmt::format("it is unknown whether a lane fits into {}: {}", cost.target.name,
                                 cost.why_not),
         cost.lane ? cost.lane->fit.share : std::numeric_limits<double>::infinity()});
    return;
  }
  c.seconds = cost.seconds(d.tests, c.lanes);
  if (!d.seconds) return;
  while (c.seconds && *c.seconds > *d.seconds && 2 * c.lanes <= most)
    c.seconds = cost.seconds(d.tests, c.lanes *= 2);
  if (!c.seconds)
    c.unmet.push_back({"time", "time is unknown: cycles were not counted",
                       std::numeric_limits<double>::infinity()});
  else if (*c.seconds > *d.seconds)
    c.unmet.push_back({"time",
                       fmt::format("{} on {} lane{}; at most {} demanded", duration(*c.seconds),
                                   c.lanes, c.lanes == 1 ? "" : "s", duration(*d.seconds)),
                       *c.seconds / *d.seconds});
}

void set_cost(Candidate& c) {
  const Cost& cost = c.of->cost;
  const unsigned lanes = std::max(1u, c.lanes);
  c.area_known = cost.lane.has_value();
  const OperatorCounts operators = c.of->figures.operators.value_or(OperatorCounts{});
  c.cost =
      lanes * (c.area_known ? cost.lane->fit.share
                            : static_cast<double>(operators.total()) * c.of->pipe.format.width());
}

double distance(const Candidate& c) {
  double sum = 0;
  for (const Unmet& u : c.unmet) sum += std::log(u.factor);
  return sum;
}

/// A line of the answer.
std::string line(const char* name, const std::string& text) {
  return fmt::format("  {:<10} {}\n", name, text);
}

std::string cost_text(const Candidate& c) {
  const Cost& p = c.of->cost;
  if (!p.lane) {
    if (!c.of->figures.operators)
      return fmt::format("area is unknown ({}), and operators were not counted; not ranked",
                         p.why_not);
    return fmt::format("area is unknown ({}); ranked by operators times bits, {} x {} per lane",
                       p.why_not, c.of->figures.operators->total(), c.of->pipe.format.width());
  }
  const CellCounts& a = p.lane->cells;
  const std::string lanes = c.lanes == 0 ? "one lane"
                                         : fmt::format("{} lane{} of {} that fit", c.lanes,
                                                       c.lanes == 1 ? "" : "s", p.lane->fit.lanes);
  return fmt::format(
      "{}: {:.0f} LUT, {:.0f} carry, {:.0f} FF, {:.0f} DSP per lane; {}, {:.1f} % of the usable {} "
      "({})",
      p.lane->estimated ? "estimated" : "measured", a.lut, a.carry, a.ff, a.dsp, lanes,
      100 * std::max(1u, c.lanes) * p.lane->fit.share, p.lane->fit.limit, p.lane->of);
}

/// "; excluded: 14 by area, 3 by error"; empty if no candidate is excluded.
std::string why_out(const std::vector<Candidate>& all) {
  std::map<std::string_view, std::size_t> out;
  for (const Candidate& c : all)
    for (const Unmet& u : c.unmet) ++out[u.what];
  std::string text;
  for (const auto& [what, count] : out)
    text += fmt::format("{}{} by {}", text.empty() ? "; excluded: " : ", ", count, what);
  return text;
}

std::string figures_text(const SavedSweep& sweep, const Demands& d, const Candidate& c) {
  const SavedPipe& k = *c.of;
  const SavedTally& t = k.all;
  const auto asked = [](const std::optional<double>& limit) {
    return limit ? fmt::format("; at most {} demanded", compact(*limit)) : "";
  };
  std::string text =
      t.t.count == 0 ? line("error", "no T was judged")
                     : line("error", fmt::format("{} of S ({}{}), {} u S; largest {} of S",
                                                 compact(error_of(k, d)), quantile_name(d),
                                                 asked(d.max_error), compact(t.error(d.quantile)),
                                                 compact(k.u() * t.error(&Quantiles::largest))));
  const Interval95 wrong = t.wrong_interval();
  std::string decisions =
      fmt::format("{} of {} wrong, {}..{} per million with 95 % confidence{}", t.wrong,
                  grouped(t.judged), compact(wrong.low), compact(wrong.high), asked(d.max_wrong));
  if (d.max_wrong && *d.max_wrong > 0 && wrong.high > *d.max_wrong)
    decisions += fmt::format("; to show this takes {} cases without a wrong decision",
                             grouped(cases_to_show(*d.max_wrong)));
  text += line("decisions", t.judged == 0 ? "none was judged" : decisions);
  if (t.leak_rays > 0)
    text += line("leaks", fmt::format("{} of {}", t.leaks, counted(t.leak_rays, "ray")));
  text += line("area", cost_text(c));
  text += line("clock", k.cost.clock_source());
  if (c.seconds)
    text += line(
        "time",
        fmt::format("{} for {} tests on {}, modelled, without transfers{}", duration(*c.seconds),
                    grouped(static_cast<std::uint64_t>(d.tests)), counted(c.lanes, "lane"),
                    d.seconds ? "; at most " + duration(*d.seconds) + " demanded" : ""));
  text += fmt::format("commands\n  {}\n  cde query {} < PAIRS\n", sweep.command(k.pipe),
                      k.pipe.options());
  if (t.worst_t) text += fmt::format("  {}  # worst T\n", t.worst_t->command);
  if (t.worst_decision) text += fmt::format("  {}  # worst decision\n", t.worst_decision->command);
  if (t.worst_leak) text += fmt::format("  {}  # worst leak\n", t.worst_leak->command);
  return text;
}

}  // namespace

std::vector<Candidate> advise(const SavedSweep& sweep, const Demands& demands) {
  std::vector<Candidate> all;
  for (const SavedPipe& k : sweep.pipes) {
    if (k.pipe.pair != demands.pair || k.pipe.variant != Variant::kCard) continue;
    Candidate c{.of = &k};
    check_error(c, demands);
    check_decisions(c, demands);
    choose_lanes(c, demands);
    set_cost(c);
    all.push_back(std::move(c));
  }
  std::stable_sort(all.begin(), all.end(), [](const Candidate& a, const Candidate& b) {
    const auto key = [](const Candidate& c) {
      return std::tuple(c.unmet.size(), distance(c), !c.area_known, c.cost,
                        c.seconds.value_or(std::numeric_limits<double>::infinity()));
    };
    return key(a) < key(b);
  });
  return all;
}

std::string advice_text(const SavedSweep& sweep, const Demands& demands, const Target& target,
                        const std::vector<Candidate>& all) {
  const auto meet = static_cast<std::size_t>(
      std::ranges::count_if(all, [](const Candidate& c) { return c.unmet.empty(); }));
  if (meet > 0)
    return fmt::format("{} on {}: the cheapest of {} that {}, of {}{}\n{}{}",
                       all.front().of->pipe.name(), target.name, meet,
                       demands.none() ? (meet == 1 ? "fits" : "fit")
                                      : (meet == 1 ? "meets the demands" : "meet the demands"),
                       all.size(), why_out(all),
                       demands.none() ? "the only demand was that a lane fits (further demands: "
                                        "--max-error, --max-wrong, --no-leaks, --time)\n"
                                      : "",
                       figures_text(sweep, demands, all.front()));
  std::string text =
      fmt::format("none of {} of {} meets the demands on {}; nearest:\n",
                  counted(all.size(), "configuration"), name(demands.pair), target.name);
  for (std::size_t i = 0; i < std::min(kMisses, all.size()); ++i) {
    text += fmt::format("  {}\n", all[i].of->pipe.name());
    for (const Unmet& u : all[i].unmet) text += fmt::format("    {}\n", u.text);
  }
  return text + fmt::format("figures of the nearest, {}\n{}", all.front().of->pipe.name(),
                            figures_text(sweep, demands, all.front()));
}

nlohmann::ordered_json advice_json(const SavedSweep& sweep, const Demands& demands,
                                   const std::vector<Candidate>& all) {
  using Json = nlohmann::ordered_json;
  // An infinite figure is null, because JSON has no infinity.
  const auto number = [](double x) { return std::isfinite(x) ? Json(x) : Json(); };
  Json candidates = Json::array();
  for (const Candidate& c : all) {
    const SavedPipe& k = *c.of;
    const Interval95 wrong = k.all.wrong_interval();
    Json one = {
        {"pipe", k.pipe.name()},
        {"meets", c.unmet.empty()},
        {"lacks", Json::array()},
        {"error_over_size", k.all.t.count == 0 ? Json() : number(error_of(k, demands))},
        {"wrong_per_million", k.all.judged == 0 ? Json() : number(k.all.wrong_per_million())},
        {"wrong_per_million_95", {number(wrong.low), number(wrong.high)}},
        {"leak_rays", k.all.leak_rays},
        {"leaks", share_json(k.all.leaks, k.all.leak_rays)},
        {"lanes", c.lanes},
        {"modelled_seconds", c.seconds ? number(*c.seconds) : Json()},
        {"share_of_target", c.area_known ? number(c.cost) : Json()},
        {"estimated", c.area_known ? Json(k.cost.lane->estimated) : Json()},
        {"clock_source", k.cost.clock_source()},
        {"command", sweep.command(k.pipe)}};
    for (const Unmet& u : c.unmet) one["lacks"].push_back(u.text);
    candidates.push_back(std::move(one));
  }
  return candidates;
}

}  // namespace cde::cli
