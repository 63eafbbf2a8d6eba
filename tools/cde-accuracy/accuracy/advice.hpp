// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "accuracy/names.hpp"
#include "cde/accuracy/kept.hpp"

/// The cheapest pipe that is good enough.
namespace cde::cli {

struct Demands {
  Pair pair = Pair::kRayTriangle;
  std::optional<double> max_error = {};  ///< of T over S
  double Quantiles::*quantile = &Quantiles::p999;
  bool no_leaks = false;
  std::optional<double> max_wrong = {};  ///< wrong decisions a million
  bool sure = false;                     ///< the upper end of their interval counts
  std::optional<double> seconds = {};    ///< modelled, of so many tests
  double tests = 1e6;

  /// Nothing but that a lane fits.
  [[nodiscard]] bool none() const { return !max_error && !no_leaks && !max_wrong && !seconds; }
};

/// What a pipe does not meet, and by which factor it is off.
struct Unmet {
  const char* what;  ///< "error", "leaks", "decisions", "area" or "time"
  std::string text;
  double factor = 1;
};

struct Candidate {
  const KeptPipe* of = nullptr;
  unsigned lanes = 1;  ///< the fewest, a power of two, that take the tests in time
  /// What is ranked: the share of the target that these lanes take; where no area is known,
  /// operators times bits of the format, behind all of those.
  double cost = 0;
  bool area_known = false;
  std::optional<double> seconds = {};
  std::vector<Unmet> unmet = {};
};

/// All of the pair, the cheapest that meets everything first, then the nearest misses: those that
/// lack the fewest demands, and are off by the least.
[[nodiscard]] std::vector<Candidate> advise(const KeptSweep& sweep, const Demands& demands);

/// The first with its figures and commands, or what is in the way.
[[nodiscard]] std::string advice_text(const KeptSweep& sweep, const Demands& demands,
                                      const Target& target, const std::vector<Candidate>& all);

/// All of them in that order: what they cost and lack.
[[nodiscard]] nlohmann::ordered_json advice_json(const KeptSweep& sweep, const Demands& demands,
                                                 const std::vector<Candidate>& all);

}  // namespace cde::cli
