// SPDX-License-Identifier: Apache-2.0
#include "cde/geometry/pair.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

#include "cde/contract/registers.hpp"
#include "cde/support/error.hpp"
#include "support/text.hpp"

namespace cde {
std::string_view name(Pair pair) {
  return text::entry(contract::kPairTable, pair, "pair").name;
}
std::string_view name(Algorithm algorithm) {
  return text::entry(contract::kAlgorithmNames, algorithm, "algorithm");
}
std::string_view name(Shape shape) {
  return text::entry(contract::kShapeTable, shape, "shape").name;
}

std::optional<Pair> pair_named(std::string_view text) {
  const auto* found = std::find_if(contract::kPairTable.begin(), contract::kPairTable.end(),
                                   [text](const contract::PairRow& f) { return f.name == text; });
  if (found == contract::kPairTable.end()) return std::nullopt;
  return static_cast<Pair>(found - contract::kPairTable.begin());
}
std::optional<Algorithm> algorithm_named(std::string_view text) {
  const auto* found =
      std::find(contract::kAlgorithmNames.begin(), contract::kAlgorithmNames.end(), text);
  if (found == contract::kAlgorithmNames.end()) return std::nullopt;
  return static_cast<Algorithm>(found - contract::kAlgorithmNames.begin());
}

unsigned words(Shape shape) {
  return text::entry(contract::kShapeTable, shape, "shape").words;
}
Shape primary_shape(Pair pair) {
  return text::entry(contract::kPairTable, pair, "pair").primary;
}
Shape secondary_shape(Pair pair) {
  return text::entry(contract::kPairTable, pair, "pair").secondary;
}

void PairBudget::check() const {
  if (samples != 4 && samples != 8 && samples != 16)
    throw Error(ErrorCode::kUsage, fmt::format("budget: M is {}, expected 4, 8 or 16", samples));
  for (const auto& [what, value] : {std::pair{"K1", circle}, std::pair{"K2", free}})
    if (value > card::kBudgetMost)
      throw Error(ErrorCode::kUsage, fmt::format("budget: {} is {}, expected 0 to {}", what, value,
                                                 card::kBudgetMost));
}

bool has_budget(Pair pair) {
  return contract::has(contract::kRingPairs, pair);
}

bool has_facets(Pair pair) {
  return contract::has(contract::kFacetPairs, pair);
}

bool has_box_rule(Pair pair) {
  return contract::has(contract::kBoxPairs | contract::kBoundPairs, pair);
}

std::optional<WayThrough> way_through(Pair pair, bool swap) {
  if (!has_box_rule(pair) && !contract::has(contract::kPlainPairs, pair)) return std::nullopt;
  const Shape a = primary_shape(pair), b = secondary_shape(pair);
  if (!swap) return WayThrough{a, b};
  if (a == b || !contract::has(contract::kBoundPairs, pair)) return std::nullopt;
  return WayThrough{b, a};
}

bool has_verdicts(Pair pair) {
  return contract::has(contract::kVerdictPairs, pair);
}

void check_facet_interval(unsigned interval, std::span<const Pair> pairs) {
  if (interval != 1 && interval != 3)
    throw Error(ErrorCode::kUsage, fmt::format("facet interval is {}, expected 1 or 3", interval));
  if (interval != 1 && std::none_of(pairs.begin(), pairs.end(), has_facets)) {
    std::string names;
    for (const Pair pair : pairs) names.append(names.empty() ? "" : ", ").append(name(pair));
    throw Error(ErrorCode::kUsage,
                fmt::format("facet interval is {}, but {} has no facets", interval, names));
  }
}

std::vector<std::string> pair_names() {
  std::vector<std::string> all;
  for (const contract::PairRow& row : contract::kPairTable) all.emplace_back(row.name);
  return all;
}

std::vector<std::string> algorithm_names() {
  return {contract::kAlgorithmNames.begin(), contract::kAlgorithmNames.end()};
}

}  // namespace cde
