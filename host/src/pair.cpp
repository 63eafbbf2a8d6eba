#include "cde/pair.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

#include "cde/error.hpp"
#include "text.hpp"

namespace cde {
namespace {

struct PairFacts {
  std::string_view name;
  Shape primary, secondary;
};
constexpr std::array<PairFacts, kPairs> kFacts{
    {{"ray-triangle", Shape::kRay, Shape::kTriangle},
     {"obb-obb", Shape::kObb, Shape::kObb},
     {"triangle-aabb", Shape::kTriangle, Shape::kAabb},
     {"triangle-obb", Shape::kTriangle, Shape::kObb},
     {"sphere-sphere", Shape::kSphere, Shape::kSphere},
     {"triangle-sphere", Shape::kTriangle, Shape::kSphere},
     {"ray-cylinder", Shape::kRay, Shape::kCylinder},
     {"triangle-cylinder", Shape::kTriangle, Shape::kCylinder},
     {"cylinder-cylinder", Shape::kCylinder, Shape::kCylinder},
     {"obb-cylinder", Shape::kObb, Shape::kCylinder},
     {"obb-plane", Shape::kObb, Shape::kPlane},
     {"ray-sphere", Shape::kRay, Shape::kSphere},
     {"sphere-obb", Shape::kSphere, Shape::kObb}}};
constexpr std::array<std::string_view, 4> kAlgorithms{"moller", "badouel", "pluecker",
                                                      "watertight"};
struct ShapeFacts {
  std::string_view name;
  unsigned words;
};
constexpr std::array<ShapeFacts, 7> kShapes{{{"ray", 8},
                                             {"triangle", 9},
                                             {"sphere", 4},
                                             {"aabb", 6},
                                             {"plane", 4},
                                             {"cylinder", 8},
                                             {"obb", 15}}};

}  // namespace

std::string_view name(Pair pair) {
  return text::entry(kFacts, pair, "pair").name;
}
std::string_view name(Algorithm algorithm) {
  return text::entry(kAlgorithms, algorithm, "algorithm");
}
std::string_view name(Shape shape) {
  return text::entry(kShapes, shape, "shape").name;
}

std::optional<Pair> pair_named(std::string_view text) {
  const auto* found = std::find_if(kFacts.begin(), kFacts.end(),
                                   [text](const PairFacts& f) { return f.name == text; });
  if (found == kFacts.end()) return std::nullopt;
  return static_cast<Pair>(found - kFacts.begin());
}
std::optional<Algorithm> algorithm_named(std::string_view text) {
  const auto* found = std::find(kAlgorithms.begin(), kAlgorithms.end(), text);
  if (found == kAlgorithms.end()) return std::nullopt;
  return static_cast<Algorithm>(found - kAlgorithms.begin());
}

unsigned words(Shape shape) {
  return text::entry(kShapes, shape, "shape").words;
}
Shape primary_shape(Pair pair) {
  return text::entry(kFacts, pair, "pair").primary;
}
Shape secondary_shape(Pair pair) {
  return text::entry(kFacts, pair, "pair").secondary;
}

void PairBudget::check() const {
  if (samples != 4 && samples != 8 && samples != 16)
    throw Error(ErrorCode::kUsage, fmt::format("budget: M is {}, expected 4, 8 or 16", samples));
  for (const auto& [what, value] : {std::pair{"K1", circle}, std::pair{"K2", free}})
    if (value > 64)
      throw Error(ErrorCode::kUsage,
                  fmt::format("budget: {} is {}, expected 0 to 64", what, value));
}

bool has_budget(Pair pair) {
  return pair == Pair::kCylinderCylinder || pair == Pair::kObbCylinder ||
         pair == Pair::kTriangleCylinder;
}

bool has_facets(Pair pair) {
  return pair == Pair::kObbObb || pair == Pair::kTriangleAabb || pair == Pair::kTriangleObb;
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

}  // namespace cde
