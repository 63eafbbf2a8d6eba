// SPDX-License-Identifier: Apache-2.0
#include "accuracy/price.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "cde/bitstream/bitstream.hpp"
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

void add_figures(std::vector<Price>& prices, const std::vector<AccuracyPipe>& pipes) {
  std::vector<rtl::Pipe> wanted;
  std::vector<std::size_t> which;
  for (const AccuracyPipe& p : pipes) {
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
    return;
  }
  for (std::size_t i = 0; i < pipes.size(); ++i) {
    const rtl::Pipe& pipe = wanted[which[i]];
    if (!pipe.absent.empty()) continue;
    const rtl::Operators& o = pipe.operators;
    Price& price = prices[i];
    price.operators = o.adders + o.subtractors + o.multipliers + o.dividers + o.square_roots +
                      o.comparators + o.min_max;
    price.latency = pipe.latency + scaling_clocks(pipes[i]), price.interval = pipe.interval;
    if (!has_budget(pipe.pair)) continue;
    // A row goes round as often as its budget says.
    const unsigned passes = reference::passes(pipe.pair, pipes[i].budget),
                   usual = reference::passes(pipe.pair, {});
    price.interval = passes;
    price.latency = pipe.latency + (passes - usual) * pipe.ring;
  }
}

std::optional<double> number(const Json& row, const char* key) {
  const auto at = row.find(key);
  return at == row.end() || !at->is_number() ? std::nullopt : std::optional(at->get<double>());
}

/// Of a row's clock rates, one a seed, that in the middle; nothing of a target whose area alone is
/// known.
std::optional<double> median_rate(const Json& row) {
  std::vector<double> rates;
  const auto all = row.find("fmax");
  if (all == row.end() || !all->is_object()) return std::nullopt;
  for (const Json& rate : *all)
    if (rate.is_number()) rates.push_back(rate.get<double>());
  if (rates.empty()) return std::nullopt;
  std::sort(rates.begin(), rates.end());
  return rates[(rates.size() - 1) / 2];
}

/// Rows are of pipes without the box rule.
bool is_of(const Json& row, const AccuracyPipe& pipe) {
  const auto is = [&](const char* key, const Json& value) {
    const auto at = row.find(key);
    return at != row.end() && *at == value;
  };
  if (!is("what", name(pipe.pair)) || !is("style", "cde") || !is("format", pipe.format.name()))
    return false;
  return pipe.pair != Pair::kRayTriangle || (is("algorithm", name(pipe.algorithm)) && !pipe.box);
}

void add_area(std::vector<Price>& prices, const std::vector<AccuracyPipe>& pipes) {
  const std::filesystem::path file =
      bitstream_builder().parent_path().parent_path() / "docs" / "prices.json";
  std::ifstream in(file);
  if (!in) return;
  const std::string text(std::istreambuf_iterator<char>(in), {});
  const Json all = Json::parse(text, nullptr, false);
  const Json rows = all.is_object() ? all.value("rows", Json()) : all;
  if (!rows.is_array())
    throw Error(ErrorCode::kFile, fmt::format("{}: no list of rows", file.string()));
  for (std::size_t i = 0; i < pipes.size(); ++i)
    for (const Json& row : rows) {
      if (!row.is_object() || !is_of(row, pipes[i])) continue;
      prices[i].luts = number(row, "lut"), prices[i].dsps = number(row, "dsp");
      prices[i].fmax_mhz = median_rate(row);
      prices[i].target = row.value("target", std::string());
      break;
    }
}

template <class T>
Json known(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}

}  // namespace

std::optional<double> Price::clocks_per_million() const {
  if (!latency || !interval) return std::nullopt;
  return 1e6 * *interval + *latency - *interval;
}

Json Price::to_json() const {
  return {{"latency_levels", known(latency)},
          {"initiation_interval", known(interval)},
          {"operator_count", known(operators)},
          {"modelled_clocks_per_million", known(clocks_per_million())},
          {"luts", known(luts)},
          {"dsps", known(dsps)},
          {"fmax_mhz", known(fmax_mhz)},
          {"area_of", target.empty() ? Json() : Json(target)}};
}

std::vector<Price> prices_of(const std::vector<AccuracyPipe>& pipes, bool elaborate) {
  std::vector<Price> prices(pipes.size());
  if (elaborate) add_figures(prices, pipes);
  add_area(prices, pipes);
  return prices;
}

}  // namespace cde::cli
