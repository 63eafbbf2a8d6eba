// SPDX-License-Identifier: Apache-2.0
#include "cde/accuracy/verdict_pairs.hpp"

#include <fmt/format.h>

#include "cde/fp/scalars.hpp"
#include "cde/reference/pipes/dispatch.hpp"
#include "cde/reference/verdict/proposal.hpp"
#include "cde/support/error.hpp"

namespace cde::accuracy {
namespace {

using Words = std::span<const std::uint64_t>;

template <class P>
P shape_of(const std::uint64_t* words) {
  P shape;
  visit_words(shape, [&words](const char*, int, float& x) { x = from_word<float>(*words++); });
  return shape;
}

template <class N, template <class> class A, template <class> class B, class Test>
void sweep(reference::Kinds<A<N>, B<N>>, Test test, Words a, Words b,
           std::span<reference::verdict::Certain> certain) {
  for (std::size_t i = 0; i < certain.size(); ++i) {
    const auto x = shape_of<A<float>>(&a[i * A<float>::kWords]);
    const auto y = shape_of<B<float>>(&b[i * B<float>::kWords]);
    certain[i] = reference::bad(x) || reference::bad(y)
                     ? reference::verdict::Certain::kNeither
                     : reference::verdict::judge(x, y, reference::verdict::propose<N>(x, y, test));
  }
}

}  // namespace

bool has_proofs(Pair pair) {
  return primary_shape(pair) != Shape::kRay && secondary_shape(pair) != Shape::kPlane &&
         secondary_shape(pair) != Shape::kTriangle;
}

void test_certain(Pair pair, FpFormat narrow, const PairBudget& budget, Words a, Words b,
                  std::span<reference::verdict::Certain> certain) {
  if (!has_proofs(pair))
    throw Error(ErrorCode::kUsage, fmt::format("{} has no verdicts", name(pair)));
  const bool known = with_scalar(narrow, [&]<class N>() {
    reference::with_pair<N>(
        pair, Algorithm::kMoller, false, PlaneSide::kSurface, budget,
        [&]<class A, class B>(reference::Kinds<A, B> kinds, auto test) {
          if constexpr (kShapeOf<A> != Shape::kRay && kShapeOf<B> == Shape::kCylinder)
            sweep<N>(kinds, test, a, b, certain);
          else if constexpr (kShapeOf<A> != Shape::kRay && kShapeOf<B> != Shape::kPlane &&
                             kShapeOf<B> != Shape::kTriangle)
            sweep<N>(kinds, reference::verdict::FreePipe(), a, b, certain);
        });
  });
  if (!known) throw Error(ErrorCode::kUsage, fmt::format("no pair in {}", narrow.name()));
}

}  // namespace cde::accuracy
