// SPDX-License-Identifier: Apache-2.0
#include "reference/pairs_in.hpp"

#include "cde/fp/scalars.hpp"
#include "cde/reference/pipes/dispatch.hpp"

namespace cde::reference {
namespace {

template <class P>
P shape(const std::uint64_t* words) {
  P p;
  visit_words(p, [&words](const char*, int, auto& word) {
    word = from_word<typename P::Scalar>(*words++);
  });
  return p;
}

template <class S, class A, class B, class Test>
void test_pairs(std::span<const std::uint64_t> a, std::span<const std::uint64_t> b,
                std::span<PairResult> results, Test test) {
  for (std::size_t i = 0; i < results.size(); ++i) {
    const Outcome<S> o = test(shape<A>(&a[i * A::kWords]), shape<B>(&b[i * B::kWords]));
    PairResult& r = results[i];
    r.f = o.f;
    r.bad = o.bad;
    r.t = to_word(canonical(o.t));
    for (int k = 0; k < 3; ++k) {
      r.cp[k] = to_word<S>(canonical<S>(o.cp[k]));
      r.n[k] = to_word<S>(canonical<S>(o.n[k]));
    }
  }
}

}  // namespace

template <class S>
void PairsIn<S>::test(Pair pair, Algorithm algorithm, bool box, PlaneSide plane,
                      const PairIterations& iterations, std::span<const std::uint64_t> a,
                      std::span<const std::uint64_t> b, std::span<PairResult> results) {
  with_pair<S>(pair, algorithm, box, plane, iterations,
               [&]<class A, class B>(Kinds<A, B>, const auto& test) {
                 test_pairs<S, A, B>(a, b, results, test);
               });
}

}  // namespace cde::reference
