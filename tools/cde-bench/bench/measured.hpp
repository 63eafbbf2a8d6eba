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

/// Software that is measured beside the card, and held against it.
namespace cde::cli {

/// How far measurements of the same thing lie apart, in seconds of processor time of one thread.
struct Spread {
  double least = 0, tenth = 0, median = 0, ninetieth = 0, most = 0;
  std::size_t samples = 0;
};

/// Processor times of work(0), work(1) and so on: at least nine samples and a fifth of a second.
/// What takes less than a tenth of a millisecond is timed several calls at once, as the clock
/// itself takes part of a microsecond.
[[nodiscard]] Spread measured(const std::function<void(std::size_t)>& work);

[[nodiscard]] nlohmann::ordered_json spread_json(const Spread& spread);

/// Error kMismatch: so many of them differ.
[[noreturn]] void differs(std::string_view what, std::uint64_t wrong, std::uint64_t of);

/// Hits of software (+inf: none) are the card's but for roundings at edges, 1 ray in 50 at most.
void compare_hits(std::span<const Record> card, const std::vector<float>& t, std::string_view name);

/// So many of the rays, others in every call until all were in one.
[[nodiscard]] inline std::span<const Ray> turn_of(std::span<const Ray> rays, std::size_t size,
                                                  std::size_t call) {
  return rays.subspan(call % (rays.size() / size) * size, size);
}

}  // namespace cde::cli
