// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "cde/card/pair_unit.hpp"

/// A pipe as text: the options of the command that name it.
namespace cde {

struct PairOptions {
  std::string pair, algorithm = "moller", format = "fp32", arithmetic = "host", budget;
  std::optional<unsigned> lanes;
  std::optional<bool> box;
  unsigned facet_interval = PairConfig{}.facet_interval;
  bool half_space = false;
  bool exchanged = false;  ///< a line has the words of B first
};

/// `pair` in any order (pair_in_any_order) becomes its own name; the order becomes `exchanged`.
void settle_pair(PairOptions& options);

/// The pipe that they are of. Error kUsage for what does not fit together.
[[nodiscard]] PairConfig configuration(const PairOptions& options);

/// --budget, or what a pair takes without it. Error kUsage if it cannot be read, or the pair takes
/// none.
[[nodiscard]] PairBudget budget_of(const PairOptions& options);

/// M,K1,K2, or the evaluations in all, as `option` has it.
[[nodiscard]] PairBudget budget_named(const std::string& text, Pair pair,
                                      std::string_view option = "--budget");

/// PAIR and options as a command line has them, for another run of the same pipe.
[[nodiscard]] std::string words_of(const PairOptions& options, const PairConfig& config,
                                   bool lanes = true);

}  // namespace cde
