// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "cde/fp/fp_format.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/query/pair_result.hpp"

namespace cde::accuracy {

/// What is measured for a pair: the card's pipe, or a variant that no card has.
enum class Variant {
  kCard,
  kFused,     ///< the pipe with fused multiply-add (fused.hpp)
  kTextbook,  ///< textbook version (textbook.hpp): quadratics, plain separating axes
};
[[nodiscard]] std::string_view name(Variant variant);
[[nodiscard]] const std::vector<Variant>& variants();

/// Whether the pair has this variant. Textbook versions exist for rays against solids, and for
/// boxes.
[[nodiscard]] bool has_variant(Pair pair, Variant variant);
/// Whether the variant computes T, CP and n in addition to F.
[[nodiscard]] bool has_distance(Pair pair, Variant variant);

/// As reference::test_pairs, for a variant other than the card's.
void test_variant(Variant variant, Pair pair, Algorithm algorithm, FpFormat format,
                  std::span<const std::uint64_t> a, std::span<const std::uint64_t> b,
                  std::span<PairResult> results, const PairIterations& iterations, bool box);

}  // namespace cde::accuracy
