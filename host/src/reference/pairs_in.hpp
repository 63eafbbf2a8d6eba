// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>

#include "cde/reference/pairs.hpp"

namespace cde::reference {

/// Operands and results of test_pairs(): words, or numbers in binary32 if there are `answers`. Both
/// share one build of the pipes, which takes long.
struct PairsData {
  std::span<const std::uint64_t> a = {}, b = {};
  std::span<PairResult> results = {};
  std::span<const float> numbers_a = {}, numbers_b = {};
  std::span<PairAnswer> answers = {};
};

/// test_pairs() in the scalar S. Each build of pairs_in.cpp compiles a few scalars.
template <class S>
struct PairsIn {
  static void test(Pair pair, Algorithm algorithm, bool box, PlaneSide plane,
                   const PairIterations& iterations, const PairsData& data);
};

}  // namespace cde::reference
