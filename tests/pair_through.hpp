// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/geometry/pair.hpp"
#include "cde/support/error.hpp"

namespace cde::testing {

/// The pair type for a primary and the secondaries of a BVH, and whether its roles are swapped.
struct PairThrough {
  Pair pair;
  bool swap;
};
template <class P, class Secondary>
PairThrough pair_through() {
  for (unsigned p = 0; p < kPairs; ++p)
    for (const bool swap : {false, true}) {
      const auto way = way_through(static_cast<Pair>(p), swap);
      if (way && way->primary == kShapeOf<P> && way->secondary == kShapeOf<Secondary>)
        return {static_cast<Pair>(p), swap};
    }
  throw Error(ErrorCode::kUsage, "no way through");
}

}  // namespace cde::testing
