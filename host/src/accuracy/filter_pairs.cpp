// SPDX-License-Identifier: Apache-2.0
#include "cde/accuracy/filter_pairs.hpp"

#include <fmt/format.h>

#include "accuracy/filter_pairs_in.hpp"
#include "cde/fp/scalars.hpp"
#include "cde/support/error.hpp"

namespace cde::accuracy {

bool has_proofs(Pair pair) {
  return primary_shape(pair) != Shape::kRay && secondary_shape(pair) != Shape::kPlane &&
         secondary_shape(pair) != Shape::kTriangle;
}

void test_certain(Pair pair, FpFormat narrow, const PairIterations& iterations, Words a, Words b,
                  std::span<reference::filter::Certain> certain) {
  if (!has_proofs(pair))
    throw Error(ErrorCode::kUsage, fmt::format("{} has no certified filter", name(pair)));
  const bool known =
      with_scalar(narrow, [&]<class N>() { CertainIn<N>::test(pair, iterations, a, b, certain); });
  if (!known)
    throw Error(ErrorCode::kUsage, fmt::format("pairs are not computed in {}", narrow.name()));
}

}  // namespace cde::accuracy
