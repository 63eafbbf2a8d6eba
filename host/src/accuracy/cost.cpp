// SPDX-License-Identifier: Apache-2.0
#include "cde/accuracy/cost.hpp"
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "cde/support/error.hpp"

namespace cde::accuracy {
namespace {

using Json = nlohmann::ordered_json;

PipeChoice choice_of(const AccuracyPipe& p) {
  return {p.pair, p.algorithm, p.box, p.format, p.iterations};
}

template <class T>
Json known(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}

}  // namespace

unsigned Cost::lanes() const {
  if (target.assumed_mhz) return 1;
  return lane ? lane->fit.lanes : 0;
}

std::optional<double> Cost::mhz() const {
  if (target.assumed_mhz) return target.assumed_mhz;
  return lane ? std::optional(lane->mhz) : std::nullopt;
}

std::optional<double> Cost::seconds(double tests, unsigned on_lanes) const {
  if (!mhz() || on_lanes == 0 || !figures.latency || !figures.interval) return std::nullopt;
  const double rows = std::ceil(tests / on_lanes),
               latency = static_cast<double>(*figures.latency) * (lane ? lane->longest : 1);
  return ((rows - 1) * *figures.interval + latency) / (1e6 * *mhz());
}

std::string Cost::clock_source() const {
  if (target.assumed_mhz)
    return fmt::format("{:g} MHz, an assumption about the device, not a measurement",
                       *target.assumed_mhz);
  if (!lane) return "not known: " + why_not;
  return fmt::format(
      "{:.1f} MHz on {}, {}", lane->mhz, target.name,
      lane->estimated ? "estimated: the slowest of its operators" : "measured for the whole lane");
}

Json Cost::to_json() const {
  const PipeFigures& f = figures;
  Json by_kind;
  if (f.operators)
    by_kind = {{"add", f.operators->add},
               {"mul", f.operators->mul},
               {"div", f.operators->div},
               {"sqrt", f.operators->sqrt},
               {"compare", f.operators->cmp}};
  const auto of_lane = [&](auto member) { return lane ? Json((*lane).*member) : Json(); };
  const auto cells = [&](double CellCounts::*member) {
    return lane ? Json(lane->cells.*member) : Json();
  };
  return {{"latency_levels", known(f.latency)},
          {"initiation_interval", known(f.interval)},
          {"operator_count", f.operators ? Json(f.operators->total()) : Json()},
          {"operators_by_kind", by_kind},
          {"modelled_cycles_per_million", known(f.cycles_per_million())},
          {"luts", cells(&CellCounts::lut)},
          {"carries", cells(&CellCounts::carry)},
          {"registers", cells(&CellCounts::ff)},
          {"dsps", cells(&CellCounts::dsp)},
          {"fmax_mhz", of_lane(&LaneCost::mhz)},
          {"area_of", lane ? Json(target.name) : Json()},
          {"estimated", of_lane(&LaneCost::estimated)},
          {"lanes_that_fit", lane ? Json(lane->fit.lanes) : Json()},
          {"lanes_limit", lane ? Json(lane->fit.limit) : Json()},
          {"clock_source", clock_source()},
          {"modelled_lanes", lanes()},
          {"modelled_seconds_per_million", known(seconds(1e6))}};
}

std::vector<PipeFigures> figures_of(const std::vector<AccuracyPipe>& pipes, bool elaborate) {
  std::vector<PipeFigures> all(pipes.size());
  std::vector<PipeChoice> in_rtl;  // other variants have no RTL
  for (const AccuracyPipe& p : pipes)
    if (p.variant == Variant::kCard) in_rtl.push_back(choice_of(p));
  if (!elaborate) return all;
  const std::vector<PipeFigures> found = figures_of(in_rtl);
  std::size_t next = 0;
  for (std::size_t i = 0; i < pipes.size(); ++i)
    if (pipes[i].variant == Variant::kCard) all[i] = found[next++];
  return all;
}

Cost cost_of(const AccuracyPipe& pipe, const PipeFigures& figures, const Target& target,
             const CostTable& table) {
  Cost cost{.figures = figures, .target = target};
  if (target.assumed_mhz) {
    cost.why_not = "the clock is assumed";
    return cost;
  }
  if (pipe.variant != Variant::kCard) {
    cost.why_not = "it has no RTL";
    return cost;
  }
  LaneCostOr found = table.lane(costed(choice_of(pipe), figures), target.name);
  cost.lane = std::move(found.cost), cost.why_not = std::move(found.why_not);
  return cost;
}

}  // namespace cde::accuracy
