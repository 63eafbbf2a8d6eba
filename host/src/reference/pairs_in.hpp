// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>

#include "cde/reference/pairs.hpp"

namespace cde::reference {

/// test_pairs() in the scalar S. Each build of pairs_in.cpp compiles a few scalars.
template <class S>
struct PairsIn {
  static void test(Pair pair, Algorithm algorithm, bool box, PlaneSide plane,
                   const PairIterations& iterations, std::span<const std::uint64_t> a,
                   std::span<const std::uint64_t> b, std::span<PairResult> results);
};

}  // namespace cde::reference
