// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "accuracy/names.hpp"
#include "cde/accuracy/saved_sweep.hpp"

/// Finds the cheapest pipe that meets demands.
namespace cde::cli {

struct Demands {
  Pair pair = Pair::kRayTriangle;
  std::optional<double> max_error = {};  ///< largest allowed error of T over S
  double Quantiles::*quantile = &Quantiles::p999;
  bool no_leaks = false;
  std::optional<double> max_wrong = {};  ///< most wrong decisions per million
  bool sure = false;                     ///< whether the upper end of their interval counts
  std::optional<double> seconds = {};    ///< longest modelled time of `tests`
  double tests = 1e6;

  /// Whether the only demand is that a lane fits.
  [[nodiscard]] bool none() const { return !max_error && !no_leaks && !max_wrong && !seconds; }
};

/// A demand that a pipe does not meet, and the factor by which it misses.
struct Unmet {
  const char* what;  ///< "error", "leaks", "decisions", "area" or "time"
  std::string text;
  double factor = 1;
};

struct Candidate {
  const SavedPipe* of = nullptr;
  unsigned lanes = 1;  ///< the fewest, a power of two, that run the tests in time
  /// The key of the ranking: the share of the target that these lanes take. If the area is unknown,
  /// operators times bits of the format; such candidates rank last.
  double cost = 0;
  bool area_known = false;
  std::optional<double> seconds = {};
  std::vector<Unmet> unmet = {};
};

/// All candidates of the pair in order. First come those that meet all demands, the cheapest first.
/// Then come the others, by the number of unmet demands and by the factor of the miss.
[[nodiscard]] std::vector<Candidate> advise(const SavedSweep& sweep, const Demands& demands);

/// Text about the best candidate with its figures and commands, or about the unmet demands.
[[nodiscard]] std::string advice_text(const SavedSweep& sweep, const Demands& demands,
                                      const Target& target, const std::vector<Candidate>& all);

/// All candidates in that order, with costs and unmet demands.
[[nodiscard]] nlohmann::ordered_json advice_json(const SavedSweep& sweep, const Demands& demands,
                                                 const std::vector<Candidate>& all);

}  // namespace cde::cli
