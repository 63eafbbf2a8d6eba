// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/format.h>

#include <initializer_list>
#include <ostream>
#include <span>
#include <string>
#include <vector>

#include "cases.hpp"
#include "cde/reference/pipes/transform.hpp"
#include "pair_records.hpp"

/// Boards with a transformer, random shapes and objects, and passes that are compared with the
/// reference.
namespace cde::testing {

struct MovingBoard {
  const char* name;
  Arithmetic arithmetic;
  std::vector<Pair> pairs;
  unsigned lanes;
  unsigned slower = 0;  ///< extra cycles per operator

  friend void PrintTo(const MovingBoard& m, std::ostream* out) { *out << m.name; }
};
BoardConfig config_of(const MovingBoard& kind, Transformer transform = Transformer::kBoth);
inline const MovingBoard kMany{
    "Many",
    Arithmetic::kHost,
    {Pair::kRayTriangle, Pair::kSphereSphere, Pair::kRayCylinder, Pair::kObbPlane},
    8};
inline const MovingBoard kMovingGates{
    "Gates", Arithmetic::kRtl, {Pair::kRayTriangle, Pair::kObbPlane}, 2};
inline const MovingBoard kSlowGates{"SlowGates", Arithmetic::kRtl, {Pair::kRayTriangle}, 2, 1};
inline const MovingBoard kSlowHost{"SlowHost", Arithmetic::kHost, {Pair::kRayTriangle}, 2, 1};
inline const MovingBoard kParallel{
    "Parallel", Arithmetic::kHost, {Pair::kRayTriangle, Pair::kTriangleSphere}, 8};
inline const MovingBoard kBoxes{"Boxes", Arithmetic::kHost, {Pair::kTriangleAabb}, 1};

Eigen::Matrix3f rotation(Random& random);
Transform motion(Random& random);

Eigen::Vector3f direction(Random& random);

/// Source of random shapes.
struct Draws {
  Random& random;

  [[nodiscard]] Eigen::Vector3f point() const { return random.in_box(4); }
  [[nodiscard]] float size() const { return random.in(0.1f, 2); }
  [[nodiscard]] Eigen::Vector3f around(const Eigen::Vector3f& c) const {
    return c + random.in_box(4);
  }
  [[nodiscard]] Eigen::Vector3f direction() const { return testing::direction(random); }
  [[nodiscard]] Eigen::Matrix3f rotation() const { return testing::rotation(random); }
};

/// A shape within its contract.
template <class P>
P shape(Random& random) {
  Draws draws{random};
  P made = P::random(draws);
  if constexpr (requires { made.tmin; }) made.tmin = -1, made.tmax = random.in(1, 9);
  return made;
}

/// Random shapes. Some violate the contract, and some violate it only after they move: a
/// translation by 2^40, the largest coordinate, takes a large word out of the range of lengths.
template <class P>
std::vector<P> shapes(Random& random, std::size_t count) {
  std::vector<P> all;
  for (std::size_t i = 0; i < count; ++i) {
    auto words = to_words(shape<P>(random));
    const float odd[] = {std::numeric_limits<float>::quiet_NaN(),
                         -std::numeric_limits<float>::infinity(), 0x1p40f, -0.0f};
    if (random.below(16) == 0)
      words[random.below(static_cast<std::uint32_t>(words.size()))] = odd[random.below(4)];
    all.push_back(from_words<P>(words));
  }
  return all;
}

/// Random ranges within `slots`: overlapping, and many of one slot.
std::vector<Object> objects(Random& random, std::uint32_t slots, std::size_t count, bool boxes);

struct MovingRays {
  std::vector<Ray> primaries;
  std::vector<Triangle> secondaries;
};
MovingRays rays(Random& random, std::size_t primaries, std::size_t secondaries);

/// Compares a pass over objects with the reference, in all modes.
template <class P, class S>
void check_pass(Board& board, Pair pair, bool swap, const std::vector<P>& primaries,
                const std::vector<S>& secondaries, std::span<const Object> of_primaries,
                std::span<const Object> of_secondaries,
                std::initializer_list<Mode> modes = {Mode::kNearest, Mode::kFarthest, Mode::kAny,
                                                     Mode::kAll, Mode::kHits}) {
  const FpFormat format = board.format();
  const auto tested = reference::pass_secondaries(secondaries, of_secondaries, format);
  const std::vector<P> posed =
      reference::posed(std::span<const P>(primaries), of_primaries, format);
  std::vector<PairResult> results;
  if constexpr (std::is_same_v<P, S>) {
    results = swap ? all_pairs(pair, tested.shapes, posed, true, {}, format)
                   : all_pairs(pair, posed, tested.shapes, false, {}, format);
  } else {
    if (swap) results = all_pairs(pair, tested.shapes, posed, true, {}, format);
    if (!swap) results = all_pairs(pair, posed, tested.shapes, false, {}, format);
  }
  std::vector<bool> bad;
  bad.reserve(posed.size());
  for (const P& p : posed) bad.push_back(defect(p, format).has_value());
  for (const Mode mode : modes) {
    SCOPED_TRACE(fmt::format("{}{}, {} over {}", name(pair), swap ? " swapped" : "",
                             of_primaries.size(), of_secondaries.size()));
    compare(board.run({.mode = mode, .pair = pair, .swap = swap}),
            expected(pair, results, tested.slots, bad, mode, false, format), mode);
  }
}

}  // namespace cde::testing
