// SPDX-License-Identifier: Apache-2.0
// cde explain on RTL that is right: no place is named, or hardly one of the rings, which it knows
// less well. Hundreds of processes each.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "cde/check/random_pairs.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/oracle/cases.hpp"
#include "cde/reference/pairs.hpp"
#include "run_cde.hpp"

namespace cde::testing {
namespace {

using nlohmann::json;

constexpr std::uint64_t kSeed = 20261125;
constexpr unsigned kCases = 200;
constexpr unsigned kFalseOfRings = 3;  // of kCases

struct Pipe {
  Pair pair;
  Algorithm algorithm;
};
void PrintTo(const Pipe& p, std::ostream* out) {
  *out << name(p.pair) << ' ' << name(p.algorithm);
}

std::vector<Pipe> pipes() {
  std::vector<Pipe> all;
  for (unsigned p = 0; p < kPairs; ++p)
    for (unsigned a = 0; a < kAlgorithms; ++a) {
      const Pipe pipe{static_cast<Pair>(p), static_cast<Algorithm>(a)};
      if (reference::has_pair(pipe.pair, pipe.algorithm)) all.push_back(pipe);
    }
  return all;
}

/// The words of a case: random pairs, those near the decision and of directed families, and those
/// of everyday scenes take turns.
std::string words(Pair pair, unsigned index) {
  if (index % 2 == 0) {
    RandomPairs random(kSeed + index);
    std::vector<float> a, b;
    random.pair(pair, a, b);
    return fmt::format("{:a} | {:a}", fmt::join(a, " "), fmt::join(b, " "));
  }
  const oracle::Case c = index % 4 == 1 ? oracle::generate(pair, kSeed, index / 2)
                                        : oracle::everyday(pair, kSeed, index / 2);
  return fmt::format("{:a} | {:a}", fmt::join(c.a, " "), fmt::join(c.b, " "));
}

class ExplainGood : public Cli, public ::testing::WithParamInterface<Pipe> {};

TEST_P(ExplainGood, NamesNoPlace) {
  const Pipe pipe = GetParam();
  unsigned wrong = 0;
  std::string which;
  for (unsigned i = 0; i < kCases; ++i) {
    std::vector<std::string> line{
        "explain", std::string(name(pipe.pair)), words(pipe.pair, i), "--arith", "host", "--json"};
    if (pipe.pair == Pair::kRayTriangle)
      line.insert(line.end(), {"--algorithm", std::string(name(pipe.algorithm))});
    const Ran ran = cde(line);
    ASSERT_EQ(ran.status, 0) << ran.err << line[2];
    const json j = json::parse(ran.out);
    ASSERT_TRUE(j["same"].get<bool>()) << line[2];
    if (j["first_differences"].empty()) continue;
    if (++wrong <= 3) which += fmt::format("{}\n{}\n", line[2], j["first_differences"][0].dump());
  }
  EXPECT_LE(wrong, has_budget(pipe.pair) ? kFalseOfRings : 0) << which;
}

INSTANTIATE_TEST_SUITE_P(Pipes, ExplainGood, ::testing::ValuesIn(pipes()), [](const auto& info) {
  std::string text(name(info.param.pair));
  if (info.param.pair == Pair::kRayTriangle) text += fmt::format("_{}", name(info.param.algorithm));
  for (char& c : text) c = c == '-' ? '_' : c;
  return text;
});

}  // namespace
}  // namespace cde::testing
