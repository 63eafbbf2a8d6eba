// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "cde/geometry/primitives.hpp"
#include "cde/query/record.hpp"

/// Measurement of software, and comparison of its results with the card's.
namespace cde::cli {

/// The spread of repeated measurements, in seconds: for software on one thread processor time.
struct Spread {
  double least = 0, tenth = 0, median = 0, ninetieth = 0, most = 0;
  std::size_t samples = 0;
};

/// The spread of these samples, at least one.
[[nodiscard]] Spread spread_of(std::vector<double> samples);

/// Whether another sample follows `samples` samples that took `seconds` in all: at least nine and a
/// fifth of a second, at most 500.
[[nodiscard]] constexpr bool more_samples(std::size_t samples, double seconds) {
  return samples < 9 || (seconds < 0.2 && samples < 500);
}

/// Measures processor times of work(0), work(1) and so on: at least nine samples and a fifth of a
/// second. Calls shorter than a tenth of a millisecond are timed several at once, because reading
/// the clock takes part of a microsecond.
[[nodiscard]] Spread measured(const std::function<void(std::size_t)>& work);

[[nodiscard]] nlohmann::ordered_json spread_json(const Spread& spread);

/// Throws error kMismatch: `wrong` of `of` results differ.
[[noreturn]] void differs(std::string_view what, std::uint64_t wrong, std::uint64_t of);

/// Checks that hits of software (+inf: none) equal the card's, except for rounding at edges: at
/// most 1 ray in 50.
void compare_hits(std::span<const Record> card, const std::vector<float>& t, std::string_view name);

/// `size` of the rays; each turn takes other rays until all were used.
[[nodiscard]] inline std::span<const Ray> turn_of(std::span<const Ray> rays, std::size_t size,
                                                  std::size_t call) {
  return rays.subspan(call % (rays.size() / size) * size, size);
}

}  // namespace cde::cli
