// What the mirror references of the three cylinder pairs answer, against the certified oracle: the
// shortfall of s_K per budget, that it never lies above s, witness points, degenerate operands,
// every format, and the operators that the evaluator is made of.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "cde/reference/cylinder/pairs.hpp"
#include "counted.hpp"
#include "oracle/oracle.hpp"

namespace cde::testing {
namespace {

using oracle::Vec;
using reference::Outcome;
using reference::cylinder::Body;
using reference::cylinder::Budget;

constexpr std::uint64_t kSeed = 20070129;
constexpr Budget kFull{8, 16, 16};

template <class P>
P primitive(const std::vector<double>& words) {
  const std::vector<float> exact(words.begin(), words.end());
  return from_words<P>(std::span<const float, P::kWords>(exact.data(), P::kWords));
}

/// The pair's reference on the operands rounded to S.
template <typename S>
Outcome<S> answer(oracle::Pair pair, const std::vector<double>& a, const std::vector<double>& b,
                  const Budget& budget) {
  const auto cylinder = primitive_cast<S>(primitive<Cylinder>(b));
  switch (pair) {
    case oracle::Pair::kCylinderCylinder:
      return reference::cylinder_cylinder<S>(primitive_cast<S>(primitive<Cylinder>(a)), cylinder,
                                             budget);
    case oracle::Pair::kObbCylinder:
      return reference::obb_cylinder<S>(primitive_cast<S>(primitive<Obb>(a)), cylinder, budget);
    default:
      return reference::triangle_cylinder<S>(primitive_cast<S>(primitive<Triangle>(a)), cylinder,
                                             budget);
  }
}

Body body(oracle::Pair pair) {
  return pair == oracle::Pair::kCylinderCylinder ? Body::kCylinder
         : pair == oracle::Pair::kObbCylinder    ? Body::kBox
                                                 : Body::kTriangle;
}

template <typename S>
double signed_gap_of(const Outcome<S>& outcome) {
  const double t = static_cast<double>(outcome.t);
  return outcome.f ? -t : t;
}

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * values.size()))];
}

// ---- Cases ----

class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}
  double unit() { return static_cast<double>(bits_() >> 11) * 0x1p-53; }
  double between(double lo, double hi) { return lo + (hi - lo) * unit(); }
  double decades(double lo, double hi) { return lo * std::pow(hi / lo, unit()); }
  double sign() { return (bits_() & 1) != 0 ? 1 : -1; }
  Vec direction() {
    for (;;) {
      const Vec v(between(-1, 1), between(-1, 1), between(-1, 1));
      if (v.norm() > 0.1 && v.norm() < 1) return v.normalized();
    }
  }
  Vec tilted(const Vec& a, double angle) {
    return std::cos(angle) * a + std::sin(angle) * a.cross(direction()).normalized();
  }

 private:
  std::mt19937_64 bits_;
};

oracle::Shape random_primary(oracle::Pair pair, Random& random) {
  const auto extent = [&] { return random.decades(0.2, 2); };
  if (pair == oracle::Pair::kCylinderCylinder)
    return oracle::Cylinder{Vec::Zero(), random.direction(), extent(), extent()};
  if (pair == oracle::Pair::kObbCylinder) {
    const Vec x = random.direction(), y = x.cross(random.direction()).normalized();
    oracle::Obb box{Vec::Zero(), {extent(), extent(), extent()}, {}};
    box.rotation << x, y, x.cross(y);
    return box;
  }
  return oracle::Triangle{2 * random.unit() * random.direction(),
                          2 * random.unit() * random.direction(),
                          2 * random.unit() * random.direction()};
}

/// A face normal of A.
Vec face(const oracle::Shape& a) {
  if (const auto* cylinder = std::get_if<oracle::Cylinder>(&a)) return cylinder->axis;
  if (const auto* box = std::get_if<oracle::Obb>(&a)) return box->rotation.col(0);
  const auto& t = std::get<oracle::Triangle>(a);
  return (t.v1 - t.v0).cross(t.v2 - t.v0).normalized();
}

/// Near contact with the best normal 1e-4 to 3.4 degrees off a cap's axis: a cap against a cap, a
/// face or a vertex, most of the time nearly parallel to it, with rims and edges crossing. A search
/// that treats the sphere of normals alike everywhere stalls here.
oracle::Case near_cap(oracle::Pair pair, std::uint64_t index) {
  Random random(kSeed + index);
  const oracle::Shape a = random_primary(pair, random);
  oracle::Cylinder b{Vec::Zero(), random.direction(), random.decades(0.2, 2),
                     random.decades(0.2, 2)};
  Vec axis = face(a);
  if (random.unit() < 0.7) {
    b.axis = random.tilted(axis, random.decades(1e-4, 0.06)) * random.sign();
  } else if (pair != oracle::Pair::kCylinderCylinder) {
    axis = b.axis;
  }
  const Vec n = random.tilted(axis, random.decades(1e-4, 0.06)) * random.sign();
  const auto support = [](const oracle::Shape& shape, const Vec& along) {
    Vec at;  // the gradient of the support function
    for (int i = 0; i < 3; ++i) {
      const Vec step = 1e-6 * Vec::Unit(i);
      at[i] = (oracle::support(shape, along + step) - oracle::support(shape, along - step)) / 2e-6;
    }
    return at;
  };
  const double aside = (random.unit() < 0.5 ? 0.02 : 0.6) * random.unit() * b.radius;
  b.c = support(a, n) - support(b, -n) + aside * n.cross(random.direction()).normalized();
  const oracle::Gap gap = oracle::signed_gap(a, b);
  b.c += gap.n * (random.sign() * random.decades(1e-7, 1e-3) - gap.lo);
  return {pair, kSeed, index, "near a cap axis", oracle::to_words(a), oracle::to_words(b)};
}

// ---- Shortfall per budget ----

/// What the largest budget must reach on a set, and that the set is not vacuous.
struct CaseSet {
  const char* name;
  int count;
  oracle::Case (*make)(oracle::Pair pair, std::uint64_t i);
  double fewest_meet, most_meet;  ///< share of pairs that meet
  /// Of cylinder-cylinder, OBB-cylinder, triangle-cylinder: largest shortfall, in S; how many pairs
  /// are short by more than tolT; false hits.
  std::array<double, 3> worst;
  std::array<int, 3> tail, false_hits;
};

const CaseSet kSets[] = {
    {"near contact",
     12000,
     [](oracle::Pair p, std::uint64_t i) { return oracle::generate(p, kSeed, 2 * i); },
     0.3,
     0.7,
     {1e-5, 2e-6, 16 * 0x1p-24},
     {8, 1, 0},
     {0, 0, 0}},
    {"directed families",
     6000,
     [](oracle::Pair p, std::uint64_t i) { return oracle::generate(p, kSeed, 2 * i + 1); },
     0.3,
     0.9,
     {1e-3, 1e-4, 2e-2},
     {10, 2, 14},
     {3, 0, 0}},
    {"near a cap axis",
     6000,
     near_cap,
     0.3,
     0.7,
     {16 * 0x1p-24, 16 * 0x1p-24, 2e-5},
     {0, 0, 2},
     {0, 0, 0}},
};

const Budget kBudgets[] = {{4, 0, 0}, {4, 2, 2}, {4, 3, 3},   {4, 4, 4},
                           {4, 6, 6}, {8, 8, 8}, {8, 12, 12}, kFull};

struct Row {
  std::vector<double> shortfall;  ///< (s - s_K) / S
  int false_hits = 0;             ///< F = 1 although s > tolT
};

class CylinderPairs : public ::testing::TestWithParam<std::tuple<oracle::Pair, int>> {};

TEST_P(CylinderPairs, ShortfallPerBudget) {
  const oracle::Pair pair = std::get<0>(GetParam());
  const CaseSet& set = kSets[std::get<1>(GetParam())];
  const std::size_t kind = pair == oracle::Pair::kCylinderCylinder ? 0
                           : pair == oracle::Pair::kObbCylinder    ? 1
                                                                   : 2;
  std::vector<Row> rows(std::size(kBudgets));
  int meet = 0, in_band = 0;
  for (int i = 0; i < set.count; ++i) {
    const oracle::Case c = set.make(pair, i);
    const auto a = c.shape_a(), b = c.shape_b();
    const oracle::Gap gap = oracle::signed_gap(a, b);
    const double size = oracle::scene_size(a, b), tolerance = 16 * 0x1p-24 * size;
    meet += gap.middle() <= 0, in_band += std::abs(gap.middle()) <= tolerance;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const Outcome<float> outcome = answer<float>(pair, c.a, c.b, kBudgets[k]);
      const double s = signed_gap_of(outcome);
      ASSERT_LE(s, gap.hi + tolerance) << "above the signed gap\n" << c.describe();
      EXPECT_LE(oracle::gap_along(a, b, outcome.n.cast<double>()) - tolerance, s) << c.describe();
      rows[k].shortfall.push_back(std::max(0.0, gap.lo - s) / size);
      rows[k].false_hits += outcome.f && gap.lo > tolerance;
    }
  }
  std::printf("%s, %s: %d pairs, %d meet, %d within tolT of touching\n", oracle::to_string(pair),
              set.name, set.count, meet, in_band);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Row& row = rows[k];
    const auto over = [&](double x) {
      return std::count_if(row.shortfall.begin(), row.shortfall.end(),
                           [&](double e) { return e > x; });
    };
    std::printf(
        "  M %2d K1 %2d K2 %2d %4d evaluations  p50 %.1e  p99 %.1e  max %.1e  over 16u %ld  "
        "over 1e-4 %ld  false hits %d\n",
        kBudgets[k].samples, kBudgets[k].circle, kBudgets[k].free,
        reference::cylinder::evaluations(body(pair), kBudgets[k]), quantile(row.shortfall, 0.5),
        quantile(row.shortfall, 0.99), quantile(row.shortfall, 1), over(16 * 0x1p-24), over(1e-4),
        row.false_hits);
  }
  EXPECT_GT(meet, set.fewest_meet * set.count);
  EXPECT_LT(meet, set.most_meet * set.count);
  const Row& full = rows.back();
  const auto above = [](double e) { return e > 16 * 0x1p-24; };
  EXPECT_LE(quantile(full.shortfall, 1), set.worst[kind]);
  EXPECT_LE(std::count_if(full.shortfall.begin(), full.shortfall.end(), above), set.tail[kind]);
  EXPECT_LE(full.false_hits, set.false_hits[kind]);
}

/// CP -+ s n/2 lie on the shapes up to tolP, but for a counted few.
TEST_P(CylinderPairs, WitnessPoints) {
  const oracle::Pair pair = std::get<0>(GetParam());
  const CaseSet& set = kSets[std::get<1>(GetParam())];
  const int count = set.count;
  std::vector<double> off;
  for (int i = 0; i < count; ++i) {
    const oracle::Case c = set.make(pair, i);
    const Outcome<float> outcome = answer<float>(pair, c.a, c.b, kFull);
    const oracle::Verdict v =
        oracle::check(c.shape_a(), c.shape_b(),
                      {outcome.f, outcome.t, outcome.cp.cast<double>(), outcome.n.cast<double>()},
                      {.lower_bound = true});
    ASSERT_TRUE(v.ok()) << v.describe() << '\n' << c.describe();
    off.push_back(std::max(v.witness_a, v.witness_b) / v.tolerance_p);
  }
  const auto beyond = std::count_if(off.begin(), off.end(), [](double x) { return x > 1; });
  std::printf(
      "%s, %s: witness points off by p50 %.2g, p99 %.2g, at most %.2g tolP; %ld of %d more than "
      "1\n",
      oracle::to_string(pair), set.name, quantile(off, 0.5), quantile(off, 0.99), quantile(off, 1),
      beyond, count);
  EXPECT_LE(beyond, 0.04 * count);
}

std::string set_name(const ::testing::TestParamInfo<std::tuple<oracle::Pair, int>>& info) {
  std::string name = std::string(oracle::to_string(std::get<0>(info.param))) + "_" +
                     kSets[std::get<1>(info.param)].name;
  for (char& c : name)
    if (c == ' ' || c == '-') c = '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, CylinderPairs,
                         ::testing::Combine(::testing::Values(oracle::Pair::kCylinderCylinder,
                                                              oracle::Pair::kObbCylinder,
                                                              oracle::Pair::kTriangleCylinder),
                                            ::testing::Values(0, 1, 2)),
                         set_name);

// ---- Formats ----

template <typename S>
class CylinderFormats : public ::testing::Test {};
using Formats = ::testing::Types<double, float, Fp24, Fp16, Bf16>;
TYPED_TEST_SUITE(CylinderFormats, Formats);

template <typename S>
Vector3<S> vec(const Vec& v) {
  return {S(v.x()), S(v.y()), S(v.z())};
}
template <typename S>
BasicCylinder<S> operand(const oracle::Cylinder& c) {
  return {vec<S>(c.c), vec<S>(c.axis), S(c.half_height), S(c.radius)};
}
template <typename S>
BasicObb<S> operand(const oracle::Obb& b) {
  BasicObb<S> box{vec<S>(b.c), vec<S>(b.half), {}};
  for (int i = 0; i < 3; ++i) box.rotation.col(i) = vec<S>(b.rotation.col(i));
  return box;
}
template <typename S>
BasicTriangle<S> operand(const oracle::Triangle& t) {
  return {vec<S>(t.v0), vec<S>(t.v1), vec<S>(t.v2)};
}

/// What the operand is in binary64: exactly what the reference is given.
template <typename S>
Vec exact(const Vector3<S>& v) {
  return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
}
template <typename S>
oracle::Shape exact(const BasicCylinder<S>& c) {
  return oracle::Cylinder{exact<S>(c.c), exact<S>(c.axis), static_cast<double>(c.half_height),
                          static_cast<double>(c.radius)};
}
template <typename S>
oracle::Shape exact(const BasicObb<S>& b) {
  oracle::Obb box{exact<S>(b.c), exact<S>(b.half), {}};
  for (int i = 0; i < 3; ++i) box.rotation.col(i) = exact<S>(Vector3<S>(b.rotation.col(i)));
  return box;
}
template <typename S>
oracle::Shape exact(const BasicTriangle<S>& t) {
  return oracle::Triangle{exact<S>(t.v0), exact<S>(t.v1), exact<S>(t.v2)};
}

/// Scenes of size 1, operands rounded to the format. s_K is never above s, and within 2^8 u S (or
/// the oracle's 1e-8 S) of it for all but a counted few.
TYPED_TEST(CylinderFormats, LowerBound) {
  using S = TypeParam;
  const double u = reference::kUnitRoundoff<S>;
  int tried = 0, flagged = 0, low = 0;
  double above = 0;
  for (const oracle::Pair pair : {oracle::Pair::kCylinderCylinder, oracle::Pair::kObbCylinder,
                                  oracle::Pair::kTriangleCylinder}) {
    for (int i = 0; i < 200; ++i) {
      Random random(kSeed + static_cast<std::uint64_t>(i));
      const oracle::Shape shape = random_primary(pair, random);
      const auto b = operand<S>(oracle::Cylinder{2 * random.direction(), random.direction(),
                                                 random.decades(0.2, 2), random.decades(0.2, 2)});
      const auto judge = [&](const auto& a) {
        const Outcome<S> outcome = reference::cylinder::run<S>(a, b, kFull);
        ++tried, flagged += outcome.bad;
        if (outcome.bad) return;
        const oracle::Gap gap = oracle::signed_gap(exact(a), exact(b));
        const double size = oracle::scene_size(exact(a), exact(b)), s = signed_gap_of(outcome);
        above = std::max(above, (s - gap.hi) / (u * size));
        low += !(gap.lo - s <= std::max(256 * u, 1e-8) * size);
      };
      if (const auto* c = std::get_if<oracle::Cylinder>(&shape)) judge(operand<S>(*c));
      if (const auto* c = std::get_if<oracle::Obb>(&shape)) judge(operand<S>(*c));
      if (const auto* c = std::get_if<oracle::Triangle>(&shape)) judge(operand<S>(*c));
    }
  }
  std::printf(
      "u 2^%d: %d pairs, %d flagged, at most %.2g u S above s, %d more than 2^8 u S below\n",
      std::ilogb(u), tried, flagged, above, low);
  EXPECT_EQ(tried, 600);
  EXPECT_EQ(flagged, 0);
  EXPECT_LE(above, 16);
  EXPECT_LE(low, 0.01 * tried);
}

// ---- The input contract ----

TEST(CylinderContract, BadInputIsFlagged) {
  const oracle::Case good = oracle::generate(oracle::Pair::kCylinderCylinder, kSeed, 0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (const auto pair : {oracle::Pair::kCylinderCylinder, oracle::Pair::kObbCylinder,
                          oracle::Pair::kTriangleCylinder}) {
    const oracle::Case c = oracle::generate(pair, kSeed, 0);
    EXPECT_FALSE(answer<float>(pair, c.a, c.b, {}).bad);
    for (const double value : {nan, inf, -inf}) {
      for (std::size_t i = 0; i < c.a.size() + c.b.size(); ++i) {
        auto a = c.a, b = c.b;
        (i < a.size() ? a[i] : b[i - a.size()]) = value;
        const Outcome<float> outcome = answer<float>(pair, a, b, {});
        EXPECT_TRUE(outcome.bad) << "word " << i;
        EXPECT_FALSE(outcome.f);
        EXPECT_TRUE(std::isnan(outcome.t) && std::isnan(outcome.cp.x()) &&
                    std::isnan(outcome.n.z()));
      }
    }
  }
  for (const std::size_t word : {3u, 6u, 7u}) {  // axis, half height, radius
    auto b = good.b;
    b[word] = word == 3 ? b[word] + 0.5 : 0.0;
    EXPECT_TRUE(answer<float>(good.pair, good.a, b, {}).bad) << "word " << word;
  }
}

// ---- Operators ----

using Phases = std::map<int, Tally>;

/// The same values, with nothing behind them.
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

/// One pass of every phase.
Phases operators(reference::cylinder::Pair<Counted> pair) {
  namespace cylinder = reference::cylinder;
  const Budget budget{4, 2, 2};
  Phases phases;
  cylinder::Search<Counted> s;
  for (int k = 0;; ++k) {
    restart(pair.d), restart(pair.b_reach), restart(pair.axis), restart(pair.reach);
    restart(pair.face), restart(s.best_g), restart(s.best_n), restart(s.next), restart(s.score);
    restart(s.lo_n), restart(s.lo_y), restart(s.hi_n), restart(s.hi_y), restart(s.q);
    restart(s.last.g), restart(s.last.n), restart(s.last.y);
    const cylinder::Pass p = cylinder::pass(pair.body, budget, k);
    Counted::tally = {};
    if (!cylinder::step<Counted>(pair, s, budget, k)) return phases;
    phases[static_cast<int>(p.phase)] = Counted::tally;
  }
}

const char* const kPhases[] = {"frame", "axis",   "centre", "vertex", "cap",
                               "side",  "beside", "sample", "refine", "pole",
                               "start", "newton", "touch",  "project"};

/// What one pass of each phase takes, and how deep it is. Most of it is common to all phases. A
/// change must be acknowledged here and in docs/pairs_cylinder.md.
const std::pair<const char*, std::map<std::string, std::string>> kOperators[] = {
    {"cylinder-cylinder",
     {{"centre", "80 mul, 3 div, 3 sqrt, 27 add, 31 sub, 5 cmp, depth 22"},
      {"cap", "80 mul, 3 div, 3 sqrt, 27 add, 31 sub, 5 cmp, depth 22"},
      {"side", "78 mul, 3 div, 3 sqrt, 29 add, 28 sub, 8 cmp, depth 24"},
      {"beside", "89 mul, 3 div, 3 sqrt, 37 add, 34 sub, 7 cmp, depth 30"},
      {"refine", "126 mul, 4 div, 3 sqrt, 49 add, 43 sub, 10 cmp, depth 29"},
      {"pole", "87 mul, 4 div, 4 sqrt, 35 add, 29 sub, 6 cmp, 2 min/max, depth 28"},
      {"start", "111 mul, 4 div, 3 sqrt, 46 add, 32 sub, 9 cmp, 4 min/max, depth 34"},
      {"newton", "111 mul, 4 div, 3 sqrt, 46 add, 32 sub, 10 cmp, 4 min/max, depth 34"},
      {"touch", "125 mul, 4 div, 4 sqrt, 56 add, 55 sub, 5 cmp, 6 min/max, depth 33"},
      {"project", "128 mul, 5 div, 4 sqrt, 56 add, 52 sub, 6 cmp, 6 min/max, depth 37"}}},
    {"OBB-cylinder",
     {{"frame", "45 mul, 2 div, 2 sqrt, 29 add, 19 sub, 4 cmp, depth 17"},
      {"axis", "45 mul, 2 div, 2 sqrt, 29 add, 19 sub, 4 cmp, depth 16"},
      {"vertex", "70 mul, 2 div, 3 sqrt, 42 add, 30 sub, 6 cmp, depth 29"},
      {"side", "55 mul, 2 div, 2 sqrt, 31 add, 22 sub, 5 cmp, depth 23"},
      {"sample", "99 mul, 2 div, 2 sqrt, 47 add, 37 sub, 11 cmp, 1 min/max, depth 40"},
      {"refine", "103 mul, 3 div, 2 sqrt, 51 add, 37 sub, 9 cmp, depth 28"},
      {"touch", "96 mul, 2 div, 2 sqrt, 60 add, 40 sub, 4 cmp, 9 min/max, depth 26"},
      {"project", "99 mul, 3 div, 2 sqrt, 60 add, 37 sub, 5 cmp, 9 min/max, depth 31"}}},
    {"triangle-cylinder",
     {{"frame", "63 mul, 2 div, 2 sqrt, 27 add, 22 sub, 12 cmp, 6 min/max, depth 17"},
      {"axis", "45 mul, 2 div, 2 sqrt, 21 add, 19 sub, 8 cmp, 6 min/max, depth 16"},
      {"vertex", "70 mul, 2 div, 3 sqrt, 28 add, 30 sub, 10 cmp, 6 min/max, depth 27"},
      {"side", "55 mul, 2 div, 2 sqrt, 23 add, 22 sub, 9 cmp, 6 min/max, depth 23"},
      {"sample", "99 mul, 2 div, 2 sqrt, 39 add, 37 sub, 15 cmp, 7 min/max, depth 40"},
      {"refine", "103 mul, 3 div, 2 sqrt, 43 add, 37 sub, 13 cmp, 6 min/max, depth 28"},
      {"touch", "150 mul, 5 div, 2 sqrt, 77 add, 70 sub, 14 cmp, 18 min/max, depth 34"},
      {"project", "153 mul, 6 div, 2 sqrt, 77 add, 67 sub, 15 cmp, 18 min/max, depth 39"}}},
};

TEST(CylinderOperators, AreThoseOfTheDocument) {
  namespace cylinder = reference::cylinder;
  using C = Counted;
  const auto make = [](oracle::Pair pair, auto tag) {
    const oracle::Case c = oracle::generate(pair, kSeed, 0);
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
