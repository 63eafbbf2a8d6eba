// SPDX-License-Identifier: Apache-2.0
// For correct RTL the explanation names no place. It finds all operators of pipes, and most
// operators of iterative pipelines.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <bit>
#include <ostream>
#include <string>
#include <vector>

#include "cde/card/pipe_options.hpp"
#include "cde/check/random_pairs.hpp"
#include "cde/explain/explanation.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/oracle/cases.hpp"
#include "cde/reference/pairs.hpp"

namespace cde::testing {
namespace {

constexpr std::uint64_t kSeed = 20261125;
constexpr unsigned kCases = 200;
constexpr std::size_t kFoundIfIterative = 92;  // percent of the operations

struct Pipe {
  Pair pair;
  Algorithm algorithm;
  const char* arithmetic;
};
void PrintTo(const Pipe& p, std::ostream* out) {
  *out << name(p.pair) << ' ' << name(p.algorithm) << ' ' << p.arithmetic;
}

std::vector<Pipe> pipes() {
  std::vector<Pipe> all;
  for (unsigned p = 0; p < kPairs; ++p)
    for (unsigned a = 0; a < kAlgorithms; ++a)
      for (const char* arithmetic : {"host", "rtl"}) {
        const Pipe pipe{static_cast<Pair>(p), static_cast<Algorithm>(a), arithmetic};
        if (reference::has_pair(pipe.pair, pipe.algorithm)) all.push_back(pipe);
      }
  return all;
}

/// Every second case is a random pair. The others alternate between a directed family near the
/// decision and an everyday scene.
struct Operands {
  std::vector<float> a, b;
};
Operands operands(Pair pair, unsigned index) {
  if (index % 2 == 0) {
    RandomPairs random(kSeed + index);
    Operands o;
    random.pair(pair, o.a, o.b);
    return o;
  }
  const oracle::Case c = index % 4 == 1 ? oracle::generate(pair, kSeed, index / 2)
                                        : oracle::everyday(pair, kSeed, index / 2);
  return {{c.a.begin(), c.a.end()}, {c.b.begin(), c.b.end()}};
}

std::vector<std::uint64_t> words(const std::vector<float>& values) {
  std::vector<std::uint64_t> all;
  for (const float value : values) all.push_back(std::bit_cast<std::uint32_t>(value));
  return all;
}

/// The first operations for which no operator of the card was found.
std::string missing(const explain::Explanation& e) {
  std::string text;
  unsigned lines = 0;
  for (const explain::Compared& c : e.operations) {
    if (c.seat.which >= 0 || ++lines > 5) continue;
    const explain::Step& step =
        e.recording.steps[static_cast<std::size_t>(e.recording.operators[c.operation])];
    text += fmt::format("{}: {} {:x} {:x} = {:x}{}\n", c.operation,
                        static_cast<int>(step.operation), step.a, step.b, step.result,
                        c.comparison == explain::Comparison::kUnknown ? ", not known" : "");
  }
  return text;
}

class ExplainGood : public ::testing::TestWithParam<Pipe> {};

TEST_P(ExplainGood, CorrectPipe_FindsEveryOperatorAndNamesNoPlace) {
  const Pipe& pipe = GetParam();
  PairOptions options;
  options.pair = name(pipe.pair);
  options.algorithm = name(pipe.algorithm);
  options.arithmetic = pipe.arithmetic;
  options.box = false;  // host arithmetic has no operators for it
  explain::Explainer explainer(configuration(options), iterations_of(options));
  unsigned explained = 0;
  for (unsigned i = 0; i < kCases; ++i) {
    const Operands o = operands(pipe.pair, i);
    SCOPED_TRACE(fmt::format("{:a} | {:a}", fmt::join(o.a, " "), fmt::join(o.b, " ")));
    const explain::Explanation e = explainer.explain(words(o.a), words(o.b));
    ASSERT_TRUE(e.same());
    if (e.reference.bad) continue;
    ++explained;
    // An iterative pipeline repeats its work for every direction, so many words repeat.
    const std::size_t least = has_iterations(pipe.pair) ? kFoundIfIterative : 100;
    ASSERT_GE(e.found * 100, e.operations.size() * least) << missing(e);
    ASSERT_TRUE(e.findings.empty())
        << (e.findings.front().sources.empty() ? "" : e.findings.front().sources.front().text());
  }
  EXPECT_GT(explained, kCases / 2);
}

INSTANTIATE_TEST_SUITE_P(Pipes, ExplainGood, ::testing::ValuesIn(pipes()), [](const auto& info) {
  std::string text(name(info.param.pair));
  if (info.param.pair == Pair::kRayTriangle) text += fmt::format("_{}", name(info.param.algorithm));
  text += fmt::format("_{}", info.param.arithmetic);
  for (char& c : text) c = c == '-' ? '_' : c;
  return text;
});

}  // namespace
}  // namespace cde::testing
