// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>

#include "cde/fp/fp_format.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/reference/filter/proof.hpp"

namespace cde::accuracy {

/// Pairs with a certified filter. For their bodies, the tests for inside and the extent along a
/// normal are short sums. Pairs with a plane or a ray have no filter: a plane's distance is already
/// a short sum, and rays have no normal.
[[nodiscard]] bool has_proofs(Pair pair);

/// Certified decisions for pairs in binary32. Operand words are as for reference::test_pairs. The
/// pair's pipe in the narrow format proposes normal and point. Bad input is uncertain. Error kUsage
/// for a pair without a filter, a format without pairs, or iterations out of range.
void test_certain(Pair pair, FpFormat narrow, const PairIterations& iterations,
                  std::span<const std::uint64_t> a, std::span<const std::uint64_t> b,
                  std::span<reference::filter::Certain> certain);

}  // namespace cde::accuracy
