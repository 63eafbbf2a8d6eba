// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/geometry/pair.hpp"
#include "counted.hpp"

namespace cde::testing {

/// Operators of a pair without iterations, fully unrolled, as in a pipe that accepts one pair per
/// cycle. The depth is in operators, without the selection of the outcome. The count comes from the
/// mirror reference, without input checks, the box rule and the scaling of a pair to size one.
[[nodiscard]] Tally operators(Pair pair, Algorithm algorithm = Algorithm::kMoller);

}  // namespace cde::testing
