// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/geometry/pair.hpp"
#include "counted.hpp"

namespace cde::testing {

/// Operators of a pair without a budget, all unrolled, as a pipe has them that takes a pair a
/// clock; the depth is in operators, without the selection of the outcome. Counted in the mirror
/// reference, without the input checks, the box rule and what brings a pair to the size of one.
[[nodiscard]] Tally operators(Pair pair, Algorithm algorithm = Algorithm::kMoller);

}  // namespace cde::testing
