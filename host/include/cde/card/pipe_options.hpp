// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "cde/card/pair_unit.hpp"

/// @file
/// A pipe as text: the command options that select it.
namespace cde {

struct PairOptions {
  std::string pair, algorithm = "moller", format = "fp32", arithmetic = "host", iterations;
  std::optional<unsigned> lanes;
  std::optional<bool> box;
  unsigned sat_interval = PairConfig{}.sat_interval;
  bool half_space = false;
  bool exchanged = false;  ///< lines have the words of B first
};

/// Replaces `pair`, given in any order (pair_in_any_order), by its own name. Sets `exchanged`.
void normalise_pair(PairOptions& options);

/// The pipe that the options select. Error kUsage for options that cannot be combined.
[[nodiscard]] PairConfig configuration(const PairOptions& options);

/// Iterations from --iterations, or the pair's default. Error kUsage if the text cannot be read, or
/// the pair takes none.
[[nodiscard]] PairIterations iterations_of(const PairOptions& options);

/// Parses M,K1,K2, or the total number of evaluations. `option` names it in messages.
[[nodiscard]] PairIterations iterations_named(const std::string& text, Pair pair,
                                              std::string_view option = "--iterations");

/// PAIR and options of a command line that runs the same pipe again.
[[nodiscard]] std::string words_of(const PairOptions& options, const PairConfig& config,
                                   bool lanes = true);

}  // namespace cde
