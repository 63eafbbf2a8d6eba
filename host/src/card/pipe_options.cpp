// SPDX-License-Identifier: Apache-2.0
#include "cde/card/pipe_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "cde/contract/registers.hpp"
#include "cde/fp/number_text.hpp"
#include "cde/reference/pairs.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/suggest.hpp"

namespace cde {
namespace {

/// The largest iterations of at most `evaluations` evaluations, split evenly. For two cylinders, K1
/// and K2 are as equal as possible. For a box or triangle, M is 8 if K1 can also be 8, else 4. M is
/// 16 if more evaluations remain with M = 8 and the largest K1.
PairIterations split(unsigned evaluations, Pair pair) {
  constexpr unsigned kMost = card::kIterationsMost;
  const bool cylinders = pair == Pair::kCylinderCylinder;
  const auto takes = [pair](const PairIterations& b) { return reference::evaluations(pair, b); };
  const unsigned least = takes({.samples = 4, .circle = 0, .free = 0});
  const unsigned most = takes({.samples = 16, .circle = kMost, .free = kMost});
  if (evaluations < least || evaluations > most)
    throw Error(ErrorCode::kUsage, fmt::format("--iterations is {}; {} needs {} to {} evaluations",
                                               evaluations, name(pair), least, most));
  const unsigned rest = evaluations - takes({.samples = 0, .circle = 0, .free = 0});
  PairIterations iterations;
  if (cylinders) {
    iterations.circle = std::min(rest / 5 + (rest % 5 == 2 ? 1 : 0), kMost);
    iterations.free = std::min(rest / 5 + (rest % 5 >= 3 ? 1 : 0), kMost);
  } else {
    iterations.samples = rest / 3 > 8 + kMost ? 16 : rest / 3 >= 16 ? 8 : 4;
    iterations.circle = std::min(rest / 3 - iterations.samples, kMost);
  }
  return iterations;
}

/// The default number of lanes. 64-bit words fill vectors with fewer lanes. Pipes with candidate
/// axes (SAT) take minutes to compile with more than one such lane.
unsigned default_lanes(Pair pair, FpFormat format) {
  const bool large = has_sat_interval(pair) || pair == Pair::kTriangleTriangle;
  return large && format.width() > 32 ? 1 : PairConfig{}.lanes;
}

}  // namespace

// Reads M,K1,K2 or the total number of evaluations. M: directions sampled on a circle; K1: steps on
// each circle; K2: steps on each free track.
PairIterations iterations_named(const std::string& text, Pair pair, std::string_view option) {
  if (!has_iterations(pair))
    throw Error(ErrorCode::kUsage,
                fmt::format("{} cannot be combined with {}, which has no iterations; expected "
                            "cylinder-cylinder, obb-cylinder or triangle-cylinder",
                            option, name(pair)));
  const auto is_all = [&text](int end) { return static_cast<std::size_t>(end) == text.size(); };
  PairIterations iterations;
  unsigned evaluations = 0;
  int end = 0;
  if (text.find_first_not_of("0123456789,") == std::string::npos) {
    if (std::sscanf(text.c_str(), "%9u%n", &evaluations, &end) == 1 && is_all(end))
      return split(evaluations, pair);
    if (std::sscanf(text.c_str(), "%3u,%3u,%3u%n", &iterations.samples, &iterations.circle,
                    &iterations.free, &end) == 3 &&
        is_all(end)) {
      try {
        iterations.check();
      } catch (const Error& e) {
        constexpr std::string_view kIterations = "iterations";  // the message begins with this
        throw Error(e.code(), fmt::format("{}{}", option,
                                          std::string_view(e.what()).substr(kIterations.size())));
      }
      return iterations;
    }
  }
  throw Error(ErrorCode::kUsage,
              fmt::format("{} is {}; it must be M,K1,K2 with M 4, 8 or 16, K1 and K2 0 to {}, or "
                          "the number of evaluations",
                          option, in_quotes(text), card::kIterationsMost));
}

void normalise_pair(PairOptions& o) {
  const PairName named = pair_in_any_order(o.pair);
  o.pair = name(named.pair);
  o.exchanged = named.exchanged;
}

PairConfig configuration(const PairOptions& o) {
  const Pair pair = pair_in_any_order(o.pair).pair;
  PairConfig config{.pair = pair,
                    .algorithm = *algorithm_named(o.algorithm),
                    .box = o.box.value_or(pair == Pair::kRayTriangle),
                    .plane = o.half_space ? PlaneSide::kHalfSpace : PlaneSide::kSurface,
                    .format = FpFormat::parse(o.format),
                    .sat_interval = o.sat_interval};
  config.lanes = o.lanes.value_or(default_lanes(config.pair, config.format));
  config.arithmetic = o.arithmetic == "rtl" ? Arithmetic::kRtl : Arithmetic::kHost;
  if (!o.iterations.empty()) (void)iterations_named(o.iterations, config.pair);
  (void)config.parameters();  // throws for bad values before slow work
  return config;
}

PairIterations iterations_of(const PairOptions& o) {
  return o.iterations.empty() ? PairIterations{}
                              : iterations_named(o.iterations, pair_in_any_order(o.pair).pair);
}

std::string words_of(const PairOptions& o, const PairConfig& config, bool lanes) {
  std::string words(name(config.pair));
  if (config.pair == Pair::kRayTriangle) words += " --algorithm " + o.algorithm;
  words += fmt::format(" --format {} --arith {}", o.format, o.arithmetic);
  if (lanes) words += fmt::format(" --lanes {}", config.lanes);
  if (o.half_space) words += " --half-space";
  if (config.pair == Pair::kRayTriangle && !config.box) words += " --no-box";
  if (config.pair != Pair::kRayTriangle && config.box) words += " --box";
  if (o.sat_interval != 1) words += fmt::format(" --sat-interval {}", o.sat_interval);
  if (!o.iterations.empty()) words += " --iterations " + o.iterations;
  return words;
}

}  // namespace cde
