// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>

#include "cde/scene/player.hpp"
#include "verbs/bundle.hpp"

namespace cde::cli {

/// A record of a scene that differs.
struct RunFailure {
  const Scene& scene;
  const Plan& plan;
  PlayOptions options;      ///< as it was played
  std::uint32_t first = 0;  ///< frame that was played first
  std::uint32_t frame = 0;  ///< and the one that it is of
  std::size_t query = 0;
  Difference difference;
  std::string message, repeat;  ///< as the verb tells it, and its own command
};
/// Packs it. The packet that it is of is played again, in its frame alone; if that gives another
/// record, all frames before it are played first.
void bundle_run(Bundle& bundle, const RunFailure& failure);

}  // namespace cde::cli
