// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cde/accuracy/tally.hpp"
#include "cde/jobs/work_distributor.hpp"

/// @file
/// Accuracy of many pipes, each with all families of cases.
namespace cde::accuracy {

struct SweepOptions {
  std::vector<AccuracyPipe> pipes;
  std::vector<std::string> families;  ///< empty: all
  std::uint64_t seed = 1, cases = 2400;
  DistributionOptions distribution;  ///< a chunk is one family of a pipe
  bool quiet = false;
};

/// Names of all families of the pipes' pairs, in the order of the oracles.
[[nodiscard]] std::vector<std::string> family_names(const std::vector<AccuracyPipe>& pipes);

/// One pipe, with its families in order.
struct Measured {
  AccuracyPipe pipe;
  std::vector<std::pair<std::string, Tally>> families;
  [[nodiscard]] Tally all() const;
};

/// Measures the pipes, distributed in chunks. Nothing if the results are not all here
/// (WorkDistributor::run_part). A pipe's cases are divided evenly among its families; the first
/// families get the remainder.
[[nodiscard]] std::optional<std::vector<Measured>> sweep(const SweepOptions& options);

}  // namespace cde::accuracy
