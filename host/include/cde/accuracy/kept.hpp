// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cde/accuracy/error_counts.hpp"
#include "cde/accuracy/price.hpp"
#include "cde/accuracy/tally.hpp"

/// What `cde accuracy --json` wrote, read again: for its page and for `cde advise`.
namespace cde::accuracy {

inline constexpr const char* kSweepSchema = "cde.accuracy.2";

/// Errors by quantile; what is no number is infinite.
struct Quantiles {
  std::uint64_t count = 0;
  double median = 0, p99 = 0, p999 = 0, largest = 0;
};

/// The case that something was worst of, and the command that repeats it.
struct KeptCase {
  std::string family, command;
  std::uint64_t index = 0;
  double size = 0;  ///< in u S
};

struct KeptTally {
  std::string family;  ///< empty: all of them
  std::uint64_t cases = 0, refused = 0, judged = 0, wrong = 0, leak_rays = 0, leaks = 0;
  Quantiles t, oracle;  ///< in u S
  std::optional<KeptCase> worst_t, worst_decision, worst_leak;

  /// Of T in u S. Not less than the oracle can tell; `bounded` says that this was more.
  [[nodiscard]] double error(double Quantiles::*quantile, bool* bounded = nullptr) const;
  [[nodiscard]] double wrong_per_million() const;
  [[nodiscard]] Interval95 wrong_interval() const;  ///< a million
};

struct KeptPipe {
  AccuracyPipe pipe;
  PipeFigures figures;
  Price price;  ///< of the table of today
  KeptTally all;
  std::vector<KeptTally> families;

  [[nodiscard]] double u() const;
};

struct KeptSweep {
  nlohmann::ordered_json json;  ///< as it was read
  std::string target;           ///< that its prices are of
  std::uint64_t seed = 0, cases = 0;
  std::vector<std::string> families = {};  ///< the only ones that were asked for; none: all
  std::vector<KeptPipe> pipes = {};

  /// "cde accuracy ..." that measures one of them again.
  [[nodiscard]] std::string command(const AccuracyPipe& pipe) const;
};

/// Error kFile, naming `where`, if it is none of a sweep.
[[nodiscard]] KeptSweep sweep_of(const nlohmann::ordered_json& json, const std::string& where,
                                 const Target& target);
[[nodiscard]] KeptSweep read_sweep(const std::string& file, const Target& target);

}  // namespace cde::accuracy
