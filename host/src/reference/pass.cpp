// SPDX-License-Identifier: Apache-2.0
#include "cde/reference/pass.hpp"

#include <fmt/format.h>

#include <utility>

#include "cde/contract/records.hpp"
#include "cde/fp/scalars.hpp"
#include "cde/reference/pairs.hpp"
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

/// Rays and triangles use their own fast reference.
class RayPass : public Pass::Impl {
 public:
  RayPass(const PassQuery& query, std::vector<Ray> rays, std::vector<std::uint32_t> numbers,
          const std::vector<Triangle>& triangles)
      : rays_(std::move(rays)),
        numbers_(std::move(numbers)),
        brute_force_(rays_, triangles, query.mode, {}, card::kMostPrimaries, {}, query.box, {},
                     query.algorithm) {}

  std::span<const Record> next() override {
    const std::span<const Record> some = brute_force_.next();
    records_.assign(some.begin(), some.end());
    for (Record& r : records_) r.primary = numbers_[r.primary];
    return records_;
  }

 private:
  std::vector<Ray> rays_;
  std::vector<std::uint32_t> numbers_;
  BruteForce brute_force_;
  std::vector<Record> records_;
};

/// Tests the pairs of a packet. Private to the pass.
class Tester {
 public:
  virtual ~Tester() = default;
  /// Appends the answers of a secondary with the primaries at these places.
  virtual void test(std::size_t secondary, std::span<const std::uint32_t> places,
                    std::vector<Outcome<float>>& answers) = 0;
};

/// Tests in fp32. P is the primaries' shape, and test(P, S) the pair's reference.
template <class P, class S, class Test>
class FloatTester : public Tester {
 public:
  FloatTester(std::vector<P> primaries, const std::vector<S>& secondaries, Test test)
      : primaries_(std::move(primaries)), secondaries_(secondaries), test_(test) {}

  void test(std::size_t secondary, std::span<const std::uint32_t> places,
            std::vector<Outcome<float>>& answers) override {
    for (const std::uint32_t p : places)
      answers.push_back(test_(primaries_[p], secondaries_[secondary]));
  }

 private:
  std::vector<P> primaries_;
  const std::vector<S>& secondaries_;
  Test test_;
};

/// Tests in another number format, with shapes as its words.
class WordTester : public Tester {
 public:
  WordTester(const PassQuery& query, const Shapes& primaries, const Shapes& secondaries)
      : query_(query), words_(query.format), secondaries_(secondaries) {
    for (std::size_t p = 0; p < size(primaries); ++p) primaries_.push_back(encoded(primaries, p));
  }

  void test(std::size_t secondary, std::span<const std::uint32_t> places,
            std::vector<Outcome<float>>& answers) override {
    const std::vector<std::uint64_t> other = encoded(secondaries_, secondary);
    packet_.clear(), others_.clear();
    for (const std::uint32_t p : places) {
      packet_.insert(packet_.end(), primaries_[p].begin(), primaries_[p].end());
      others_.insert(others_.end(), other.begin(), other.end());
    }
    results_.assign(places.size(), {});
    test_pairs(query_.pair, query_.algorithm, query_.format, query_.swap ? others_ : packet_,
               query_.swap ? packet_ : others_, results_, PlaneSide::kSurface, query_.iterations,
               query_.box);
    for (const PairResult& r : results_) {
      Outcome<float>& o = answers.emplace_back();
      o.f = r.f, o.bad = r.bad;
      o.t = words_.decode(r.t);
      for (int k = 0; k < 3; ++k) o.cp[k] = words_.decode(r.cp[k]), o.n[k] = words_.decode(r.n[k]);
    }
  }

 private:
  [[nodiscard]] std::vector<std::uint64_t> encoded(const Shapes& shapes, std::size_t i) const {
    std::vector<std::uint64_t> words;
    for (const float x : numbers_of(shapes, i)) words.push_back(words_.encode(x));
    return words;
  }

  PassQuery query_;
  FloatWords words_;
  const Shapes& secondaries_;
  std::vector<std::vector<std::uint64_t>> primaries_;
  std::vector<std::uint64_t> packet_, others_;
  std::vector<PairResult> results_;
};

/// Tests any pair. `best` holds the records of primaries without any answer.
class AnyPass : public Pass::Impl {
 public:
  AnyPass(const PassQuery& query, std::unique_ptr<Tester> tester, std::vector<Record> best,
          std::size_t secondaries)
      : query_(query),
        tester_(std::move(tester)),
        best_(std::move(best)),
        secondaries_(secondaries) {}

  std::span<const Record> next() override {
    records_.clear();
    const bool streaming = query_.mode == Mode::kAll || query_.mode == Mode::kHits;
    if (!streaming && done_ < secondaries_) return reduce();
    if (!streaming && secondaries_ == 0 && done_++ == 0) return best_;
    for (; streaming && records_.empty() && done_ < secondaries_; ++done_)
      for (const Record& r : answers_of(done_))
        if (query_.mode == Mode::kAll || r.f) records_.push_back(r);
    return records_;
  }

 private:
  /// Answers of a secondary with all primaries that it counts for. Mode any leaves out primaries
  /// with a hit.
  const std::vector<Record>& answers_of(std::size_t s) {
    const auto secondary = static_cast<std::uint32_t>(s);
    places_.clear(), outcomes_.clear(), answers_.clear();
    for (std::size_t p = 0; p < best_.size(); ++p) {
      if (query_.mode == Mode::kAny && best_[p].index != ~0u) continue;
      if (!query_.counts || query_.counts(best_[p].primary, secondary))
        places_.push_back(static_cast<std::uint32_t>(p));
    }
    tester_->test(s, places_, outcomes_);
    for (std::size_t i = 0; i < places_.size(); ++i)
      answers_.push_back(record(outcomes_[i], places_[i], secondary));
    return answers_;
  }

  [[nodiscard]] Record record(const Outcome<float>& outcome, std::size_t p,
                              std::uint32_t secondary) const {
    Record r;
    r.f = outcome.f;
    r.bad = outcome.bad;
    r.t = canonical(outcome.t);
    for (int k = 0; k < 3; ++k) {
      r.cp[k] = canonical(outcome.cp[k]);
      if (query_.normals) r.n[k] = canonical(outcome.n[k]);
    }
    const bool answered = is_solid(query_.pair) && !outcome.bad;
    r.index = outcome.f || answered ? secondary : ~0u;
    r.primary = best_[p].primary;
    return r;
  }

  std::span<const Record> reduce() {
    for (; done_ < secondaries_; ++done_) {
      const std::vector<Record>& some = answers_of(done_);
      for (std::size_t i = 0; i < some.size(); ++i) {
        Record& best = best_[places_[i]];
        if (better(query_.pair, query_.mode, some[i], best)) best = some[i];
      }
    }
    return best_;
  }

  PassQuery query_;
  std::unique_ptr<Tester> tester_;
  std::vector<Record> best_;
  std::size_t secondaries_, done_ = 0;
  std::vector<std::uint32_t> places_;  // places of the primaries in answers_
  std::vector<Outcome<float>> outcomes_;
  std::vector<Record> answers_, records_;
};

template <class P, class S, class Test>
std::unique_ptr<Tester> float_tester(Shapes&& primaries, const Shapes& secondaries, Test test) {
  return std::make_unique<FloatTester<P, S, Test>>(std::get<std::vector<P>>(std::move(primaries)),
                                                   std::get<std::vector<S>>(secondaries), test);
}

std::unique_ptr<Tester> tester(const PassQuery& query, Shapes&& primaries,
                               const Shapes& secondaries) {
  if (query.format != FpFormat{})
    return std::make_unique<WordTester>(query, primaries, secondaries);
  std::unique_ptr<Tester> made;
  if (query.pair == Pair::kRayTriangle && !query.swap) {
    with_ray_triangle<float>(query.algorithm, query.box, [&](auto test) {
      made = float_tester<Ray, Triangle>(std::move(primaries), secondaries, test);
    });
    return made;
  }
  with_pair<float>(query.pair, query.algorithm, query.box, PlaneSide::kSurface, query.iterations,
                   [&]<class A, class B>(Kinds<A, B>, auto test) {
                     if (query.swap) {
                       const auto exchanged = [test](const B& b, const A& a) { return test(a, b); };
                       made = float_tester<B, A>(std::move(primaries), secondaries, exchanged);
                     } else {
                       made = float_tester<A, B>(std::move(primaries), secondaries, test);
                     }
                   });
  return made;
}

void check_query(const PassQuery& query, const Shapes& primaries, std::size_t numbers,
                 const Shapes& secondaries) {
  (void)name_of(query.mode);  // throws for an unknown mode
  if (size(primaries) > card::kMostPrimaries || size(primaries) != numbers)
    throw Error(
        ErrorCode::kUsage,
        fmt::format("a pass of {} primaries has {} numbers; expected one each, of at most {}",
                    size(primaries), numbers, card::kMostPrimaries));
  if (!is_card_format(query.format))
    throw Error(ErrorCode::kUsage, fmt::format("no card has the format {}", query.format.name()));
  Shape first = primary_shape(query.pair), second = secondary_shape(query.pair);
  if (query.swap) std::swap(first, second);
  if (shape_of(primaries) != first || shape_of(secondaries) != second)
    throw Error(ErrorCode::kUsage,
                fmt::format("{} {} {}s against {}s", name(query.pair),
                            query.swap ? "with swap does not test" : "does not test",
                            name(shape_of(primaries)), name(shape_of(secondaries))));
}

/// The record of each primary without any answer.
std::vector<Record> all_unanswered(const PassQuery& query, const Shapes& primaries,
                                   std::span<const std::uint32_t> numbers) {
  std::vector<Record> records;
  std::visit(
      [&](const auto& list) {
        for (std::size_t p = 0; p < list.size(); ++p)
          records.push_back(unanswered(list[p], numbers[p], query.normals, query.format));
      },
      primaries);
  return records;
}

}  // namespace

Pass::Pass(const PassQuery& query, Shapes primaries, std::vector<std::uint32_t> numbers,
           const Shapes& secondaries) {
  check_query(query, primaries, numbers.size(), secondaries);
  if (query.pair == Pair::kRayTriangle && has_fast_brute_force(query.algorithm, query.format) &&
      !query.swap && !query.counts) {
    impl_ =
        std::make_unique<RayPass>(query, std::get<std::vector<Ray>>(std::move(primaries)),
                                  std::move(numbers), std::get<std::vector<Triangle>>(secondaries));
    return;
  }
  std::vector<Record> records = all_unanswered(query, primaries, numbers);
  impl_ = std::make_unique<AnyPass>(query, tester(query, std::move(primaries), secondaries),
                                    std::move(records), size(secondaries));
}

Pass::~Pass() = default;
Pass::Pass(Pass&&) noexcept = default;
Pass& Pass::operator=(Pass&&) noexcept = default;

BruteForcePrimary brute_force(const PassQuery& query, const Shapes& primaries, std::uint32_t number,
                              const Shapes& secondaries) {
  const Shapes one = std::visit(
      [number](const auto& list) -> Shapes {
        if (number >= list.size())
          throw Error(ErrorCode::kUsage,
                      fmt::format("primary {}, but there are {}", number, list.size()));
        return std::decay_t<decltype(list)>{list[number]};
      },
      primaries);
  BruteForcePrimary all;
  Pass asked(query, one, {number}, secondaries);
  for (auto some = asked.next(); !some.empty(); some = asked.next())
    all.records.insert(all.records.end(), some.begin(), some.end());
  PassQuery every = query;
  every.mode = Mode::kAll;
  Pass pass(every, one, {number}, secondaries);
  const bool pairs = query.mode == Mode::kAll || query.mode == Mode::kHits;
  const std::uint32_t numbers[] = {number};
  Record best = all_unanswered(query, one, numbers).front();
  std::uint32_t secondary = 0;
  for (auto some = pass.next(); !some.empty(); some = pass.next())
    for (const Record& r : some) {
      while (query.counts && !query.counts(number, secondary)) ++secondary;
      BruteForcePair& tested =
          all.pairs.emplace_back(BruteForcePair{.secondary = secondary++, .record = r});
      tested.candidate =
          pairs ? query.mode == Mode::kAll || r.f : is_candidate(query.pair, query.mode, r);
      tested.kept = !pairs && better(query.pair, query.mode, r, best);
      if (tested.kept) best = r;
    }
  return all;
}

std::span<const Record> Pass::next() {
  if (!impl_) throw Error(ErrorCode::kUsage, "this Pass is empty: it was moved from");
  return impl_->next();
}

}  // namespace cde::reference
