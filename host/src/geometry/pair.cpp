// SPDX-License-Identifier: Apache-2.0
#include "cde/geometry/pair.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

#include "cde/contract/registers.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/suggest.hpp"
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
namespace {

std::optional<Shape> shape_named(std::string_view text) {
  if (text == "box") return Shape::kObb;
  for (std::size_t i = 0; i < contract::kShapeTable.size(); ++i)
    if (contract::kShapeTable[i].name == text) return static_cast<Shape>(i);
  return std::nullopt;
}

std::string pairs_with(Shape shape) {
  std::vector<std::string_view> names;
  for (const contract::PairRow& row : contract::kPairTable)
    if (row.primary == shape || row.secondary == shape) names.push_back(row.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

PairName pair_in_any_order(std::string_view text) {
  if (const auto pair = pair_named(text)) return {*pair};
  const std::size_t dash = text.find('-');
  const auto first = shape_named(text.substr(0, dash));
  const auto second = dash == std::string_view::npos ? first : shape_named(text.substr(dash + 1));
  if (!first || !second || dash == std::string_view::npos) check_known(text, pair_names(), "pair");
  const Shape a = first.value(), b = second.value();
  for (std::size_t i = 0; i < contract::kPairTable.size(); ++i) {
    const contract::PairRow& row = contract::kPairTable[i];
    if (row.primary == a && row.secondary == b) return {static_cast<Pair>(i)};
    if (row.primary == b && row.secondary == a) return {static_cast<Pair>(i), true};
  }
  throw Error(
      ErrorCode::kUsage,
      fmt::format("no pair {}; with {} there are: {}{}", in_quotes(text), name(a), pairs_with(a),
                  a == b ? "" : fmt::format("; with {}: {}", name(b), pairs_with(b))));
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

void PairIterations::check() const {
  if (samples != 4 && samples != 8 && samples != 16)
    throw Error(ErrorCode::kUsage,
                fmt::format("iterations: M is {}, expected 4, 8 or 16", samples));
  for (const auto& [what, value] : {std::pair{"K1", circle}, std::pair{"K2", free}})
    if (value > card::kIterationsMost)
      throw Error(ErrorCode::kUsage, fmt::format("iterations: {} is {}, expected 0 to {}", what,
                                                 value, card::kIterationsMost));
}

bool has_iterations(Pair pair) {
  return contract::has(contract::kIterativePairs, pair);
}

bool has_sat_interval(Pair pair) {
  return contract::has(contract::kSatPairs, pair);
}

bool has_box_rule(Pair pair) {
  return contract::has(contract::kBoxPairs | contract::kBoundPairs, pair);
}

std::optional<TraversalShapes> traversal_shapes(Pair pair, bool swap) {
  if (!has_box_rule(pair) && !contract::has(contract::kPlainPairs, pair)) return std::nullopt;
  const Shape a = primary_shape(pair), b = secondary_shape(pair);
  if (!swap) return TraversalShapes{a, b};
  if (a == b || !contract::has(contract::kBoundPairs, pair)) return std::nullopt;
  return TraversalShapes{b, a};
}

bool has_filter(Pair pair) {
  return contract::has(contract::kFilterPairs, pair);
}

void check_sat_interval(unsigned interval, std::span<const Pair> pairs) {
  if (interval != 1 && interval != 3)
    throw Error(ErrorCode::kUsage, fmt::format("SAT interval is {}, expected 1 or 3", interval));
  if (interval != 1 && std::none_of(pairs.begin(), pairs.end(), has_sat_interval)) {
    std::string names;
    for (const Pair pair : pairs) names.append(names.empty() ? "" : ", ").append(name(pair));
    throw Error(ErrorCode::kUsage,
                fmt::format("SAT interval is {}, but {} has no candidate axes", interval, names));
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
