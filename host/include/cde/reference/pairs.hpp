// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>

#include "cde/fp/fp_format.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/query/pair_result.hpp"

namespace cde::reference {

/// What the pipe of a pair answers, in the words of a format: the mirror references behind one
/// call. a and b are operand words in slot order, `primary_words` and `secondary_words` a pair;
/// `algorithm` and `box` are of ray-triangle, `plane` is of pairs with one.
/// Error kUsage if sizes do not fit together, or for a format that is none of kPairFormats
/// (fp/scalars.hpp), or for a budget out of range. Pairs that take no budget ignore it.
void test_pairs(Pair pair, Algorithm algorithm, FpFormat format, std::span<const std::uint64_t> a,
                std::span<const std::uint64_t> b, std::span<PairResult> results,
                PlaneSide plane = PlaneSide::kSurface, const PairBudget& budget = {},
                bool box = false);

/// Whether there is a reference for this pair and algorithm.
[[nodiscard]] bool has_pair(Pair pair, Algorithm algorithm);

}  // namespace cde::reference
