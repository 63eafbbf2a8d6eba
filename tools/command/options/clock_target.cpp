// SPDX-License-Identifier: Apache-2.0
#include "options/clock_target.hpp"
#include <CLI/CLI.hpp>

#include <fmt/format.h>

#include "cde/support/error.hpp"
#include "options/values.hpp"

namespace cde::cli {

CLI::Option* target_option(CLI::App& verb, std::string& target, const std::string& what) {
  return text_value(verb.add_option("--target", target, what), "ecp5-85|hx8k|assumed:NMHz",
                    [](const std::string& text) { (void)parse_target(text); });
}

void clock_options(CLI::App& verb, ClockOptions& options) {
  auto* clock = clock_option(verb, options.mhz);
  target_option(verb, options.target,
                "Core clock measured on this device, instead of --clock (docs/background/costs.md)")
      ->excludes(clock);
}

std::string resolve_clock(ClockOptions& options, const std::vector<PipeChoice>& pipes,
                          const OperatorLatencies& cycles) {
  const Target target = options.target.empty() ? Target{.name = "", .assumed_mhz = options.mhz}
                                               : parse_target(options.target);
  const CardClock clock = clock_on(target, pipes, cycles);
  options.mhz = clock.mhz;
  return clock.source;
}

std::string resolve_clock(ClockOptions& options, const BoardConfig& card) {
  std::vector<PipeChoice> pipes;
  const auto add = [&](Pair pair, FpFormat format) {
    pipes.push_back({.pair = pair,
                     .algorithm = card.algorithm,
                     .box = card.box && pair == Pair::kRayTriangle,
                     .format = format});
  };
  for (const Pair pair : card.pairs) {
    add(pair, card.format);
    if (card.filter && has_filter(pair)) add(pair, *card.filter);
  }
  return resolve_clock(options, pipes,
                       {.add = card.latency_add,
                        .mul = card.latency_mul,
                        .div = card.latency_div,
                        .sqrt = card.latency_sqrt,
                        .cmp = card.latency_compare});
}

void scene_target_option(CLI::App& verb, std::string& target) {
  target_option(
      verb, target,
      "Core clock measured on this device (docs/background/costs.md), instead of the scene's");
}

std::string resolve_clock(const std::string& target, Scene& scene, const BoardConfig& card) {
  const double of_scene = scene.card.clock_hz;
  ClockOptions options{.mhz = of_scene / 1e6, .target = target};
  if (!target.empty() && of_scene != SceneCard{}.clock_hz)
    throw Error(
        ErrorCode::kUsage,
        fmt::format("--target is {}, and {} has clock_mhz = {:g}; only one of them may be given",
                    target, scene.file, options.mhz));
  std::string source = resolve_clock(options, card);
  if (!target.empty()) scene.card.clock_hz = 1e6 * options.mhz;
  return source;
}

}  // namespace cde::cli
