// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "cde/accuracy/filter_pairs.hpp"

/// @file
/// Decisions of the certified filter (docs/background/certified_filters.md) by family, compared
/// with the truth.
namespace cde::accuracy {

struct FilterCounts {
  std::uint64_t cases = 0;
  std::uint64_t misses = 0, hits = 0;  ///< certain results
  std::uint64_t uncertain = 0;
  std::uint64_t near = 0;   ///< uncertain cases with |s| <= 16 u S, where binary32 may also err
  std::uint64_t wrong = 0;  ///< certain, but contradicted by the oracle

  void add(const FilterCounts& other);
};

struct FilterRow {
  Pair pair = Pair::kObbObb;
  FpFormat narrow;
  PairIterations iterations;  ///< iterations of the narrow pipe
  std::vector<std::pair<std::string, FilterCounts>> families;
  [[nodiscard]] FilterCounts all() const;
};

struct FilterOptions {
  std::vector<std::string> families;  ///< empty: all
  std::uint64_t seed = 1, cases = 2400;
  bool quiet = false;
};

/// Fills the rows. Each has the same number of cases, divided evenly among its families.
void measure_filters(std::vector<FilterRow>& rows, const FilterOptions& options);

[[nodiscard]] std::string filter_table(const std::vector<FilterRow>& rows, bool by_family,
                                       bool markdown);
[[nodiscard]] nlohmann::ordered_json filter_json(const std::vector<FilterRow>& rows);

}  // namespace cde::accuracy
