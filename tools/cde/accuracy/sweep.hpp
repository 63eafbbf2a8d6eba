// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "accuracy/tally.hpp"

/// Many pipes, each with all families of cases, in a file that goes on where it ended.
namespace cde::cli {

struct SweepOptions {
  std::vector<AccuracyPipe> pipes;
  std::vector<std::string> families;  ///< empty: all
  std::uint64_t seed = 1, cases = 2400;
  unsigned shard = 1, shards = 1;  ///< pipe number i, from 0, is of shard i % shards + 1
  std::string resume;              ///< file of finished parts; empty: none
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

/// Measures what the file does not have. A part, a family of a pipe, is written as it is finished,
/// a line each. The cases of a pipe are shared out to its families evenly, the first ones getting
/// one more. Errors: kUsage if the file is of another sweep, naming what differs; kFile.
[[nodiscard]] std::vector<Measured> sweep(const SweepOptions& options);

}  // namespace cde::cli
