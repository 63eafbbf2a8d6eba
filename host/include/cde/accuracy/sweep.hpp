// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cde/accuracy/tally.hpp"
#include "cde/jobs/dealing.hpp"

/// Many pipes, each with all families of cases.
namespace cde::accuracy {

struct SweepOptions {
  std::vector<AccuracyPipe> pipes;
  std::vector<std::string> families;  ///< empty: all
  std::uint64_t seed = 1, cases = 2400;
  DealOptions deal;  ///< a chunk is a family of a pipe
  bool quiet = false;
};

/// Names of all families of these pairs, in the order of the oracles.
[[nodiscard]] std::vector<std::string> family_names(const std::vector<AccuracyPipe>& pipes);

/// One pipe, its families in order.
struct Measured {
  AccuracyPipe pipe;
  std::vector<std::pair<std::string, Tally>> families;
  [[nodiscard]] Tally all() const;
};

/// Measures them, dealt in chunks; nothing if the results are not all here (Dealing::deal). The
/// cases of a pipe are shared out to its families evenly, the first ones getting one more.
[[nodiscard]] std::optional<std::vector<Measured>> sweep(const SweepOptions& options);

}  // namespace cde::accuracy
