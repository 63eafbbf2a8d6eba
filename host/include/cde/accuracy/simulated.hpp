// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>

#include "cde/accuracy/tally.hpp"
#include "cde/card/pair_unit.hpp"

namespace cde::accuracy {

/// Run of a simulated pipe over some of the cases.
struct Simulated {
  Arithmetic arithmetic = Arithmetic::kHost;
  unsigned lanes = 0;
  std::uint64_t compared = 0;  ///< results; all equal the reference
  double seconds = 0;          ///< wall time of the simulation
  [[nodiscard]] double seconds_per_million() const {
    return 1e6 * seconds / static_cast<double>(compared);
  }
  [[nodiscard]] nlohmann::ordered_json to_json() const;
};
/// "host" or "rtl", as in --arith.
[[nodiscard]] const char* name_of(Arithmetic arithmetic);

/// Runs the first cases of every family, `count` in all, through the pipe's simulation model, which
/// is built on first use. Error kMismatch for the first result that differs from the reference,
/// with its words and a command that repeats it.
[[nodiscard]] Simulated simulated(const AccuracyPipe& pipe, Arithmetic arithmetic,
                                  std::uint64_t seed, std::uint64_t count);

}  // namespace cde::accuracy
