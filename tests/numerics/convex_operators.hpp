// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "cde/geometry/pair.hpp"
#include "counted.hpp"

namespace cde::testing {

/// Pairs of solids with a closed form, in the order of their codes.
[[nodiscard]] std::vector<Pair> convex_pairs();

/// Operators of such a pair, all unrolled, as a pipe has them that takes a pair a clock; the depth
/// is in operators. Counted in the mirror reference, without what brings a pair to the size of one.
[[nodiscard]] Tally convex_operators(Pair pair);

}  // namespace cde::testing
