// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "cde/accuracy/verdict_pairs.hpp"

/// @file
/// Decisions of the certified filter (docs/background/certified_filters.md) by family, compared
/// with the truth.
namespace cde::accuracy {

struct VerdictCounts {
  std::uint64_t cases = 0;
  std::uint64_t misses = 0, hits = 0;  ///< certain results
  std::uint64_t uncertain = 0;
  std::uint64_t near = 0;   ///< uncertain cases with |s| <= 16 u S, where binary32 may also err
  std::uint64_t wrong = 0;  ///< certain, but contradicted by the oracle

  void add(const VerdictCounts& other);
};

struct VerdictRow {
  Pair pair = Pair::kObbObb;
  FpFormat narrow;
  PairBudget budget;  ///< iterations of the narrow pipe
  std::vector<std::pair<std::string, VerdictCounts>> families;
  [[nodiscard]] VerdictCounts all() const;
};

struct VerdictOptions {
  std::vector<std::string> families;  ///< empty: all
  std::uint64_t seed = 1, cases = 2400;
  bool quiet = false;
};

/// Fills the rows. Each has the same number of cases, divided evenly among its families.
void count_verdicts(std::vector<VerdictRow>& rows, const VerdictOptions& options);

[[nodiscard]] std::string verdict_table(const std::vector<VerdictRow>& rows, bool by_family,
                                        bool markdown);
[[nodiscard]] nlohmann::ordered_json verdict_json(const std::vector<VerdictRow>& rows);

}  // namespace cde::accuracy
