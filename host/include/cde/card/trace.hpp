// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace cde {

/// Which waves are written. What is left out costs nothing but the model's being able to.
struct TraceOptions {
  std::uint64_t from =
      0;  ///< first clock of the card's core, counted from when waves are asked for
  std::uint64_t to = std::numeric_limits<std::uint64_t>::max();  ///< last one
  /// Waves begin where the card fetches this secondary from its DDR, instead of `from`, ...
  std::optional<std::uint32_t> secondary = {};
  std::uint64_t clocks = 400;  ///< ... and last for so many clocks, instead of until `to`
  /// Patterns of * and ? that name signals or scopes, as `cde wave ls` lists them, with or without
  /// the scopes around them. Nothing else is written; none: all.
  std::vector<std::string> scopes = {};
};

}  // namespace cde
