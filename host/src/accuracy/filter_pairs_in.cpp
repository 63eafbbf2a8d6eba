// SPDX-License-Identifier: Apache-2.0
#include "accuracy/filter_pairs_in.hpp"

#include "cde/fp/scalars.hpp"
#include "cde/reference/filter/proposal.hpp"
#include "cde/reference/pipes/dispatch.hpp"

namespace cde::accuracy {
namespace {

template <class P>
P shape_of(const std::uint64_t* words) {
  P shape;
  visit_words(shape, [&words](const char*, int, float& x) { x = from_word<float>(*words++); });
  return shape;
}

template <class N, template <class> class A, template <class> class B, class Test>
void test_pairs(reference::Kinds<A<N>, B<N>>, Test test, Words a, Words b,
                std::span<reference::filter::Certain> certain) {
  for (std::size_t i = 0; i < certain.size(); ++i) {
    const auto x = shape_of<A<float>>(&a[i * A<float>::kWords]);
    const auto y = shape_of<B<float>>(&b[i * B<float>::kWords]);
    certain[i] = reference::bad(x) || reference::bad(y)
                     ? reference::filter::Certain::kNeither
                     : reference::filter::certify(x, y, reference::filter::propose<N>(x, y, test));
  }
}

}  // namespace

template <class N>
void CertainIn<N>::test(Pair pair, const PairIterations& iterations, Words a, Words b,
                        std::span<reference::filter::Certain> certain) {
  reference::with_pair<N>(
      pair, Algorithm::kMoller, false, PlaneSide::kSurface, iterations,
      [&]<class A, class B>(reference::Kinds<A, B> kinds, const auto& test) {
        if constexpr (kShapeOf<A> != Shape::kRay && kShapeOf<B> == Shape::kCylinder)
          test_pairs<N>(kinds, test, a, b, certain);
        else if constexpr (kShapeOf<A> != Shape::kRay && kShapeOf<B> != Shape::kPlane &&
                           kShapeOf<B> != Shape::kTriangle)
          test_pairs<N>(kinds, reference::filter::FreePipe(), a, b, certain);
      });
}

}  // namespace cde::accuracy
