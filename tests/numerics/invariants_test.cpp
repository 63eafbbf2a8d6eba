// SPDX-License-Identifier: Apache-2.0
// Invariants without expected values. The same pair, rotated, moved, swapped or written in other
// words, has the same answer. Half turns about the world's axes only change signs, which rounding
// ignores, so every bit must be the same. Other changes affect the order and ties of sums, and
// answers stay within their bands.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cde/fp/scalars.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/oracle/cases.hpp"
#include "cde/oracle/certificate.hpp"
#include "cde/oracle/rays.hpp"
#include "cde/oracle/signed_distance.hpp"
#include "cde/reference/pairs.hpp"
#include "in_docs.hpp"

namespace cde::testing {
namespace {

constexpr std::uint64_t kSeed = 20261126;
constexpr std::uint64_t kCases = 2000;
constexpr double kBand = 16;  // in u S

using Words = std::vector<double>;

/// A linear map of the axes to axes with signs: exact on every word.
struct Turn {
  std::array<int, 3> from;
  std::array<double, 3> sign;
};
constexpr Turn kHalfTurns[] = {
    {{0, 1, 2}, {1, -1, -1}}, {{0, 1, 2}, {-1, 1, -1}}, {{0, 1, 2}, {-1, -1, 1}}};
constexpr Turn kQuarterTurns[] = {{{1, 2, 0}, {1, 1, 1}},
                                  {{2, 0, 1}, {1, 1, 1}},
                                  {{1, 0, 2}, {-1, 1, 1}},
                                  {{0, 2, 1}, {1, -1, 1}},
                                  {{2, 1, 0}, {1, 1, -1}}};

/// Which words of a shape are points, and which are directions. The columns of an OBB's rotation
/// turn row by row.
struct Layout {
  std::vector<std::size_t> points, directions;
  bool rotation = false;
};
Layout layout(Shape shape) {
  switch (shape) {
    case Shape::kTriangle:
      return {{0, 3, 6}, {}};
    case Shape::kSphere:
      return {{0}, {}};
    case Shape::kAabb:
      return {{0, 3}, {}};
    case Shape::kObb:
      return {{0}, {}, true};
    case Shape::kPlane:
      return {{}, {0}};
    case Shape::kCylinder:
    case Shape::kRay:
      return {{0}, {3}};
    default:
      return {};
  }
}

void turn(Words& words, std::size_t at, const Turn& by, std::size_t step = 1) {
  const std::array<double, 3> v{words[at], words[at + step], words[at + 2 * step]};
  for (std::size_t i = 0; i < 3; ++i)
    words[at + i * step] = by.sign[i] * v.at(static_cast<std::size_t>(by.from[i]));
}

Words turned(Words words, Shape shape, const Turn& by) {
  const Layout l = layout(shape);
  for (const auto& list : {l.points, l.directions})
    for (const std::size_t at : list) turn(words, at, by);
  if (l.rotation)
    for (std::size_t column = 0; column < 3; ++column) turn(words, 6 + column, by, 3);
  if (shape == Shape::kAabb)
    for (std::size_t i = 0; i < 3; ++i)
      if (words[i] > words[3 + i]) std::swap(words[i], words[3 + i]);
  return words;
}

struct Operands {
  Words a, b;
};
/// Another form of a case; empty if the pair has none.
using Change =
    std::function<std::optional<Operands>(Pair, const Operands&, const FpFormat&, std::uint64_t)>;

Operands both_turned(Pair pair, const Operands& o, const Turn& by) {
  return {turned(o.a, primary_shape(pair), by), turned(o.b, secondary_shape(pair), by)};
}

std::optional<Operands> half_turn(Pair pair, const Operands& o, const FpFormat&, std::uint64_t i) {
  return both_turned(pair, o, kHalfTurns[i % std::size(kHalfTurns)]);
}
std::optional<Operands> quarter_turn(Pair pair, const Operands& o, const FpFormat&,
                                     std::uint64_t i) {
  return both_turned(pair, o, kQuarterTurns[i % std::size(kQuarterTurns)]);
}

/// Moves the pair by a power of two, if no word is rounded.
std::optional<Operands> moved(Pair pair, const Operands& o, const FpFormat& format,
                              std::uint64_t i) {
  Operands to = o;
  double largest = 0;
  for (auto [words, shape] :
       {std::pair(&to.a, primary_shape(pair)), std::pair(&to.b, secondary_shape(pair))}) {
    if (shape == Shape::kPlane) return std::nullopt;
    for (const std::size_t at : layout(shape).points)
      for (std::size_t k = 0; k < 3; ++k) largest = std::max(largest, std::abs((*words)[at + k]));
  }
  const double by = std::ldexp(i % 2 == 0 ? 1 : -1, std::ilogb(largest) - static_cast<int>(i % 3));
  for (auto [words, shape] :
       {std::pair(&to.a, primary_shape(pair)), std::pair(&to.b, secondary_shape(pair))})
    for (const std::size_t at : layout(shape).points)
      for (std::size_t k = 0; k < 3; ++k) {
        double& word = (*words)[at + k];
        const double before = word;
        word += by;
        if (word - by != before || format.decode(format.encode(word)) != word) return std::nullopt;
      }
  return to;
}

std::optional<Operands> exchanged(Pair pair, const Operands& o, const FpFormat&, std::uint64_t) {
  if (primary_shape(pair) != secondary_shape(pair)) return std::nullopt;
  return Operands{o.b, o.a};
}

/// Vertices in another order, box axes reversed or exchanged, a cylinder's axis reversed.
std::optional<Operands> other_words(Pair pair, const Operands& o, const FpFormat&,
                                    std::uint64_t i) {
  Operands to = o;
  bool changed = false;
  for (auto [words, shape] :
       {std::pair(&to.a, primary_shape(pair)), std::pair(&to.b, secondary_shape(pair))}) {
    if (shape == Shape::kTriangle) {
      std::rotate(words->begin(), words->begin() + 3, words->end());
      if (i % 2 == 0) std::swap_ranges(words->begin(), words->begin() + 3, words->begin() + 6);
    } else if (shape == Shape::kObb) {
      const std::size_t x = i % 3, y = (i + 1) % 3;
      std::swap((*words)[3 + x], (*words)[3 + y]);
      for (std::size_t row = 6; row < 15; row += 3) {
        std::swap((*words)[row + x], (*words)[row + y]);
        (*words)[row + x] = -(*words)[row + x];
      }
    } else if (shape == Shape::kCylinder) {
      for (std::size_t k = 3; k < 6; ++k) (*words)[k] = -(*words)[k];
    } else {
      continue;
    }
    changed = true;
  }
  return changed ? std::optional(to) : std::nullopt;
}

struct Invariant {
  const char* name;
  Change change;
  bool exact;            ///< every bit of F and T is the same
  bool may_leave_range;  ///< the range of the format
};
const std::array<Invariant, 5> kInvariants{{
    {"half turn", half_turn, true, false},
    {"quarter turn", quarter_turn, false, false},
    {"moved", moved, true, true},
    {"exchanged", exchanged, false, false},
    {"other words", other_words, false, false},
}};

struct Parameter {
  Pair pair;
  Algorithm algorithm;
  bool box;
  FpFormat format;
};

std::vector<Parameter> parameters() {
  std::vector<Parameter> all;
  for (const FpFormat format : {FpFormat{}, FpFormat{5, 10}})
    for (unsigned p = 0; p < kPairs; ++p)
      for (unsigned a = 0; a < kAlgorithms; ++a) {
        const auto pair = static_cast<Pair>(p);
        const auto algorithm = static_cast<Algorithm>(a);
        if (!reference::has_pair(pair, algorithm)) continue;
        all.push_back({pair, algorithm, false, format});
        if (pair == Pair::kRayTriangle) all.push_back({pair, algorithm, true, format});
      }
  return all;
}

std::string label(const Parameter& p) {
  std::string text(name(p.pair));
  if (p.pair == Pair::kRayTriangle)
    text += fmt::format(" {}{}", name(p.algorithm), p.box ? " box" : "");
  return text + " " + p.format.name();
}

void PrintTo(const Parameter& p, std::ostream* out) {
  *out << label(p);
}

/// Answers of the card; operands are exact in the format.
std::vector<PairResult> answers(const Parameter& p, const std::vector<Operands>& operands) {
  std::vector<std::uint64_t> a, b;
  for (const Operands& o : operands) {
    for (const double x : o.a) a.push_back(p.format.encode(x));
    for (const double x : o.b) b.push_back(p.format.encode(x));
  }
  std::vector<PairResult> results(operands.size());
  reference::test_pairs(p.pair, p.algorithm, p.format, a, b, results, PlaneSide::kSurface, {},
                        p.box);
  return results;
}

/// Results for one invariant in one pipe.
struct Seen {
  std::size_t cases = 0, same = 0, in_band = 0, wrong = 0;
  double worst = 0;  ///< difference of T in u S
};

/// Factor of a ray's band. moller and the algorithms in world coordinates compute the plane from
/// edges. In world coordinates the error also grows with the distance from the world's origin.
double loss(const Parameter& p, const oracle::Case& c, const oracle::RayAnswer& answer) {
  if (p.pair != Pair::kRayTriangle || p.algorithm == Algorithm::kWatertight) return 1;
  if (p.algorithm == Algorithm::kMoller) return answer.aspect;
  double largest = 0;
  for (const Words& words : {Words(c.a.begin(), c.a.begin() + 3), c.b})
    for (const double x : words) largest = std::max(largest, std::abs(x));
  return answer.aspect * (1 + largest / answer.scale) / answer.cosine;
}

/// Whether a decision may differ: it lies within the band of the certified distance, or of the
/// exact ray.
bool may_differ(const Parameter& p, const Operands& o, double u) {
  const oracle::Case c{p.pair, 0, 0, "", o.a, o.b};
  if (oracle::has_ray(p.pair)) {
    const oracle::RayAnswer answer = oracle::cast(c);
    return answer.margin <= kBand * u * loss(p, c, answer);
  }
  const oracle::Shape a = c.shape_a(), b = c.shape_b();
  const oracle::SignedDistance distance = oracle::signed_distance(a, b);
  const double band = kBand * u * oracle::scene_size(a, b);
  return distance.lo <= band && distance.hi >= -band;
}

void compare(Seen& seen, const Parameter& p, const Operands& was_of, const PairResult& was,
             const Operands& is_of, const PairResult& is, bool may_leave_range,
             const std::string& what) {
  if (was.bad || is.bad) {
    // The moved pair may leave the range of the format.
    if (!may_leave_range) {
      EXPECT_EQ(was.bad, is.bad) << what;
    }
    return;
  }
  ++seen.cases;
  const double u = std::ldexp(1, -p.format.man_bits - 1);
  if (was.f == is.f && was.t == is.t) {
    ++seen.same;
    return;
  }
  const oracle::Case c{p.pair, 0, 0, "", is_of.a, is_of.b};
  const bool ray = oracle::has_ray(p.pair);
  if (was.f != is.f && (ray || !has_iterations(p.pair))) {
    if (may_differ(p, was_of, u) || may_differ(p, is_of, u)) {
      ++seen.in_band;
    } else if (++seen.wrong <= 3) {
      ADD_FAILURE() << what << ": F " << was.f << " becomes " << is.f << '\n' << c.describe();
    }
  }
  if (ray && !(was.f && is.f)) return;
  const double s = p.format.decode(was.t) * (!ray && was.f ? -1 : 1);
  const double s_now = p.format.decode(is.t) * (!ray && is.f ? -1 : 1);
  double unit = u;
  if (ray) {
    const oracle::RayAnswer answer = oracle::cast(c);
    if (!answer.hit || answer.margin_t <= kBand * u || answer.cosine * answer.cosine <= kBand * u)
      return;
    unit *= answer.scale / (c.ray().d.norm() * answer.cosine);
  } else {
    unit *= oracle::scene_size(c.shape_a(), c.shape_b());
  }
  seen.worst = std::max(seen.worst, std::abs(s - s_now) / unit);
}

/// Exceptions where bits may still differ:
/// - Pairs in world coordinates depend on their position.
/// - A turned AABB swaps the parts of its corners, and its candidate axes count from the lower
///   corner.
/// - The samples of a rim start at a world axis.
/// - In fp16 a pair is scaled to size one by its words, which moving changes, and small values lose
///   bits below the range.
bool excepted(const Parameter& p, const Invariant& invariant) {
  const bool world = p.pair == Pair::kRayTriangle &&
                     (p.algorithm == Algorithm::kBadouel || p.algorithm == Algorithm::kPluecker);
  if (invariant.may_leave_range) return world || p.format != FpFormat{};
  return p.pair == Pair::kTriangleAabb || p.pair == Pair::kTriangleCylinder ||
         p.pair == Pair::kObbCylinder;
}

/// Results per invariant; no cases for an invariant that the pair does not have.
std::array<Seen, kInvariants.size()> measured(const Parameter& p) {
  const oracle::Format format{p.format.exp_bits, p.format.man_bits};
  std::vector<Operands> operands;
  for (std::uint64_t i = 0; i < kCases; ++i) {
    const oracle::Case c = i % 4 == 0   ? oracle::everyday(p.pair, kSeed, i / 4, format)
                           : i % 4 == 1 ? oracle::hard(p.pair, kSeed, i / 4, format)
                                        : oracle::generate(p.pair, kSeed, i / 2, format);
    operands.push_back({c.a, c.b});
  }
  const std::vector<PairResult> results = answers(p, operands);
  std::array<Seen, kInvariants.size()> all;
  for (std::size_t k = 0; k < kInvariants.size(); ++k) {
    const Invariant& invariant = kInvariants.at(k);
    std::vector<Operands> changed;
    std::vector<std::size_t> of;
    for (std::size_t i = 0; i < operands.size(); ++i)
      if (auto o = invariant.change(p.pair, operands[i], p.format, i)) {
        changed.push_back(std::move(*o));
        of.push_back(i);
      }
    const std::vector<PairResult> now = answers(p, changed);
    for (std::size_t i = 0; i < changed.size(); ++i)
      compare(all.at(k), p, operands[of[i]], results[of[i]], changed[i], now[i],
              invariant.may_leave_range, fmt::format("{}, {}", label(p), invariant.name));
  }
  return all;
}

class Invariants : public ::testing::TestWithParam<Parameter> {};

TEST_P(Invariants, Changes_KeepTheAnswer) {
  const Parameter p = GetParam();
  const auto all = measured(p);
  for (std::size_t k = 0; k < kInvariants.size(); ++k) {
    const Invariant& invariant = kInvariants.at(k);
    const Seen& seen = all.at(k);
    const bool known = invariant.change(p.pair, {Words(15), Words(15)}, p.format, 0).has_value();
    if (!known) continue;
    EXPECT_GT(seen.cases, kCases / 20) << invariant.name;
    EXPECT_EQ(seen.wrong, 0u) << invariant.name;
    if (invariant.exact && !excepted(p, invariant)) {
      EXPECT_EQ(seen.same, seen.cases) << invariant.name;
    }
  }
}

/// A line of the table: in how many of a hundred cases F and T are bit-identical, and by how many u
/// S T differs at most.
std::string line_of(const Parameter& p, const std::array<Seen, kInvariants.size()>& all) {
  std::string name = label(p);
  name.resize(name.rfind(' '));
  std::string line = fmt::format("| {} |", name);
  for (const Seen& seen : all) {
    if (seen.cases == 0) {
      line += " |";
    } else if (seen.same == seen.cases) {
      line += " every bit |";
    } else {
      const double share = 100.0 * static_cast<double>(seen.same) / static_cast<double>(seen.cases);
      line += fmt::format(" {:.1f} %, {:.2g} u S |", std::floor(10 * share) / 10, seen.worst);
    }
  }
  return line;
}

TEST(InvariantsTable, Figures_EqualTheDocs) {
  std::vector<std::string> lines;
  for (const Parameter& p : parameters())
    if (p.format == FpFormat{}) lines.push_back(line_of(p, measured(p)));
  expect_in_docs("tables/stability.md", lines);
}

INSTANTIATE_TEST_SUITE_P(Pipes, Invariants, ::testing::ValuesIn(parameters()),
                         [](const auto& info) {
                           std::string text = label(info.param);
                           for (char& c : text) c = c == '-' || c == ' ' ? '_' : c;
                           return text;
                         });

}  // namespace
}  // namespace cde::testing
