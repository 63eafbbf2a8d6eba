// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cde/accuracy/cost.hpp"
#include "cde/accuracy/error_counts.hpp"
#include "cde/accuracy/tally.hpp"

/// @file
/// Reads the output of `cde accuracy --json`, for its page and for `cde advise`.
namespace cde::accuracy {

inline constexpr const char* kSweepSchema = "cde.accuracy.3";

/// Quantiles of errors. A result that is not a number counts as infinite.
struct Quantiles {
  std::uint64_t count = 0;
  double median = 0, p99 = 0, p999 = 0, largest = 0;
};

/// The worst case of a measure, and the command that repeats it.
struct SavedCase {
  std::string family, command;
  std::uint64_t index = 0;
  double size = 0;  ///< in u S
};

struct SavedTally {
  std::string family;  ///< empty: all families
  std::uint64_t cases = 0, refused = 0, judged = 0, wrong = 0, leak_rays = 0, leaks = 0;
  Quantiles t, oracle;  ///< in u S
  std::optional<SavedCase> worst_t, worst_decision, worst_leak;

  /// Error of T in u S, at least the oracle's own uncertainty. `bounded` tells whether that limit
  /// applied.
  [[nodiscard]] double error(double Quantiles::*quantile, bool* bounded = nullptr) const;
  [[nodiscard]] double wrong_per_million() const;
  [[nodiscard]] Interval95 wrong_interval() const;  ///< per million
};

struct SavedPipe {
  AccuracyPipe pipe;
  PipeFigures figures;
  Cost cost;  ///< from the current table
  SavedTally all;
  std::vector<SavedTally> families;

  [[nodiscard]] double u() const;
};

struct SavedSweep {
  nlohmann::ordered_json json;  ///< as read
  std::string target;           ///< target of its costs
  std::uint64_t seed = 0, cases = 0;
  std::vector<std::string> families = {};  ///< families that were selected; empty: all
  std::vector<SavedPipe> pipes = {};

  /// "cde accuracy ..." that measures one pipe again.
  [[nodiscard]] std::string command(const AccuracyPipe& pipe) const;
};

/// Error kFile, naming `where`, if the JSON is not such output.
[[nodiscard]] SavedSweep sweep_of(const nlohmann::ordered_json& json, const std::string& where,
                                  const Target& target);
[[nodiscard]] SavedSweep read_sweep(const std::string& file, const Target& target);

}  // namespace cde::accuracy
