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
/// `algorithm` is of ray-triangle, `box` of pairs with the box rule, `plane` of pairs with one.
/// Error kUsage if sizes do not fit together, or for a format that is none of kPairFormats
/// (fp/scalars.hpp), or for a budget out of range. Pairs that take no budget ignore it.
void test_pairs(Pair pair, Algorithm algorithm, FpFormat format, std::span<const std::uint64_t> a,
                std::span<const std::uint64_t> b, std::span<PairResult> results,
                PlaneSide plane = PlaneSide::kSurface, const PairBudget& budget = {},
                bool box = false);

/// Work that a budget sets. Evaluations: of the gap, each for a direction. Passes: as often a row
/// goes round the pipe, and as many clocks it takes from the next one's; those that find the
/// witness points, too. Both are 0 for pairs that take no budget, whatever it is.
[[nodiscard]] unsigned evaluations(Pair pair, const PairBudget& budget);
[[nodiscard]] unsigned passes(Pair pair, const PairBudget& budget);

/// Whether there is a reference for this pair and algorithm.
[[nodiscard]] bool has_pair(Pair pair, Algorithm algorithm);

}  // namespace cde::reference
