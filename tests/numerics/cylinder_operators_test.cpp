// SPDX-License-Identifier: Apache-2.0
// The operators of the evaluator of the three cylinder pairs.
#include <gtest/gtest.h>

#include <cstdio>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "cde/oracle/cases.hpp"
#include "cde/reference/pipes/cylinder/pairs.hpp"
#include "counted.hpp"
#include "cylinder_cases.hpp"

namespace cde::testing {
namespace {

template <class P>
P primitive(const std::vector<double>& words) {
  const std::vector<float> exact(words.begin(), words.end());
  return from_words<P>(std::span<const float, P::kWords>(exact.data(), P::kWords));
}

using Phases = std::map<int, Tally>;

/// The same value with depth 0.
void restart(Counted& x) {
  x = Counted(static_cast<float>(x));
}
template <typename V>
requires requires(V v) {
  v.size();
}
void restart(V& values) {
  for (auto& x : values) restart(x);
}

/// One loop of every phase.
Phases operators(reference::cylinder::Pair<Counted> pair) {
  namespace cylinder = reference::cylinder;
  const cylinder::Iterations iterations{4, 2, 2};
  Phases phases;
  cylinder::Search<Counted> s;
  for (int k = 0;; ++k) {
    restart(pair.d), restart(pair.b_reach), restart(pair.axis), restart(pair.reach);
    restart(pair.face), restart(s.best_g), restart(s.best_n), restart(s.next), restart(s.score);
    restart(s.lo_n), restart(s.lo_y), restart(s.hi_n), restart(s.hi_y), restart(s.q);
    restart(s.last.g), restart(s.last.n), restart(s.last.y), restart(s.back.g), restart(s.back.y);
    restart(s.last_slope), restart(s.back_slope), restart(s.best_slope);
    restart(s.witness), restart(s.off);
    const cylinder::Pass p = cylinder::pass(pair.body, iterations, k);
    Counted::tally = {};
    if (!cylinder::step<Counted>(pair, s, iterations, k)) return phases;
    phases[static_cast<int>(p.phase)] = Counted::tally;
  }
}

const char* const kPhases[] = {"frame", "axis",   "centre", "vertex", "cap",
                               "side",  "beside", "sample", "refine", "pole",
                               "start", "newton", "touch",  "project"};

/// Operators and depth of one loop of each phase. Most operators are common to all phases.
/// Acknowledge a change here and in docs/reference/pairs_cylinder.md.
const std::pair<const char*, std::map<std::string, std::string>> kOperators[] = {
    {"cylinder-cylinder",
     {{"centre", "80 mul, 3 div, 3 sqrt, 27 add, 31 sub, 5 cmp, depth 22"},
      {"cap", "80 mul, 3 div, 3 sqrt, 27 add, 31 sub, 5 cmp, depth 22"},
      {"side", "78 mul, 3 div, 3 sqrt, 29 add, 28 sub, 8 cmp, depth 24"},
      {"beside", "93 mul, 3 div, 3 sqrt, 40 add, 31 sub, 6 cmp, 3 min/max, depth 33"},
      {"refine", "136 mul, 4 div, 3 sqrt, 52 add, 43 sub, 9 cmp, 3 min/max, depth 36"},
      {"pole", "114 mul, 4 div, 4 sqrt, 48 add, 36 sub, 10 cmp, 2 min/max, depth 43"},
      {"start", "113 mul, 4 div, 5 sqrt, 49 add, 34 sub, 7 cmp, 5 min/max, depth 43"},
      {"newton", "113 mul, 4 div, 5 sqrt, 49 add, 34 sub, 8 cmp, 5 min/max, depth 43"},
      {"touch", "143 mul, 5 div, 4 sqrt, 67 add, 71 sub, 16 cmp, 8 min/max, depth 36"},
      {"project", "149 mul, 6 div, 5 sqrt, 69 add, 71 sub, 17 cmp, 8 min/max, depth 55"}}},
    {"OBB-cylinder",
     {{"frame", "46 mul, 2 div, 2 sqrt, 30 add, 20 sub, 6 cmp, depth 18"},
      {"axis", "46 mul, 2 div, 2 sqrt, 30 add, 20 sub, 6 cmp, depth 18"},
      {"vertex", "71 mul, 2 div, 3 sqrt, 43 add, 31 sub, 8 cmp, depth 30"},
      {"side", "56 mul, 2 div, 2 sqrt, 32 add, 23 sub, 7 cmp, depth 24"},
      {"sample", "95 mul, 2 div, 2 sqrt, 52 add, 32 sub, 14 cmp, 5 min/max, depth 39"},
      {"refine", "114 mul, 3 div, 2 sqrt, 55 add, 38 sub, 10 cmp, 3 min/max, depth 35"},
      {"touch", "119 mul, 3 div, 2 sqrt, 75 add, 56 sub, 14 cmp, 11 min/max, depth 32"},
      {"project", "125 mul, 4 div, 3 sqrt, 77 add, 56 sub, 15 cmp, 11 min/max, depth 48"}}},
    {"triangle-cylinder",
     {{"frame", "64 mul, 2 div, 2 sqrt, 28 add, 23 sub, 16 cmp, 6 min/max, depth 18"},
      {"axis", "46 mul, 2 div, 2 sqrt, 22 add, 20 sub, 10 cmp, 6 min/max, depth 18"},
      {"vertex", "71 mul, 2 div, 3 sqrt, 29 add, 31 sub, 12 cmp, 6 min/max, depth 28"},
      {"side", "56 mul, 2 div, 2 sqrt, 24 add, 23 sub, 11 cmp, 6 min/max, depth 24"},
      {"sample", "95 mul, 2 div, 2 sqrt, 44 add, 32 sub, 18 cmp, 11 min/max, depth 39"},
      {"refine", "114 mul, 3 div, 2 sqrt, 47 add, 38 sub, 14 cmp, 9 min/max, depth 35"},
      {"touch", "180 mul, 6 div, 2 sqrt, 96 add, 89 sub, 27 cmp, 18 min/max, depth 35"},
      {"project", "186 mul, 7 div, 3 sqrt, 98 add, 89 sub, 28 cmp, 18 min/max, depth 54"}}},
};

TEST(CylinderOperators, Operators_EqualTheDocs) {
  namespace cylinder = reference::cylinder;
  using C = Counted;
  const auto make = [](oracle::Pair pair, auto tag) {
    const oracle::Case c = oracle::generate(pair, kCylinderSeed, 0);
    using A = decltype(tag);
    return operators(cylinder::begin<C>(primitive_cast<C>(primitive<A>(c.a)),
                                        primitive_cast<C>(primitive<Cylinder>(c.b))));
  };
  const Phases got[] = {make(oracle::Pair::kCylinderCylinder, Cylinder{}),
                        make(oracle::Pair::kObbCylinder, Obb{}),
                        make(oracle::Pair::kTriangleCylinder, Triangle{})};
  for (int i = 0; i < 3; ++i) {
    const auto& [name, stated] = kOperators[i];
    std::map<std::string, std::string> texts;
    for (const auto& [phase, tally] : got[i]) {
      texts[kPhases[phase]] = tally.text();
      std::printf("%s %-8s %s\n", name, kPhases[phase], tally.text().c_str());
    }
    EXPECT_EQ(texts, stated) << name;
  }
}

}  // namespace
}  // namespace cde::testing
