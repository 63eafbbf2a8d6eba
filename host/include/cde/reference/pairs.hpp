// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>

#include "cde/fp/fp_format.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/query/pair_result.hpp"

namespace cde::reference {

/// Results of a pair's pipe, in words of a format: all mirror references behind one call.
/// Spans `a` and `b` are operand words in slot order, `primary_words` and `secondary_words` words
/// per pair. `algorithm` is for ray-triangle, `box` for pairs with the box rule, `plane` for pairs
/// with a plane. Pairs without iterations ignore `iterations`. Error kUsage for sizes that do not
/// match, a format not in kPairFormats (fp/scalars.hpp), or iterations out of range.
void test_pairs(Pair pair, Algorithm algorithm, FpFormat format, std::span<const std::uint64_t> a,
                std::span<const std::uint64_t> b, std::span<PairResult> results,
                PlaneSide plane = PlaneSide::kSurface, const PairIterations& iterations = {},
                bool box = false);

/// The same for numbers in binary32, which need not be widened to words of 64 bits.
void test_pairs(Pair pair, Algorithm algorithm, std::span<const float> a, std::span<const float> b,
                std::span<PairAnswer> results, PlaneSide plane = PlaneSide::kSurface,
                const PairIterations& iterations = {}, bool box = false);

/// Work of a pair with iterations; 0 for other pairs. Evaluations: of the signed distance along a
/// direction. Passes: how often a row circulates in the iterative pipeline, which is also the
/// number of cycles between rows. Passes include those that find the witness points.
[[nodiscard]] unsigned evaluations(Pair pair, const PairIterations& iterations);
[[nodiscard]] unsigned passes(Pair pair, const PairIterations& iterations);

/// Whether this pair and algorithm have a reference.
[[nodiscard]] bool has_pair(Pair pair, Algorithm algorithm);

}  // namespace cde::reference
