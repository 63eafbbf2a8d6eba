// SPDX-License-Identifier: Apache-2.0
#include "cde/reference/pass.hpp"

#include <fmt/format.h>

#include <utility>

#include "cde/contract/records.hpp"
#include "cde/reference/pipes/dispatch.hpp"
#include "cde/reference/reference.hpp"
#include "cde/support/error.hpp"
#include "query/record_choice.hpp"

namespace cde::reference {

class Pass::Impl {
 public:
  virtual ~Impl() = default;
  virtual std::span<const Record> next() = 0;
};

namespace {

/// The paper's pair has a fast reference of its own.
class MollerPass : public Pass::Impl {
 public:
  MollerPass(Mode mode, bool box, std::vector<Ray> rays, std::vector<std::uint32_t> numbers,
             const std::vector<Triangle>& triangles)
      : rays_(std::move(rays)),
        numbers_(std::move(numbers)),
        sweep_(rays_, triangles, mode, {}, card::kMostPrimaries, {}, box) {}

  std::span<const Record> next() override {
    const std::span<const Record> some = sweep_.next();
    records_.assign(some.begin(), some.end());
    for (Record& r : records_) r.primary = numbers_[r.primary];
    return records_;
  }

 private:
  std::vector<Ray> rays_;
  std::vector<std::uint32_t> numbers_;
  Sweep sweep_;
  std::vector<Record> records_;
};

/// Any pair: P are the primaries' shapes, test(P, S) their reference.
template <class P, class S, class Test>
class AnyPass : public Pass::Impl {
 public:
  AnyPass(const PassQuery& query, std::vector<P> primaries, std::vector<std::uint32_t> numbers,
          const std::vector<S>& secondaries, Test test)
      : query_(query),
        primaries_(std::move(primaries)),
        numbers_(std::move(numbers)),
        secondaries_(secondaries),
        test_(test) {}

  std::span<const Record> next() override {
    records_.clear();
    const bool streaming = query_.mode == Mode::kAll || query_.mode == Mode::kHits;
    if (!streaming && done_ == 0) reduce();
    while (streaming && records_.empty() && done_ < secondaries_.size()) {
      for (std::size_t p = 0; p < primaries_.size(); ++p) {
        if (!counts(p, done_)) continue;
        const Record r = record(p, done_);
        if (query_.mode == Mode::kAll || r.f) records_.push_back(r);
      }
      ++done_;
    }
    return records_;
  }

 private:
  [[nodiscard]] Record record(std::size_t p, std::size_t s) const {
    const auto outcome = test_(primaries_[p], secondaries_[s]);
    Record r;
    r.f = outcome.f;
    r.bad = outcome.bad;
    r.t = canonical(outcome.t);
    for (int k = 0; k < 3; ++k) {
      r.cp[k] = canonical(outcome.cp[k]);
      if (query_.normals) r.n[k] = canonical(outcome.n[k]);
    }
    const bool answered = is_solid(query_.pair) && !outcome.bad;
    r.index = outcome.f || answered ? static_cast<std::uint32_t>(s) : ~0u;
    r.primary = numbers_[p];
    return r;
  }

  [[nodiscard]] bool counts(std::size_t p, std::size_t s) const {
    return !query_.counts || query_.counts(numbers_[p], static_cast<std::uint32_t>(s));
  }

  void reduce() {
    done_ = secondaries_.size();
    for (std::size_t p = 0; p < primaries_.size(); ++p) {
      Record best = unanswered(primaries_[p], numbers_[p], query_.normals);
      for (std::size_t s = 0; s < secondaries_.size(); ++s) {
        if (!counts(p, s)) continue;
        const Record r = record(p, s);
        if (!better(query_.pair, query_.mode, r, best)) continue;
        best = r;
        if (query_.mode == Mode::kAny) break;
      }
      records_.push_back(best);
    }
  }

  PassQuery query_;
  std::vector<P> primaries_;
  std::vector<std::uint32_t> numbers_;
  const std::vector<S>& secondaries_;
  Test test_;
  std::size_t done_ = 0;  ///< secondaries
  std::vector<Record> records_;
};

template <class P, class S, class Test>
std::unique_ptr<Pass::Impl> any_pass(const PassQuery& query, Shapes&& primaries,
                                     std::vector<std::uint32_t>&& numbers,
                                     const Shapes& secondaries, Test test) {
  auto* p = std::get_if<std::vector<P>>(&primaries);
  const auto* s = std::get_if<std::vector<S>>(&secondaries);
  if (p == nullptr || s == nullptr)
    throw Error(ErrorCode::kUsage,
                fmt::format("{} {} {}s against {}s", name(query.pair),
                            query.swap ? "with swap does not test" : "does not test",
                            name(shape_of(primaries)), name(shape_of(secondaries))));
  return std::make_unique<AnyPass<P, S, Test>>(query, std::move(*p), std::move(numbers), *s, test);
}

}  // namespace

Pass::Pass(const PassQuery& query, Shapes primaries, std::vector<std::uint32_t> numbers,
           const Shapes& secondaries) {
  (void)name_of(query.mode);  // or it is none
  if (size(primaries) > card::kMostPrimaries || size(primaries) != numbers.size())
    throw Error(ErrorCode::kUsage, fmt::format("a pass of {} primaries with {} numbers",
                                               size(primaries), numbers.size()));
  if (query.pair == Pair::kRayTriangle && query.algorithm == Algorithm::kMoller && !query.swap &&
      !query.counts && shape_of(primaries) == Shape::kRay &&
      shape_of(secondaries) == Shape::kTriangle) {
    impl_ = std::make_unique<MollerPass>(
        query.mode, query.box, std::get<std::vector<Ray>>(std::move(primaries)), std::move(numbers),
        std::get<std::vector<Triangle>>(secondaries));
    return;
  }
  with_pair<float>(query.pair, query.algorithm, query.box, PlaneSide::kSurface, query.budget,
                   [&]<class A, class B>(Kinds<A, B>, auto test) {
                     if (query.swap) {
                       const auto exchanged = [test](const B& b, const A& a) { return test(a, b); };
                       impl_ = any_pass<B, A>(query, std::move(primaries), std::move(numbers),
                                              secondaries, exchanged);
                     } else {
                       impl_ = any_pass<A, B>(query, std::move(primaries), std::move(numbers),
                                              secondaries, test);
                     }
                   });
}

Pass::~Pass() = default;
Pass::Pass(Pass&&) noexcept = default;
Pass& Pass::operator=(Pass&&) noexcept = default;

SweptPrimary sweep(const PassQuery& query, const Shapes& primaries, std::uint32_t number,
                   const Shapes& secondaries) {
  const Shapes one = std::visit(
      [number](const auto& list) -> Shapes {
        if (number >= list.size())
          throw Error(ErrorCode::kUsage, fmt::format("primary {} of {}", number, list.size()));
        return std::decay_t<decltype(list)>{list[number]};
      },
      primaries);
  SweptPrimary all;
  Pass asked(query, one, {number}, secondaries);
  for (auto some = asked.next(); !some.empty(); some = asked.next())
    all.records.insert(all.records.end(), some.begin(), some.end());
  PassQuery every = query;
  every.mode = Mode::kAll;
  Pass pass(every, one, {number}, secondaries);
  const bool pairs = query.mode == Mode::kAll || query.mode == Mode::kHits;
  Record best =
      std::visit([&](const auto& list) { return unanswered(list[0], number, query.normals); }, one);
  std::uint32_t secondary = 0;
  for (auto some = pass.next(); !some.empty(); some = pass.next())
    for (const Record& r : some) {
      while (query.counts && !query.counts(number, secondary)) ++secondary;
      SweptPair& swept = all.pairs.emplace_back(SweptPair{.secondary = secondary++, .record = r});
      swept.candidate =
          pairs ? query.mode == Mode::kAll || r.f : is_candidate(query.pair, query.mode, r);
      swept.kept = !pairs && better(query.pair, query.mode, r, best);
      if (swept.kept) best = r;
    }
  return all;
}

std::span<const Record> Pass::next() {
  if (!impl_) throw Error(ErrorCode::kUsage, "this pass is none: it was moved from");
  return impl_->next();
}

}  // namespace cde::reference
