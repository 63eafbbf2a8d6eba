// SPDX-License-Identifier: Apache-2.0
// Answers of the mirror references of the three cylinder pairs against the certified oracle. Checks
// the shortfall of s_K per number of iterations, that s_K never exceeds s, witness points, and
// degenerate operands. cylinder_formats_test.cpp checks every format.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "amount.hpp"
#include "cde/oracle/oracle.hpp"
#include "cde/oracle/random.hpp"
#include "cde/reference/pipes/cylinder/pairs.hpp"
#include "cylinder_cases.hpp"
#include "printed.hpp"

namespace cde::testing {
namespace {

using oracle::Vec;
using reference::Outcome;
using reference::cylinder::Body;
using reference::cylinder::Iterations;

constexpr std::uint64_t kSeed = kCylinderSeed;
constexpr Iterations kFull{8, 16, 16};

template <class P>
P primitive(const std::vector<double>& words) {
  const std::vector<float> exact(words.begin(), words.end());
  return from_words<P>(std::span<const float, P::kWords>(exact.data(), P::kWords));
}

/// The pair's reference on operands rounded to S.
template <typename S>
Outcome<S> answer(oracle::Pair pair, const std::vector<double>& a, const std::vector<double>& b,
                  const Iterations& iterations) {
  const auto cylinder = primitive_cast<S>(primitive<Cylinder>(b));
  switch (pair) {
    case oracle::Pair::kCylinderCylinder:
      return reference::cylinder_cylinder<S>(primitive_cast<S>(primitive<Cylinder>(a)), cylinder,
                                             iterations);
    case oracle::Pair::kObbCylinder:
      return reference::obb_cylinder<S>(primitive_cast<S>(primitive<Obb>(a)), cylinder, iterations);
    default:
      return reference::triangle_cylinder<S>(primitive_cast<S>(primitive<Triangle>(a)), cylinder,
                                             iterations);
  }
}

Body body(oracle::Pair pair) {
  return pair == oracle::Pair::kCylinderCylinder ? Body::kCylinder
         : pair == oracle::Pair::kObbCylinder    ? Body::kBox
                                                 : Body::kTriangle;
}

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * values.size()))];
}

// ---- Shortfall per number of iterations ----

/// The tail of a set: its largest shortfall in S, pairs short by more than tolT, pairs short by
/// more than 1e-4 S, and false hits.
struct Tail {
  double worst;
  int over, far_over, false_hits;
};

/// Limits for the default iterations and the most on a set, and the share of hits that keeps the
/// set meaningful.
struct CaseSet {
  const char* name;
  int count, full_count;
  oracle::Case (*make)(oracle::Pair pair, std::uint64_t i);
  double fewest_meet, most_meet;  ///< share of pairs that meet
  /// In the order cylinder-cylinder, OBB-cylinder, triangle-cylinder.
  std::array<Tail, 3> at_default, at_largest;
  std::array<double, 3> off_witness;  ///< share of pairs with a witness point beyond tolP
  std::array<double, 3> off_n;        ///< share of pairs clearly apart with n off by more than 1e-5
};

constexpr double kTolT = 16 * 0x1p-24;
constexpr Tail kExact{kTolT, 0, 0, 0};

const CaseSet kSets[] = {
    {"near contact",
     12000,
     60000,
     [](oracle::Pair p, std::uint64_t i) { return oracle::generate(p, kSeed, 2 * i); },
     0.3,
     0.7,
     {kExact, kExact, kExact},
     {kExact, kExact, kExact},
     {0.0005, 0.0002, 0},
     {}},
    {"directed families",
     6000,
     30000,
     [](oracle::Pair p, std::uint64_t i) { return oracle::generate(p, kSeed, 2 * i + 1); },
     0.3,
     0.9,
     {Tail{2e-6, 2, 0, 0}, kExact, Tail{1e-3, 1, 1, 0}},
     {Tail{2e-6, 2, 0, 0}, kExact, Tail{1e-3, 1, 1, 0}},
     {0.002, 0, 0.0005},
     {}},
    {"near a cap axis",
     6000,
     30000,
     near_cap,
     0.3,
     0.7,
     {kExact, kExact, kExact},
     {kExact, kExact, kExact},
     {0.005, 0, 0.0004},
     {}},
    {"upright",
     18000,
     90000,
     upright,
     0.2,
     0.7,
     {Tail{1.2e-6, 1, 0, 0}, kExact, Tail{6e-4, 1, 1, 0}},
     {kExact, kExact, Tail{6e-4, 1, 1, 0}},
     {0.0007, 0, 0.0003},
     {0.006, 0.002, 0.0015}},
    {"vertex on a rim",
     4000,
     20000,
     on_a_rim,
     0.2,
     0.99,
     {kExact, kExact, Tail{5e-4, 1, 1, 0}},  // two of 20,000
     {kExact, kExact, Tail{5e-4, 1, 1, 0}},
     {0, 0, 0},
     {}},
};

const Iterations kIterations[] = {{4, 0, 0}, {4, 2, 2}, {4, 3, 3},   {4, 4, 4},
                                  {4, 6, 6}, {8, 8, 8}, {8, 12, 12}, kFull};
constexpr std::size_t kDefault = 5;  ///< index in kIterations

struct Row {
  std::vector<double> shortfall;  ///< (s - s_K) / S
  int false_hits = 0;             ///< F = 1 although s > tolT

  [[nodiscard]] int over(double x) const {
    return static_cast<int>(
        std::count_if(shortfall.begin(), shortfall.end(), [x](double e) { return e > x; }));
  }
  [[nodiscard]] Tail tail() const {
    return {quantile(shortfall, 1), over(kTolT), over(1e-4), false_hits};
  }
};

/// The larger distance of a witness point, CP -+ s n/2, from its body, in tolP.
double off_bodies(const oracle::Shape& a, const oracle::Shape& b, const Outcome<float>& outcome) {
  const double half = signed_distance_of(outcome) / 2;
  const Vec n = outcome.n.cast<double>(), cp = outcome.cp.cast<double>();
  const double tolerance =
      kTolT * oracle::scene_size(a, b) + 4 * 0x1p-24 * oracle::largest_coordinate(a, b);
  return std::max(oracle::distance(cp - half * n, a), oracle::distance(cp + half * n, b)) /
         tolerance;
}

int kind(oracle::Pair pair) {
  return pair == oracle::Pair::kCylinderCylinder ? 0 : pair == oracle::Pair::kObbCylinder ? 1 : 2;
}

/// Runs one set of cases with every number of iterations and checks the answers with the oracle.
class Survey {
 public:
  Survey(oracle::Pair pair, const CaseSet& set)
      : pair_(pair), set_(set), count_(full() ? set.full_count : set.count) {}

  void run() {
    for (int i = 0; i < count_; ++i) judge(set_.make(pair_, static_cast<std::uint64_t>(i)));
  }
  void print() const;
  [[nodiscard]] const Row& row(std::size_t k) const { return rows_[k]; }
  [[nodiscard]] double meeting() const { return static_cast<double>(meet_) / count_; }
  [[nodiscard]] double off_witness() const { return static_cast<double>(beyond()) / count_; }
  [[nodiscard]] double off_n() const {
    return turned_.empty() ? 0 : static_cast<double>(beyond_n()) / turned_.size();
  }
  /// The limits apply to the default number of cases.
  [[nodiscard]] int share(int limit) const {
    return full() ? limit * set_.full_count / set_.count + 1 : limit;
  }

 private:
  void judge(const oracle::Case& c);
  void judge_default(const oracle::Case& c, const oracle::SignedDistance& distance,
                     const Outcome<float>& outcome);
  [[nodiscard]] std::ptrdiff_t beyond() const {
    return std::count_if(off_.begin(), off_.end(), [](double x) { return x > 1; });
  }
  [[nodiscard]] std::ptrdiff_t beyond_n() const {
    return std::count_if(turned_.begin(), turned_.end(), [](double x) { return x > 1e-5; });
  }

  oracle::Pair pair_;
  const CaseSet& set_;
  int count_;
  std::array<Row, std::size(kIterations)> rows_;
  std::vector<double> off_;     ///< witness points, in tolP
  std::vector<double> turned_;  ///< difference of n from the true one, where that is certain
  int meet_ = 0, in_band_ = 0;
};

void Survey::judge(const oracle::Case& c) {
  const auto a = c.shape_a(), b = c.shape_b();
  const oracle::SignedDistance distance = oracle::signed_distance(a, b);
  const double size = oracle::scene_size(a, b), tolerance = kTolT * size;
  meet_ += distance.middle() <= 0, in_band_ += std::abs(distance.middle()) <= tolerance;
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    const Outcome<float> outcome = answer<float>(pair_, c.a, c.b, kIterations[k]);
    const double s = signed_distance_of(outcome);
    ASSERT_LE(s, distance.hi + tolerance) << "above the signed distance\n" << c.describe();
    EXPECT_NEAR(oracle::distance_along(a, b, outcome.n.cast<double>()), s, tolerance)
        << c.describe();
    rows_[k].shortfall.push_back(std::max(0.0, distance.lo - s) / size);
    rows_[k].false_hits += outcome.f && distance.lo > tolerance;
    if (k == kDefault) judge_default(c, distance, outcome);
  }
}

/// Checks the witness points, and n if a signed distance within 1e-13 S determines it and the pair
/// is clearly apart.
void Survey::judge_default(const oracle::Case& c, const oracle::SignedDistance& distance,
                           const Outcome<float>& outcome) {
  const auto a = c.shape_a(), b = c.shape_b();
  const Vec n = outcome.n.cast<double>();
  off_.push_back(off_bodies(a, b, outcome));
  if (distance.lo < 0.01 * oracle::scene_size(a, b) || std::string(set_.name) != "upright") return;
  const oracle::SignedDistance exact = oracle::signed_distance(a, b, {1e-13, 1000000});
  turned_.push_back((n.normalized() - exact.n).norm());
}

void Survey::print() const {
  std::printf("%s, %s: %d pairs, %d meet, %d within tolT of touching\n", oracle::to_string(pair_),
              set_.name, count_, meet_, in_band_);
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    const Tail tail = rows_[k].tail();
    std::printf(
        "  M %2d K1 %2d K2 %2d %4d evaluations  p99 %.1e  max %.1e  over 16u %d  over 1e-4 %d  "
        "false hits %d\n",
        kIterations[k].samples, kIterations[k].circle, kIterations[k].free,
        reference::cylinder::evaluations(body(pair_), kIterations[k]),
        quantile(rows_[k].shortfall, 0.99), tail.worst, tail.over, tail.far_over, tail.false_hits);
  }
  std::printf("  witness points off by p99 %.2g, at most %.2g tolP; %td of %d more than 1\n",
              quantile(off_, 0.99), quantile(off_, 1), beyond(), count_);
  if (turned_.empty()) return;
  std::printf("  n off by p99 %.1e, at most %.1e; %td of %zu more than 1e-5\n",
              quantile(turned_, 0.99), quantile(turned_, 1), beyond_n(), turned_.size());
}

class CylinderPairs : public ::testing::TestWithParam<std::tuple<oracle::Pair, int>> {};

TEST_P(CylinderPairs, EveryNumberOfIterations_AgreesWithTheOracle) {
  const oracle::Pair pair = std::get<0>(GetParam());
  const CaseSet& set = kSets[std::get<1>(GetParam())];
  Survey survey(pair, set);
  survey.run();
  survey.print();
  EXPECT_GT(survey.meeting(), set.fewest_meet);
  EXPECT_LT(survey.meeting(), set.most_meet);
  const auto within = [&](std::size_t k, const Tail& limit) {
    const Tail tail = survey.row(k).tail();
    EXPECT_LE(tail.worst, full() ? 4 * limit.worst : limit.worst) << "iterations " << k;
    EXPECT_LE(tail.over, survey.share(limit.over)) << "iterations " << k;
    EXPECT_LE(tail.far_over, survey.share(limit.far_over)) << "iterations " << k;
    EXPECT_LE(tail.false_hits, limit.false_hits) << "iterations " << k;
  };
  const auto i = static_cast<std::size_t>(kind(pair));
  within(kDefault, set.at_default[i]);
  within(std::size(kIterations) - 1, set.at_largest[i]);
  // Five times as many pairs also find rare cases.
  const double more = full() ? 0.0003 : 0;
  EXPECT_LE(survey.off_witness(), set.off_witness[i] + more);
  EXPECT_LE(survey.off_n(), set.off_n[i] + more);
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
                                            ::testing::Values(0, 1, 2, 3, 4)),
                         set_name);

// ---- Pairs with a known answer ----

/// An axis-parallel box beside and below an upright cylinder. Both ends of every bracket share one
/// support point: the corner against the rim.
TEST(CylinderRegression, BoxBelowARim_HasItsDistance) {
  const Obb box{Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(6, 2, 1), Eigen::Matrix3f::Identity()};
  const Cylinder cylinder{Eigen::Vector3f(0, 4, 5), Eigen::Vector3f(0, 0, 1), 3, 1};
  for (const Iterations iterations :
       {Iterations{4, 6, 6}, Iterations{8, 8, 8}, Iterations{16, 64, 64}}) {
    const Outcome<float> got = reference::obb_cylinder<float>(box, cylinder, iterations);
    EXPECT_FALSE(got.f);
    EXPECT_NEAR(got.t, std::sqrt(2.0), 1e-6);
    EXPECT_NEAR((got.n.cast<double>() - Vec(0, 1, 1).normalized()).norm(), 0, 1e-5);
    EXPECT_NEAR((got.cp.cast<double>() - Vec(0, 2.5, 1.5)).norm(), 0, 1e-5);
  }
}

TEST(CylinderRegression, TriangleBelowARim_HasItsDistance) {
  const Triangle triangle{Eigen::Vector3f(-6, 0, 0), Eigen::Vector3f(6, 0, 0),
                          Eigen::Vector3f(0, -5, 0)};
  const Cylinder cylinder{Eigen::Vector3f(0, 5, 2), Eigen::Vector3f(0, 0, 1), 1, 4};
  for (const Iterations iterations :
       {Iterations{4, 6, 6}, Iterations{8, 8, 8}, Iterations{16, 64, 64}}) {
    const Outcome<float> got = reference::triangle_cylinder<float>(triangle, cylinder, iterations);
    EXPECT_FALSE(got.f);
    EXPECT_NEAR(got.t, std::sqrt(2.0), 1e-6);
    EXPECT_NEAR((got.n.cast<double>() - Vec(0, 1, 1).normalized()).norm(), 0, 1e-5);
  }
}

/// Two rims that miss each other by 1.851e-4, where Newton's matrix is not definite.
TEST(CylinderRegression, MissingRims_HaveTheirDistance) {
  const std::vector<double> a = {0,          0,          0, -0.213993683, 0.738440633, -0.639462352,
                                 1.26860404, 0.357277811};
  const std::vector<double> b = {0.19473657,   0.921042919, -2.12024307, -0.494172364,
                                 -0.650091469, -0.57721293, 0.260761261, 1.10080326};
  const Outcome<float> got =
      answer<float>(oracle::Pair::kCylinderCylinder, a, b, Iterations{8, 8, 8});
  EXPECT_FALSE(got.f);
  EXPECT_NEAR(got.t, 1.851e-4, 1e-6);
}

/// Flat faces that touch in one point, which is CP up to s n/2: a triangle with a corner under a
/// rim, and a face that ends there. Projections converge slowly along the tangent.
TEST(CylinderRegression, TriangleEndingUnderARim_HasItsWitnessPoint) {
  const Triangle triangle{Eigen::Vector3f(3, -2, 2), Eigen::Vector3f(3, -6, 2),
                          Eigen::Vector3f(-1, -2, 2)};
  const Cylinder cylinder{Eigen::Vector3f(-1, 2, -3), Eigen::Vector3f(0, 0, 1), 1, 4};
  const Outcome<float> got = reference::triangle_cylinder<float>(triangle, cylinder);
  EXPECT_FALSE(got.f);
  EXPECT_NEAR(got.t, 4, 1e-6);
  EXPECT_NEAR((got.cp.cast<double>() - Vec(-1, -2, 0)).norm(), 0, 1e-5);
}

TEST(CylinderRegression, FaceEndingUnderARim_HasItsWitnessPoint) {
  const Cylinder lying{Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(0, -1, 0), 1, 1};
  const Cylinder upright{Eigen::Vector3f(4, 1, 7), Eigen::Vector3f(0, 0, 1), 4, 4};
  const Outcome<float> got = reference::cylinder_cylinder<float>(lying, upright);
  EXPECT_FALSE(got.f);
  EXPECT_NEAR(got.t, 2, 1e-6);
  EXPECT_NEAR((got.cp.cast<double>() - Vec(0, 1, 2)).norm(), 0, 1e-5);
}

/// Three points of a line, on a cap: the triangle ends at its outer points.
TEST(CylinderRegression, TriangleWithoutAreaOnACap_HasItsWitnessPoint) {
  const oracle::Triangle flat{Vec(4, -4, 2), Vec(-5, -4, -5), Vec(-2.75, -4, -3.25)};
  const oracle::Cylinder cylinder{Vec(-5, -6, -6.5), Vec(0, 1, 0), 2, 3};
  const Outcome<float> got = answer<float>(oracle::Pair::kTriangleCylinder, oracle::to_words(flat),
                                           oracle::to_words(cylinder), {});
  EXPECT_TRUE(got.f);
  EXPECT_EQ(got.t, 0);
  EXPECT_LE(oracle::distance(got.cp.cast<double>(), flat), 1e-5);
  EXPECT_LE(oracle::distance(got.cp.cast<double>(), cylinder), 1e-5);
}

/// A vertex on the rim of a cap, and another on the axis, from which all points of the rim are
/// equally near.
TEST(CylinderRegression, TriangleFromAxisToRim_HasItsWitnessPoint) {
  const oracle::Triangle triangle{Vec(0, 0, 0), Vec(1, -1, 0), Vec(-1, -1, 0)};
  const oracle::Cylinder cylinder{Vec(-2, 0, 0), Vec(1, 0, 0), 1, 1};
  const Outcome<float> got = answer<float>(
      oracle::Pair::kTriangleCylinder, oracle::to_words(triangle), oracle::to_words(cylinder), {});
  EXPECT_TRUE(got.f);
  EXPECT_NEAR(got.t, 0, 1e-6);
  EXPECT_NEAR((got.cp.cast<double>() - Vec(-1, -1, 0)).norm(), 0, 1e-5);
}

/// An edge beside a cylinder with a tilt of 1/1000. Over 2e-4 radian g is constant up to rounding,
/// but the direction between the nearest points is not.
TEST(CylinderRegression, FlatDistance_HasACorrectNormal) {
  const std::vector<double> box = {0, 0, 0, 1, 2, 1, 0, 0, -1, 0, 1, 0, 1, 0, 0};
  const std::vector<double> cylinder = {3, 6, 0, 0.000936599099f, 0.000456357229f, 0.999999464f,
                                        4, 2};
  const oracle::Case c{oracle::Pair::kObbCylinder, 0, 0, "leaning", box, cylinder};
  const oracle::SignedDistance exact =
      oracle::signed_distance(c.shape_a(), c.shape_b(), {1e-13, 1000000});
  const Outcome<float> got = answer<float>(c.pair, c.a, c.b, {});
  EXPECT_FALSE(got.f);
  EXPECT_NEAR((got.n.cast<double>() - exact.n).norm(), 0, 2e-6);
}

/// Upright edges and faces, deep inside. All samples must lie where the signed distance may have
/// two maxima, none between a kink and itself.
TEST(CylinderRegression, TriangleWithASecondMaximum_FindsTheHigherOne) {
  const std::vector<double> triangles[] = {{2, 9, 0, 2, 1, 0, 2, 1, -1},
                                           {3, -8, -1, 3, 0, -1, 3, 0, 0},
                                           {0, -3.5, -3, 0, -2.5, -4, 0, 3.5, 4}};
  const std::vector<double> cylinders[] = {
      {6, 4, -1, 0, 0, -1, 1, 5}, {-1, -3, 1, 0, 0, -1, 2, 5}, {-1, -3, 0, 0, 0, -1, 3, 4}};
  for (int i = 0; i < 3; ++i) {
    const oracle::Case c{oracle::Pair::kTriangleCylinder, 0, 0, "deep", triangles[i], cylinders[i]};
    const oracle::SignedDistance exact =
        oracle::signed_distance(c.shape_a(), c.shape_b(), {1e-13, 1000000});
    const Outcome<float> got = answer<float>(c.pair, c.a, c.b, {});
    EXPECT_NEAR(signed_distance_of(got), exact.lo, 1e-6) << i;
    EXPECT_NEAR((got.n.cast<double>() - exact.n).norm(), 0, 1e-5) << i;
  }
}

/// A triangle that is a point on the axis: the lateral surface is equally near in all directions.
TEST(CylinderRegression, PointOnTheAxis_HasItsDistance) {
  const std::vector<double> cylinder = {0, 9, 14, 0, 0, -1, 4, 1};
  const std::vector<double> point = {0, 9, 11.5, 0, 9, 11.5, 0, 9, 11.5};
  const Outcome<float> got = answer<float>(oracle::Pair::kTriangleCylinder, point, cylinder, {});
  EXPECT_TRUE(got.f);
  EXPECT_EQ(got.t, 1);
  EXPECT_EQ(got.n.z(), 0);
  EXPECT_NEAR((got.cp + 0.5F * got.n - Eigen::Vector3f(0, 9, 11.5F)).norm(), 0, 1e-5);
}

/// A sliver whose normal is tilted by rounding, and its plane with it.
TEST(CylinderRegression, Sliver_HasItsWitnessPoint) {
  const std::vector<double> triangle = {23.3295059f, 21.9699345f, -12.1292601f,
                                        15.883009f,  17.2394485f, -6.54605389f,
                                        23.0407219f, 21.7864799f, -11.9127369f};
  const std::vector<double> cylinder = {
      19.7317524f, 19.9230728f, -10.9602737f, -0.268247277f, -0.0769273415f, -0.960273683f, 1, 3};
  const oracle::Case c{oracle::Pair::kTriangleCylinder, 0, 0, "sliver", triangle, cylinder};
  const Outcome<float> got = answer<float>(c.pair, c.a, c.b, {});
  const Vec n = got.n.cast<double>(), cp = got.cp.cast<double>();
  const double half = signed_distance_of(got) / 2;
  EXPECT_LE(oracle::distance(cp - half * n, c.shape_a()), 3e-5);
  EXPECT_LE(oracle::distance(cp + half * n, c.shape_b()), 3e-5);
}

// ---- Witness points of everyday scenes ----

class CylinderWitnesses : public ::testing::TestWithParam<std::tuple<oracle::Pair, double>> {};

/// How many of a million everyday pairs have a witness point beyond tolP. A distance decides it,
/// without the oracle.
TEST_P(CylinderWitnesses, WitnessPoints_LieOnTheBodies) {
  const auto [pair, max_per_million] = GetParam();
  const int count = full() ? 1000000 : 20000;
  int beyond = 0;
  double worst = 0;
  for (int i = 0; i < count; ++i) {
    const oracle::Case c = oracle::everyday(pair, kSeed, static_cast<std::uint64_t>(i));
    const oracle::Shape a = c.shape_a(), b = c.shape_b();
    const double off = off_bodies(a, b, answer<float>(pair, c.a, c.b, {}));
    beyond += !(off <= 1), worst = std::max(worst, off);
  }
  std::printf("%s, everyday: witness points of %d of %d more than 1 tolP off, at most %.2g\n",
              oracle::to_string(pair), beyond, count, worst);
  // A small count varies more.
  EXPECT_LE(beyond, max_per_million * count * 1e-6 + (full() ? 0 : 5));
}

INSTANTIATE_TEST_SUITE_P(Everyday, CylinderWitnesses,
                         ::testing::Values(std::tuple(oracle::Pair::kCylinderCylinder, 400.0),
                                           std::tuple(oracle::Pair::kObbCylinder, 150.0),
                                           std::tuple(oracle::Pair::kTriangleCylinder, 60.0)),
                         [](const auto& info) {
                           std::string name = oracle::to_string(std::get<0>(info.param));
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// ---- The input contract ----

TEST(CylinderContract, BadInput_IsFlagged) {
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

}  // namespace
}  // namespace cde::testing
