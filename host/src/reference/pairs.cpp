// SPDX-License-Identifier: Apache-2.0
#include "cde/reference/pairs.hpp"

#include <fmt/format.h>

#include "cde/fp/scalars.hpp"
#include "cde/reference/pipes/cylinder/schedule.hpp"
#include "cde/support/error.hpp"
#include "reference/pairs_in.hpp"

namespace cde::reference {

namespace {

cylinder::Body body_of(Pair pair) {
  const Shape primary = primary_shape(pair);
  return primary == Shape::kCylinder ? cylinder::Body::kCylinder
         : primary == Shape::kObb    ? cylinder::Body::kBox
                                     : cylinder::Body::kTriangle;
}
cylinder::Iterations signed_iterations(const PairIterations& iterations) {
  return {static_cast<int>(iterations.samples), static_cast<int>(iterations.circle),
          static_cast<int>(iterations.free)};
}

}  // namespace

unsigned evaluations(Pair pair, const PairIterations& iterations) {
  if (!has_iterations(pair)) return 0;
  return static_cast<unsigned>(cylinder::evaluations(body_of(pair), signed_iterations(iterations)));
}

unsigned passes(Pair pair, const PairIterations& iterations) {
  if (!has_iterations(pair)) return 0;
  return static_cast<unsigned>(cylinder::passes(body_of(pair), signed_iterations(iterations)));
}

bool has_pair(Pair pair, Algorithm algorithm) {
  return pair == Pair::kRayTriangle || algorithm == Algorithm::kMoller;
}

namespace {

void check_sizes(Pair pair, std::size_t pairs, std::size_t a, std::size_t b) {
  if (a != pairs * primary_words(pair) || b != pairs * secondary_words(pair))
    throw Error(ErrorCode::kUsage,
                fmt::format("{} pairs of {} need {} and {} words, not {} and {}", pairs, name(pair),
                            pairs * primary_words(pair), pairs * secondary_words(pair), a, b));
}

}  // namespace

void test_pairs(Pair pair, Algorithm algorithm, FpFormat format, std::span<const std::uint64_t> a,
                std::span<const std::uint64_t> b, std::span<PairResult> results, PlaneSide plane,
                const PairIterations& iterations, bool box) {
  iterations.check();
  check_sizes(pair, results.size(), a.size(), b.size());
  const PairsData data = {.a = a, .b = b, .results = results};
  const auto in_scalar = [&]<class S>() {
    PairsIn<S>::test(pair, algorithm, box, plane, iterations, data);
  };
  if (!with_scalar(format, in_scalar))
    throw Error(ErrorCode::kUsage, fmt::format("pairs have no reference in {}", format.name()));
}

void test_pairs(Pair pair, Algorithm algorithm, std::span<const float> a, std::span<const float> b,
                std::span<PairAnswer> results, PlaneSide plane, const PairIterations& iterations,
                bool box) {
  iterations.check();
  check_sizes(pair, results.size(), a.size(), b.size());
  PairsIn<float>::test(pair, algorithm, box, plane, iterations,
                       {.numbers_a = a, .numbers_b = b, .answers = results});
}

}  // namespace cde::reference
