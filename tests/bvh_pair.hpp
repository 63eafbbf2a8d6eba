// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/geometry/pair.hpp"
#include "cde/support/error.hpp"

namespace cde::testing {

/// The pair type for a primary and the secondaries of a BVH, and whether its roles are swapped.
struct BvhPair {
  Pair pair;
  bool swap;
};
template <class P, class Secondary>
BvhPair bvh_pair() {
  for (unsigned p = 0; p < kPairs; ++p)
    for (const bool swap : {false, true}) {
      const auto shapes = traversal_shapes(static_cast<Pair>(p), swap);
      if (shapes && shapes->primary == kShapeOf<P> && shapes->secondary == kShapeOf<Secondary>)
        return {static_cast<Pair>(p), swap};
    }
  throw Error(ErrorCode::kUsage, "this pair cannot traverse a BVH");
}

}  // namespace cde::testing
