// SPDX-License-Identifier: Apache-2.0
#include "accuracy/variant_in.hpp"

#include <fmt/format.h>

#include "cde/accuracy/fused.hpp"
#include "cde/accuracy/textbook.hpp"
#include "cde/fp/scalars.hpp"
#include "cde/reference/pipes/dispatch.hpp"
#include "cde/support/error.hpp"

namespace cde::accuracy {
namespace {

template <class S>
S value_of(S x) {
  return x;
}
template <class S>
S value_of(Fused<S> x) {
  return x.value();
}

/// Tests every pair of words of shapes A and B. The test computes in the scalar R; S is the
/// format's scalar.
template <class S, class R, class A, class B, class Test>
void test_pairs(std::span<const std::uint64_t> a, std::span<const std::uint64_t> b,
                std::span<PairResult> results, Test test) {
  const auto shape = []<class P>(P, const std::uint64_t* words) {
    P p;
    visit_words(p, [&words](const char*, int, auto& word) {
      if constexpr (std::is_same_v<R, S>)
        word = from_word<S>(*words++);
      else
        word = R::of(from_word<S>(*words++));
    });
    return p;
  };
  const auto word = [](R x) { return to_word(reference::canonical(value_of(x))); };
  for (std::size_t i = 0; i < results.size(); ++i) {
    const reference::Outcome<R> o =
        test(shape(A(), &a[i * A::kWords]), shape(B(), &b[i * B::kWords]));
    PairResult& r = results[i];
    r.f = o.f;
    r.bad = o.bad;
    r.t = word(o.t);
    for (int k = 0; k < 3; ++k) {
      r.cp[k] = word(o.cp[k]);
      r.n[k] = word(o.n[k]);
    }
  }
}

}  // namespace

template <class S>
void VariantIn<S>::textbook(Pair pair, std::span<const std::uint64_t> a,
                            std::span<const std::uint64_t> b, std::span<PairResult> r) {
  using T = BasicTriangle<S>;
  using Obb = BasicObb<S>;
  using Aabb = BasicAabb<S>;
  switch (pair) {
    case Pair::kRaySphere:
      return test_pairs<S, S, BasicRay<S>, BasicSphere<S>>(a, b, r, textbook::ray_sphere<S>);
    case Pair::kRayCylinder:
      return test_pairs<S, S, BasicRay<S>, BasicCylinder<S>>(a, b, r, textbook::ray_cylinder<S>);
    case Pair::kObbObb:
      return test_pairs<S, S, Obb, Obb>(a, b, r, textbook::obb_obb<S>);
    case Pair::kTriangleObb:
      return test_pairs<S, S, T, Obb>(a, b, r, textbook::triangle_box<S, Obb>);
    case Pair::kTriangleAabb:
      return test_pairs<S, S, T, Aabb>(a, b, r, textbook::triangle_box<S, Aabb>);
    default:
      throw Error(ErrorCode::kUsage, fmt::format("there is no textbook variant of {}", name(pair)));
  }
}

template <class S>
void VariantIn<S>::fused(Pair pair, Algorithm algorithm, bool box, const PairIterations& iterations,
                         std::span<const std::uint64_t> a, std::span<const std::uint64_t> b,
                         std::span<PairResult> r) {
  using R = Fused<S>;
  reference::with_pair<R>(pair, algorithm, box, PlaneSide::kSurface, iterations,
                          [&]<class A, class B>(reference::Kinds<A, B>, auto test) {
                            test_pairs<S, R, A, B>(a, b, r, test);
                          });
}

}  // namespace cde::accuracy
