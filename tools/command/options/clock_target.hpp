// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "cde/card/board.hpp"
#include "cde/prices/card_clock.hpp"
#include "cde/scene/scene.hpp"
#include "options/cli_fwd.hpp"

/// The core clock that modelled times assume: --clock, or what --target was measured at.
namespace cde::cli {

/// `--target`: a device of docs/prices.json, or assumed:NUMBERMHz.
CLI::Option* target_option(CLI::App& verb, std::string& target, const std::string& what);

struct ClockOptions {
  double mhz = 100;
  std::string target = "";  ///< empty: none chosen, and `mhz` is assumed
};
/// --clock and --target; both of them is an error.
void clock_options(CLI::App& verb, ClockOptions& options);

/// Sets `options.mhz` to the clock of these pipes on the target, and says where it is from.
[[nodiscard]] std::string settle_clock(ClockOptions& options, const std::vector<PipeChoice>& pipes,
                                       const OperatorClocks& clocks);
/// The same for a card.
[[nodiscard]] std::string settle_clock(ClockOptions& options, const BoardConfig& card);

/// `--target` beside a scene, which has a clock of its own.
void scene_target_option(CLI::App& verb, std::string& target);
/// Sets the scene's clock to the target's, if one was chosen, and says where the clock is from.
/// Error kUsage if the scene names another clock than the default.
[[nodiscard]] std::string settle_clock(const std::string& target, Scene& scene,
                                       const BoardConfig& card);

}  // namespace cde::cli
