// SPDX-License-Identifier: Apache-2.0
#include "explain/record_in.hpp"

#include <algorithm>

#include "cde/geometry/check.hpp"
#include "cde/reference/pipes/dispatch.hpp"

namespace cde::explain {
namespace {

template <class P>
P shape(const std::uint64_t* words) {
  P p;
  visit_words(p, [&words](const char*, int, auto& word) {
    using Word = std::remove_reference_t<decltype(word)>;
    word = Word::of(from_word<decltype(word.value())>(*words++));
  });
  return p;
}

/// Records steps during its lifetime.
class Recorder {
 public:
  explicit Recorder(Recording& to) { Recording::now = &to; }
  ~Recorder() { Recording::now = nullptr; }
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;
};

}  // namespace

template <class S>
PairRecording RecordIn<S>::record(const PairConfig& config, std::span<const std::uint64_t> a,
                                  std::span<const std::uint64_t> b,
                                  const PairIterations& iterations) {
  PairRecording recorded;
  using R = Recorded<S>;
  reference::with_pair<R>(
      config.pair, config.algorithm, config.box, config.plane, iterations,
      [&]<class A, class B>(reference::Kinds<A, B>, auto test) {
        const A x = shape<A>(a.data());
        const B y = shape<B>(b.data());
        Recording all;
        const Recorder recorder(all);
        (void)(reference::bad(x) || reference::bad(y));
        auto of_the_check = std::count_if(all.steps.begin(), all.steps.end(),
                                          [](const Step& s) { return s.is_operator; });
        all.steps.clear();
        const reference::Outcome<R> o = test(x, y);
        recorded.result.f = o.f;
        recorded.result.bad = o.bad;
        recorded.result.t = to_word(reference::canonical(o.t.value()));
        recorded.outputs[0] = o.t.step();
        for (int k = 0; k < 3; ++k) {
          recorded.result.cp[k] = to_word(reference::canonical(o.cp[k].value()));
          recorded.result.n[k] = to_word(reference::canonical(o.n[k].value()));
          recorded.outputs[1 + k] = o.cp[k].step();
          recorded.outputs[4 + k] = o.n[k].step();
        }
        recorded.steps = std::move(all.steps);
        for (std::size_t i = 0; i < recorded.steps.size(); ++i)
          if (recorded.steps[i].is_operator && of_the_check-- <= 0)
            recorded.operators.push_back(static_cast<std::int32_t>(i));
      });
  return recorded;
}

}  // namespace cde::explain
