// SPDX-License-Identifier: Apache-2.0
#include "cde/accuracy/variant.hpp"

#include "accuracy/variant_in.hpp"
#include "cde/fp/scalars.hpp"

namespace cde::accuracy {

std::string_view name(Variant variant) {
  return variant == Variant::kFused ? "fused" : variant == Variant::kTextbook ? "textbook" : "card";
}

const std::vector<Variant>& variants() {
  static const std::vector<Variant> kAll{Variant::kCard, Variant::kFused, Variant::kTextbook};
  return kAll;
}

bool has_variant(Pair pair, Variant variant) {
  return variant != Variant::kTextbook || pair == Pair::kRaySphere || pair == Pair::kRayCylinder ||
         !has_distance(pair, variant);
}

bool has_distance(Pair pair, Variant variant) {
  return variant != Variant::kTextbook ||
         (pair != Pair::kObbObb && pair != Pair::kTriangleObb && pair != Pair::kTriangleAabb);
}

void test_variant(Variant variant, Pair pair, Algorithm algorithm, FpFormat format,
                  std::span<const std::uint64_t> a, std::span<const std::uint64_t> b,
                  std::span<PairResult> results, const PairIterations& iterations, bool box) {
  (void)with_scalar(format, [&]<class S>() {
    if (variant == Variant::kTextbook)
      VariantIn<S>::textbook(pair, a, b, results);
    else
      VariantIn<S>::fused(pair, algorithm, box, iterations, a, b, results);
  });
}

}  // namespace cde::accuracy
