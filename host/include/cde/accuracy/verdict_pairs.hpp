// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>

#include "cde/fp/fp_format.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/reference/verdict/proof.hpp"

namespace cde::accuracy {

/// Pairs that verdicts are given of: bodies whose inside and whose extent along a normal are short
/// sums. A plane's gap is one itself, and rays have no normal.
[[nodiscard]] bool has_proofs(Pair pair);

/// What is certain of pairs in binary32 (operand words as reference::test_pairs has them), when the
/// pair's pipe in the narrow format proposes normal and point. What the card would refuse is
/// uncertain. Error kUsage for a pair that has none, a format of no pair, a budget out of range.
void test_certain(Pair pair, FpFormat narrow, const PairBudget& budget,
                  std::span<const std::uint64_t> a, std::span<const std::uint64_t> b,
                  std::span<reference::verdict::Certain> certain);

}  // namespace cde::accuracy
