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

template <class S>
void store(const Outcome<S>& o, PairResult& r) {
  r.f = o.f;
  r.bad = o.bad;
  r.t = to_word(canonical(o.t));
  for (int k = 0; k < 3; ++k) {
    r.cp[k] = to_word<S>(canonical<S>(o.cp[k]));
    r.n[k] = to_word<S>(canonical<S>(o.n[k]));
  }
}

[[maybe_unused]] void store(const Outcome<float>& o, PairAnswer& r) {
  r.f = o.f;
  r.bad = o.bad;
  r.t = canonical(o.t);
  for (std::size_t k = 0; k < 3; ++k) {
    r.cp[k] = canonical(o.cp[static_cast<int>(k)]);
    r.n[k] = canonical(o.n[static_cast<int>(k)]);
  }
}

template <class S, class A, class B, class Test>
void test_pairs(const PairsData& data, Test test) {
  const bool numbers = !data.answers.empty();
  const std::size_t count = numbers ? data.answers.size() : data.results.size();
  for (std::size_t i = 0; i < count; ++i) {
    A a;
    B b;
    if constexpr (std::same_as<S, float>) {
      if (numbers) {
        a = from_words<A>(data.numbers_a.subspan(i * A::kWords).template first<A::kWords>());
        b = from_words<B>(data.numbers_b.subspan(i * B::kWords).template first<B::kWords>());
      }
    }
    if (!numbers) {
      a = shape<A>(&data.a[i * A::kWords]);
      b = shape<B>(&data.b[i * B::kWords]);
    }
    const Outcome<S> o = test(a, b);
    if constexpr (std::same_as<S, float>)
      if (numbers) store(o, data.answers[i]);
    if (!numbers) store(o, data.results[i]);
  }
}

}  // namespace

template <class S>
void PairsIn<S>::test(Pair pair, Algorithm algorithm, bool box, PlaneSide plane,
                      const PairIterations& iterations, const PairsData& data) {
  with_pair<S>(
      pair, algorithm, box, plane, iterations,
      [&]<class A, class B>(Kinds<A, B>, const auto& test) { test_pairs<S, A, B>(data, test); });
}

}  // namespace cde::reference
