// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>

#include "cde/accuracy/tally.hpp"
#include "cde/card/pair_unit.hpp"

namespace cde::accuracy {

/// What the simulated pipe did with some of the cases.
struct Simulated {
  Arithmetic arithmetic = Arithmetic::kHost;
  unsigned lanes = 0;
  std::uint64_t compared = 0;  ///< answers, all of them those of the reference
  double seconds = 0;          ///< that the simulation took here
  [[nodiscard]] double seconds_per_million() const {
    return 1e6 * seconds / static_cast<double>(compared);
  }
  [[nodiscard]] nlohmann::ordered_json to_json() const;
};
/// "host" or "rtl", as --arith has them.
[[nodiscard]] const char* name_of(Arithmetic arithmetic);

/// The first cases of every family, so many in all, through the pipe's bitstream, which is built on
/// first use. Error kMismatch for the first answer that is not the reference's, with the words and
/// a command that repeats it.
[[nodiscard]] Simulated simulated(const AccuracyPipe& pipe, Arithmetic arithmetic,
                                  std::uint64_t seed, std::uint64_t count);

}  // namespace cde::accuracy
