// SPDX-License-Identifier: Apache-2.0
#include "cde/accuracy/simulated.hpp"
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <span>

#include "cde/support/error.hpp"

namespace cde::accuracy {

const char* name_of(Arithmetic arithmetic) {
  return arithmetic == Arithmetic::kRtl ? "rtl" : "host";
}

nlohmann::ordered_json Simulated::to_json() const {
  return {{"arithmetic", name_of(arithmetic)},
          {"lanes", lanes},
          {"records_compared", compared},
          {"records_matching", compared},
          {"simulation_seconds", seconds},
          {"simulation_seconds_per_million", seconds_per_million()}};
}

Simulated simulated(const AccuracyPipe& pipe, Arithmetic arithmetic, std::uint64_t seed,
                    std::uint64_t count) {
  PairConfig config{.pair = pipe.pair,
                    .algorithm = pipe.algorithm,
                    .box = pipe.box,
                    .format = pipe.format,
                    .arithmetic = arithmetic};
  // Pipes with candidate axes (SAT) in 64-bit words take minutes per lane to compile, and so do
  // gates.
  if (has_sat_interval(pipe.pair) && pipe.format.width() > 32) config.lanes = 1;
  PairUnit unit(config);
  if (has_iterations(pipe.pair)) unit.set_iterations(pipe.iterations);
  Simulated result{.arithmetic = arithmetic, .lanes = config.lanes};
  const auto families = oracle::families(pipe.pair);
  for (std::size_t k = 0; k < families.size(); ++k) {
    const std::uint64_t cases = count / families.size() + (k < count % families.size() ? 1 : 0);
    if (cases == 0) break;
    const DrawnCases c = drawn(pipe, families[k], seed, cases);
    const std::vector<PairResult> expected = answers(pipe, c);
    std::vector<PairResult> got(expected.size());
    const auto start = std::chrono::steady_clock::now();
    (void)unit.test(c.a, c.b, got);
    result.seconds +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    result.compared += got.size();
    const auto differs = std::mismatch(got.begin(), got.end(), expected.begin()).first;
    if (differs == got.end()) continue;
    const auto i = static_cast<std::size_t>(differs - got.begin());
    const std::size_t a_words = primary_words(pipe.pair), b_words = secondary_words(pipe.pair);
    throw Error(ErrorCode::kMismatch,
                fmt::format("{}, family {}, case {}: the card's answer differs from the reference "
                            "in {}\nrepeat with: {} --arith {}",
                            pipe.name(), families[k].name, i, differing_fields(got[i], expected[i]),
                            pipe.repeat_command(std::span(c.a).subspan(i * a_words, a_words),
                                                std::span(c.b).subspan(i * b_words, b_words)),
                            name_of(arithmetic)));
  }
  return result;
}

}  // namespace cde::accuracy
