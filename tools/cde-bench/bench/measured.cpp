// SPDX-License-Identifier: Apache-2.0
#include "bench/measured.hpp"
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/bench.hpp"
#include "cde/support/error.hpp"

namespace cde::cli {

Spread measured(const std::function<void(std::size_t)>& work) {
  constexpr double kLeastSample = 1e-4;
  std::size_t call = 0, calls = 1;
  const auto sample = [&] {
    const double start = thread_seconds();
    for (std::size_t i = 0; i < calls; ++i) work(call++);
    return thread_seconds() - start;
  };
  while (sample() < kLeastSample) calls *= 2;
  std::vector<double> times;
  for (double sum = 0; more_samples(times.size(), sum);) {
    const double seconds = sample();
    sum += seconds;
    times.push_back(std::max(seconds / static_cast<double>(calls), 1e-9));
  }
  return spread_of(std::move(times));
}

Spread spread_of(std::vector<double> times) {
  std::sort(times.begin(), times.end());
  const std::size_t last = times.size() - 1;
  return {times.front(),           times[last / 10], times[last / 2],
          times[last - last / 10], times.back(),     times.size()};
}

nlohmann::ordered_json spread_json(const Spread& x) {
  return {{"least", x.least},         {"tenth", x.tenth}, {"median", x.median},
          {"ninetieth", x.ninetieth}, {"most", x.most},   {"measurements", x.samples}};
}

void differs(std::string_view what, std::uint64_t wrong, std::uint64_t of) {
  throw Error(ErrorCode::kMismatch, fmt::format("{}: {} of {} differ", what, wrong, of));
}

void compare_hits(std::span<const Record> card, const std::vector<float>& t,
                  std::string_view name) {
  std::uint64_t wrong = 0;
  for (std::size_t i = 0; i < card.size(); ++i) {
    const bool hit = std::isfinite(t[i]);
    if (hit != card[i].f || (hit && std::abs(t[i] - card[i].t) > 1e-4f * std::abs(card[i].t)))
      ++wrong;
  }
  if (wrong > card.size() / 50)
    differs(fmt::format("hits of {} and the card", name), wrong, card.size());
}

}  // namespace cde::cli
