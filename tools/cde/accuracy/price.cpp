// SPDX-License-Identifier: Apache-2.0
#include "accuracy/price.hpp"
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "cde/contract/pairs.hpp"
#include "cde/reference/pairs.hpp"
#include "cde/support/error.hpp"
#include "output/streams.hpp"
#include "rtl/pipe_figures.hpp"

namespace cde::cli {
namespace {

using Json = nlohmann::ordered_json;

/// Clocks in which a pair is brought to the size of one, and its answer back (length_scale.sv,
/// length_unscale.sv), around the pipe that is the same in all formats. A ring has them in it.
unsigned scaling_clocks(const AccuracyPipe& pipe) {
  const bool scaled = pipe.format.exp_bits < 8 || contract::has(contract::kScaledPairs, pipe.pair);
  return scaled && !has_budget(pipe.pair) ? 3 : 0;
}

PipeFigures figures_of(const AccuracyPipe& pipe, const rtl::Pipe& in_rtl) {
  const rtl::Operators& o = in_rtl.operators;
  PipeFigures figures;
  figures.operators = {.add = o.adders + o.subtractors,
                       .mul = o.multipliers,
                       .div = o.dividers,
                       .sqrt = o.square_roots,
                       .cmp = o.comparators + o.min_max};
  figures.latency = in_rtl.latency + scaling_clocks(pipe), figures.interval = in_rtl.interval;
  if (!has_budget(pipe.pair)) return figures;
  // A row goes round as often as its budget says.
  const unsigned passes = reference::passes(pipe.pair, pipe.budget),
                 usual = reference::passes(pipe.pair, {});
  figures.interval = passes;
  figures.latency = in_rtl.latency + (passes - usual) * in_rtl.ring;
  return figures;
}

PricedPipe priced(const AccuracyPipe& pipe, const PipeFigures& figures) {
  return {pipe.pair, pipe.algorithm, pipe.box, pipe.format, figures.operators};
}

template <class T>
Json known(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}

}  // namespace

std::optional<double> PipeFigures::clocks_per_million() const {
  if (!latency || !interval) return std::nullopt;
  return 1e6 * *interval + *latency - *interval;
}

unsigned Price::lanes() const {
  if (target.assumed_mhz) return 1;
  return lane ? lane->fit.lanes : 0;
}

std::optional<double> Price::mhz() const {
  if (target.assumed_mhz) return target.assumed_mhz;
  return lane ? std::optional(lane->mhz) : std::nullopt;
}

std::optional<double> Price::seconds(double tests, unsigned on_lanes) const {
  if (!mhz() || on_lanes == 0 || !figures.latency || !figures.interval) return std::nullopt;
  const double rows = std::ceil(tests / on_lanes),
               latency = static_cast<double>(*figures.latency) * (lane ? lane->longest : 1);
  return ((rows - 1) * *figures.interval + latency) / (1e6 * *mhz());
}

std::string Price::clock_is() const {
  if (target.assumed_mhz)
    return fmt::format("{:g} MHz, an assumption about the device, not a measurement",
                       *target.assumed_mhz);
  if (!lane) return "not known: " + why_not;
  return fmt::format(
      "{:.1f} MHz on {}, {}", lane->mhz, target.name,
      lane->estimated ? "estimated: the least of its operators" : "measured of the whole lane");
}

Json Price::to_json() const {
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
          {"modelled_clocks_per_million", known(f.clocks_per_million())},
          {"luts", cells(&CellCounts::lut)},
          {"carries", cells(&CellCounts::carry)},
          {"registers", cells(&CellCounts::ff)},
          {"dsps", cells(&CellCounts::dsp)},
          {"fmax_mhz", of_lane(&LanePrice::mhz)},
          {"area_of", lane ? Json(target.name) : Json()},
          {"estimated", of_lane(&LanePrice::estimated)},
          {"lanes_that_fit", lane ? Json(lane->fit.lanes) : Json()},
          {"lanes_limit", lane ? Json(lane->fit.limit) : Json()},
          {"clock_is", clock_is()},
          {"modelled_lanes", lanes()},
          {"modelled_seconds_per_million", known(seconds(1e6))}};
}

std::vector<PipeFigures> figures_of(const std::vector<AccuracyPipe>& pipes, bool elaborate) {
  std::vector<PipeFigures> all(pipes.size());
  if (!elaborate) return all;
  std::vector<rtl::Pipe> wanted;
  std::vector<std::size_t> which;
  for (const AccuracyPipe& p : pipes) {
    if (p.variant != Variant::kCard) {
      which.push_back(SIZE_MAX);  // of which there is no RTL
      continue;
    }
    std::size_t k = 0;
    while (k < wanted.size() && !(wanted[k].pair == p.pair && wanted[k].algorithm == p.algorithm &&
                                  wanted[k].box == p.box))
      ++k;
    if (k == wanted.size())
      wanted.push_back({.pair = p.pair, .algorithm = p.algorithm, .absent = "", .box = p.box});
    which.push_back(k);
  }
  try {
    rtl::examine_all(wanted, {});
  } catch (const Error& e) {
    say("cde: clocks and operators are not known: {}\n", e.what());
    return all;
  }
  for (std::size_t i = 0; i < pipes.size(); ++i)
    if (which[i] != SIZE_MAX && wanted[which[i]].absent.empty())
      all[i] = figures_of(pipes[i], wanted[which[i]]);
  return all;
}

Price price_of(const AccuracyPipe& pipe, const PipeFigures& figures, const Target& target,
               const PriceTable& table) {
  Price price{.figures = figures, .target = target};
  if (target.assumed_mhz) {
    price.why_not = "the clock is assumed";
    return price;
  }
  if (pipe.variant != Variant::kCard) {
    price.why_not = "there is no RTL of it";
    return price;
  }
  LanePriceOr found = table.lane(priced(pipe, figures), target.name);
  price.lane = std::move(found.price), price.why_not = std::move(found.why_not);
  return price;
}

CardClock clock_on(const Target& target, const std::vector<AccuracyPipe>& pipes,
                   const OperatorClocks& clocks) {
  if (target.assumed_mhz)
    return {*target.assumed_mhz, "an assumption about the device, not a measurement"};
  const PriceTable table = PriceTable::of_project();
  const std::vector<PipeFigures> figures = figures_of(pipes, true);
  CardClock least{0, ""};
  for (std::size_t i = 0; i < pipes.size(); ++i) {
    const LanePriceOr found = table.lane(priced(pipes[i], figures[i]), target.name, clocks);
    if (!found.price)
      throw Error(ErrorCode::kUsage,
                  fmt::format("--target {}: no clock of {}: {}; {}", target.name, pipes[i].name(),
                              found.why_not, table.rows_of(target.name)));
    if (!least.is.empty() && found.price->mhz >= least.mhz) continue;
    least = {found.price->mhz,
             fmt::format("of {} on {}, {}", pipes[i].name(), target.name,
                         found.price->estimated ? "estimated: the least of its operators"
                                                : "measured of the whole lane")};
  }
  return least;
}

}  // namespace cde::cli
