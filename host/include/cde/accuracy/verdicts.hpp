// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "cde/accuracy/verdict_pairs.hpp"

/// What a narrow first test is certain of (docs/background/certified_filters.md), family by family,
/// beside the truth.
namespace cde::accuracy {

struct VerdictCounts {
  std::uint64_t cases = 0;
  std::uint64_t misses = 0, hits = 0;  ///< certain
  std::uint64_t uncertain = 0;
  std::uint64_t near = 0;   ///< uncertain ones with |s| <= 16 u S, where binary32 may err, too
  std::uint64_t wrong = 0;  ///< certain, and the oracle says otherwise

  void add(const VerdictCounts& other);
};

struct VerdictRow {
  Pair pair = Pair::kObbObb;
  FpFormat narrow;
  PairBudget budget;  ///< of the narrow pipe
  std::vector<std::pair<std::string, VerdictCounts>> families;
  [[nodiscard]] VerdictCounts all() const;
};

struct VerdictOptions {
  std::vector<std::string> families;  ///< empty: all
  std::uint64_t seed = 1, cases = 2400;
  bool quiet = false;
};

/// Fills the rows, each with as many cases shared out to its families evenly.
void count_verdicts(std::vector<VerdictRow>& rows, const VerdictOptions& options);

[[nodiscard]] std::string verdict_table(const std::vector<VerdictRow>& rows, bool by_family,
                                        bool markdown);
[[nodiscard]] nlohmann::ordered_json verdict_json(const std::vector<VerdictRow>& rows);

}  // namespace cde::accuracy
