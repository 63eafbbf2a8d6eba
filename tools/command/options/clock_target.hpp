// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "cde/card/board.hpp"
#include "cde/costs/card_clock.hpp"
#include "cde/scene/scene.hpp"
#include "options/cli_fwd.hpp"

/// The core clock that modelled times assume: --clock, or the clock measured on --target.
namespace cde::cli {

/// `--target`: a device of docs/costs.json, or assumed:NUMBERMHz.
CLI::Option* target_option(CLI::App& verb, std::string& target, const std::string& what);

struct ClockOptions {
  double mhz = 100;
  std::string target = "";  ///< empty: no target is chosen, and `mhz` is assumed
};
/// Adds --clock and --target. It is an error to give both.
void clock_options(CLI::App& verb, ClockOptions& options);

/// Sets `options.mhz` to the clock of these pipes on the target. Returns where the clock is from.
[[nodiscard]] std::string resolve_clock(ClockOptions& options, const std::vector<PipeChoice>& pipes,
                                        const OperatorLatencies& cycles);
/// The same for a card.
[[nodiscard]] std::string resolve_clock(ClockOptions& options, const BoardConfig& card);

/// Adds `--target` to a verb that reads a scene. The scene has its own clock.
void scene_target_option(CLI::App& verb, std::string& target);
/// Sets the scene's clock to the clock of the target, if one was chosen. Returns where the clock is
/// from. Error kUsage if the clock of the scene is not the default.
[[nodiscard]] std::string resolve_clock(const std::string& target, Scene& scene,
                                        const BoardConfig& card);

}  // namespace cde::cli
