// SPDX-License-Identifier: Apache-2.0
// Section pairs of cde bench: measures every pipe by itself, in simulated pairs per second on one
// core, and FCL on the same pairs in the same run.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "baselines/bench_fcl.hpp"
#include "bench/bench.hpp"
#include "cde/card/pair_unit.hpp"
#include "cde/check/random_pairs.hpp"
#include "cde/fp/fp_format.hpp"
#include "cde/geometry/primitives.hpp"
#include "cde/netlist/elaborate.hpp"
#include "cde/support/error.hpp"
#include "cde/support/progress.hpp"
#include "output/streams.hpp"

namespace cde::cli {
namespace {

constexpr std::uint64_t kSeed = 20261121;
constexpr std::size_t kCases = 8192;
constexpr unsigned kPairLanes = 8;

/// One pipe and the pairs for its measurement.
struct MeasuredPairs {
  double pairs_per_second = 0, cycles_per_row = 0;
  unsigned latency = 0;
  std::size_t hits = 0;
  std::vector<PairResult> results;
};

MeasuredPairs measure(const PairConfig& config, std::span<const float> a, std::span<const float> b,
                      double seconds, const std::optional<PairIterations>& iterations = {}) {
  PairUnit unit(config);
  if (iterations) unit.set_iterations(*iterations);
  const auto encoded = [&](std::span<const float> from) {
    std::vector<std::uint64_t> words;
    words.reserve(from.size());
    for (const float x : from) words.push_back(config.format.encode(static_cast<double>(x)));
    return words;
  };
  const std::vector<std::uint64_t> wa = encoded(a), wb = encoded(b);
  MeasuredPairs m;
  m.latency = unit.latency();
  m.results.resize(kCases);
  std::uint64_t cycles = unit.test(wa, wb, m.results);  // warms up
  m.cycles_per_row = static_cast<double>(cycles - unit.latency() + 1) / (kCases / kPairLanes);
  m.hits = static_cast<std::size_t>(
      std::count_if(m.results.begin(), m.results.end(), [](const PairResult& r) { return r.f; }));
  const double start = thread_seconds();
  double pairs = 0, elapsed = 0;
  do {
    (void)unit.test(wa, wb, m.results);
    pairs += kCases;
    elapsed = thread_seconds() - start;
  } while (elapsed < seconds);
  m.pairs_per_second = pairs / elapsed;
  return m;
}

/// The cost of accuracy for a cylinder pair: its rate for several numbers of iterations. The
/// largest gives the signed distances with which the others are compared.
struct AccuracyCost {
  PairIterations iterations;
  double pairs_per_second, cycles_per_row, p99, worst;
};

std::vector<AccuracyCost> measure_iterations(Pair pair, std::span<const float> a,
                                             std::span<const float> b, double seconds) {
  const PairIterations settings[] = {{8, 16, 16}, {8, 8, 8}, {4, 6, 6},
                                     {4, 4, 4},   {4, 2, 2}, {4, 0, 0}};
  std::vector<AccuracyCost> rows;
  std::vector<double> best;
  for (const PairIterations& iterations : settings) {
    const PairConfig config{.pair = pair, .lanes = kPairLanes};
    const MeasuredPairs m = measure(config, a, b, seconds, iterations);
    std::vector<double> shortfall;
    for (std::size_t i = 0; i < kCases; ++i) {
      const double t = config.format.decode(m.results[i].t), distance = m.results[i].f ? -t : t;
      if (best.size() <= i) best.push_back(distance);
      shortfall.push_back(std::max(0.0, best[i] - distance));
    }
    std::sort(shortfall.begin(), shortfall.end());
    rows.push_back({iterations, m.pairs_per_second, m.cycles_per_row, shortfall[kCases * 99 / 100],
                    shortfall.back()});
  }
  return rows;
}

nlohmann::ordered_json iterations_json(const std::vector<AccuracyCost>& rows,
                                       const Device& device) {
  auto json = nlohmann::ordered_json::array();
  for (const AccuracyCost& r : rows) {
    const auto& [m, k1, k2] = r.iterations;
    print_figure(
        "  M {:>2} K1 {:>2} K2 {:>2}{:>17.3f}  {:.0f} cycles per row, below the first by {:.1e} "
        "(p99), {:.1e} (max)\n",
        m, k1, k2, r.pairs_per_second / 1e6, r.cycles_per_row, r.p99, r.worst);
    json.push_back(
        {{"samples", m},
         {"circle", k1},
         {"free", k2},
         {"tests_per_second_simulated", r.pairs_per_second},
         {"cycles_per_row", r.cycles_per_row},
         {"modelled_tests_per_second", kPairLanes * device.clock_hz() / r.cycles_per_row},
         {"shortfall_p99", r.p99},
         {"shortfall_max", r.worst}});
  }
  return json;
}

nlohmann::ordered_json optional_number(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
}

/// `card` is absent if there is no pipe.
nlohmann::ordered_json fcl_json(const FclRates& fcl, const std::optional<MeasuredPairs>& card) {
  nlohmann::ordered_json j = {{"collide_per_second", optional_number(fcl.collide)},
                              {"distance_per_second", optional_number(fcl.distance)},
                              {"distance_signed", fcl.distance_signed},
                              {"collide_stops", fcl.collide_stops},
                              {"distance_stops", fcl.distance_stops}};
  if (!card) return j;
  std::size_t compared = 0, agreeing = 0;
  for (std::size_t i = 0; i < fcl.hits.size(); ++i) {
    if (fcl.hits[i] < 0) continue;
    ++compared;
    agreeing += (fcl.hits[i] == 1) == card->results[i].f ? 1 : 0;
  }
  const auto ratio = [&](const std::optional<double>& rate) {
    return optional_number(rate ? std::optional(card->pairs_per_second / *rate) : std::nullopt);
  };
  j["hits_compared"] = compared;
  j["hits_agreeing"] = agreeing;
  j["simulated_to_collide"] = ratio(fcl.collide);
  j["simulated_to_distance"] = ratio(fcl.distance);
  return j;
}

/// A rate in millions, and the simulation's rate relative to it; "-" without a rate.
std::string beside(const std::optional<double>& rate, const std::optional<MeasuredPairs>& card,
                   bool depth) {
  if (!rate) return "-";
  const std::string text = fmt::format("{:.3f}{}", *rate / 1e6, depth ? "*" : "");
  return card ? fmt::format("{} ({:.2f}x)", text, card->pairs_per_second / *rate) : text;
}

nlohmann::ordered_json bench_pair(const BenchOptions& o, Pair pair, Algorithm algorithm) {
  const bool ray_triangle = pair == Pair::kRayTriangle;
  std::vector<float> a, b;
  RandomPairs generator(kSeed + static_cast<unsigned>(pair));
  for (std::size_t i = 0; i < kCases; ++i) generator.pair(pair, a, b);
  const double seconds = o.quick ? 0.2 : 1.0;
  std::optional<MeasuredPairs> card;
  try {
    card = measure({.pair = pair, .algorithm = algorithm, .lanes = kPairLanes}, a, b, seconds);
  } catch (const Error& e) {
    if (std::string_view(e.what()).find(netlist::kNoPipe) == std::string_view::npos) throw;
  }
  const FclRates fcl = measure_fcl(pair, a, b, seconds);
  const auto figure = [&](const char* form, auto of) {
    return card ? fmt::format(fmt::runtime(form), of(*card)) : std::string();
  };
  print_figure(
      "{:<26}{:>12}{:>9}{:>8}{:>20}{:>20}\n",
      ray_triangle ? fmt::format("ray-triangle, {}", name(algorithm)) : std::string(name(pair)),
      card ? fmt::format("{:.3f}", card->pairs_per_second / 1e6) : "no pipe",
      figure("{}", [](const MeasuredPairs& m) { return m.latency; }),
      figure("{:.1f}",
             [](const MeasuredPairs& m) { return 100.0 * static_cast<double>(m.hits) / kCases; }),
      beside(fcl.collide, card, false), beside(fcl.distance, card, fcl.distance_signed));

  nlohmann::ordered_json row = {{"pair", name(pair)}};
  if (ray_triangle) row["algorithm"] = name(algorithm);
  row["absent"] = !card;
  if (card) {
    row["tests_per_second_simulated"] = card->pairs_per_second;
    row["latency_cycles"] = card->latency;
    row["cycles_per_row"] = card->cycles_per_row;
    row["modelled_tests_per_second"] = kPairLanes * o.device.clock_hz() / card->cycles_per_row;
    row["hit_share"] = static_cast<double>(card->hits) / kCases;
  }
  if (card && has_iterations(pair))
    row["by_iterations"] = iterations_json(measure_iterations(pair, a, b, seconds), o.device);
  row["fcl"] = has_fcl() ? fcl_json(fcl, card) : nlohmann::ordered_json();
  return row;
}

}  // namespace

nlohmann::ordered_json bench_pairs(const BenchOptions& o) {
  print_figure(
      "\npipes by themselves, shapes of size 0.5 to 1.5, host arithmetic, fp32, {} lanes, {} "
      "random pairs, one core, processor time\n{:<26}{:>12}{:>9}{:>8}{:>20}{:>20}\n",
      kPairLanes, kCases, "pair", "M pairs/s", "latency", "hits %", "FCL collide M/s",
      "FCL distance M/s");
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  Progress progress("pairs");
  for (unsigned p = 0; p < kPairs; ++p) {
    const auto pair = static_cast<Pair>(p);
    if (o.quick && pair != Pair::kSphereSphere) continue;
    progress(static_cast<double>(p) / kPairs, std::string(name(pair)));
    const unsigned algorithms = pair == Pair::kRayTriangle ? 4 : 1;
    for (unsigned k = 0; k < algorithms; ++k)
      rows.push_back(bench_pair(o, pair, static_cast<Algorithm>(k)));
  }
  print_figure(
      "{}\n",
      has_fcl()
          ? "in brackets: the simulation's rate over FCL's; *: with the depth of overlapping pairs"
          : "this program was built without FCL (Debian: libfcl-dev)");
  return {{"what",
           "simulated pairs per second of processor time, pipe by itself, new operands every "
           "cycle; FCL in binary64 on the same pairs"},
          {"seed", kSeed},
          {"cases", kCases},
          {"lanes", kPairLanes},
          {"format", "fp32"},
          {"arithmetic", "host"},
          {"fcl", has_fcl()},
          {"pairs", rows}};
}

}  // namespace cde::cli
