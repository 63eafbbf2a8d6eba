// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace cde {

/// Which waves are written. Signals that are left out cost only what the ability to trace costs.
struct TraceOptions {
  std::uint64_t from = 0;  ///< first core cycle, counted from the request for waves
  std::uint64_t to = std::numeric_limits<std::uint64_t>::max();  ///< last core cycle
  /// Waves begin when the card fetches this secondary from DDR, instead of at `from`.
  std::optional<std::uint32_t> secondary = {};
  std::uint64_t cycles = 400;  ///< With `secondary`: number of cycles, instead of `to`
  /// Patterns with * and ? of signals or scopes as `cde wave ls` lists them, with or without outer
  /// scopes. Only these are written; empty: all.
  std::vector<std::string> scopes = {};
};

}  // namespace cde
