// SPDX-License-Identifier: Apache-2.0
// Rays over the whole range of lengths and directions of docs/reference/pairs.md. Every answer lies
// within the published bands of exact arithmetic. scale_test.cpp covers the inner range, where
// answers scale bit by bit. The pipe scales fp16 and fp24, so they scale over the whole range
// there.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "amount.hpp"
#include "cde/fp/fp_format.hpp"
#include "cde/geometry/bounds.hpp"
#include "cde/geometry/length_range.hpp"
#include "cde/oracle/exact.hpp"
#include "cde/oracle/random.hpp"
#include "cde/reference/pairs.hpp"
#include "cde/reference/pipes/ray_cylinder.hpp"
#include "cde/reference/pipes/ray_sphere.hpp"
#include "cde/reference/pipes/ray_triangle.hpp"
#include "exact_solids.hpp"
#include "scaled_cases.hpp"

namespace cde::testing {
namespace {

using Eigen::Vector3d;

constexpr std::uint64_t kSeed = 20261123;

/// The required answer of a case at its original size.
class Expected {
 public:
  virtual ~Expected() = default;
  enum class Truth { kHit, kMiss, kUncertain };
  Truth truth = Truth::kUncertain;
  [[nodiscard]] virtual bool accepts(double t) const = 0;
};

/// A triangle with one of the four algorithms, each with its own bands (ray_triangle.hpp,
/// bounds.hpp).
class ExpectedTriangle final : public Expected {
 public:
  ExpectedTriangle(const BasicRay<double>& ray, const BasicTriangle<double>& triangle,
                   Algorithm algorithm, double u) {
    const ExactHit exact(ray, triangle);
    if (exact.det == 0) return;
    const auto value = [](const ExactHit::Rational& x) { return static_cast<double>(x); };
    const double inside[3] = {value(exact.u), value(exact.v),
                              value(ExactHit::Rational(1 - exact.u - exact.v))};
    t_ = value(exact.t);
    const Vector3d e1 = triangle.v1 - triangle.v0, e2 = triangle.v2 - triangle.v0,
                   normal = e1.cross(e2);
    const double a = e1.norm(), b = e2.norm(), c = (e2 - e1).norm(), area = normal.norm(),
                 length = ray.d.norm(), cos = std::abs(normal.dot(ray.d)) / (area * length);
    if (!(cos > 0.01) || std::max({a, b, c}) > 1e4 * area / std::max({a, b, c})) return;
    const double heights[3] = {area / b, area / a, area / c};
    double bands[3];
    if (algorithm == Algorithm::kMoller) {
      const MollerBound bound =
          moller_bound(primitive_cast<float>(ray), primitive_cast<float>(triangle));
      const double by = u * 0x1p24 * 1.001, det = std::abs(value(exact.det));
      if (!(det > 2 * by * bound.det)) return;
      const double of[3] = {bound.u, bound.v, bound.uv + bound.det};
      for (int k = 0; k < 3; ++k) bands[k] = by * of[k] / det * heights[k];
      slack_ = by * (bound.tn + std::abs(t_) * bound.det) / (det - by * bound.det) +
               4 * u * std::abs(t_);
    } else {
      double world = ray.o.cwiseAbs().maxCoeff(), reach = 0;
      for (const Vector3d& v : {triangle.v0, triangle.v1, triangle.v2}) {
        world = std::max(world, v.cwiseAbs().maxCoeff());
        reach = std::max(reach, (v - ray.o).norm());
      }
      const double slim = a * b * (a + b) / area, longest = std::max({a, b, c}),
                   distance = std::abs(t_) * length;
      double band = reference::kWatertightBand * reach,
             depth = reference::kWatertightDepth * reach * (1 + longest * longest / area);
      if (algorithm == Algorithm::kBadouel) {
        band = reference::kBadouelBand * (world + slim / 4);
        depth = reference::kBadouelDepth * (world + slim);
      } else if (algorithm == Algorithm::kPluecker) {
        band = reference::kPlueckerBand * world;
        depth = reference::kPlueckerDepth * world * (1 + distance * (a + b + c) / area);
      }
      for (double& k : bands) k = u * band / cos;
      slack_ = u * depth / cos / length;
    }
    bool sure_in = true, sure_out = false;
    for (int k = 0; k < 3; ++k) {
      sure_in = sure_in && inside[k] * heights[k] > bands[k];
      sure_out = sure_out || inside[k] * heights[k] < -bands[k];
    }
    sure_in = sure_in && t_ - ray.tmin > slack_ && ray.tmax - t_ > slack_;
    sure_out = sure_out || t_ - ray.tmin < -slack_ || ray.tmax - t_ < -slack_;
    truth = sure_in ? Truth::kHit : sure_out ? Truth::kMiss : Truth::kUncertain;
  }
  [[nodiscard]] bool accepts(double t) const override { return std::abs(t - t_) <= slack_; }

 private:
  double t_ = 0, slack_ = 0;
};

template <class Exact>
class ExpectedSolid final : public Expected {
 public:
  template <class Solid>
  ExpectedSolid(const BasicRay<double>& ray, const Solid& solid, double band)
      : judgement_(Exact(ray, solid), ray, band * Exact(ray, solid).size()) {
    using enum Judgement::Truth;
    truth = judgement_.truth() == kHit    ? Truth::kHit
            : judgement_.truth() == kMiss ? Truth::kMiss
                                          : Truth::kUncertain;
  }
  [[nodiscard]] bool accepts(double t) const override { return judgement_.accepts(t); }

 private:
  Judgement judgement_;
};

struct Parameter {
  Pair pair;
  Algorithm algorithm;
  FpFormat format;
};

void PrintTo(const Parameter& p, std::ostream* out) {
  *out << name(p.pair) << ' ' << p.format.name();
}

template <class P>
P primitive(const std::vector<double>& words) {
  return from_words<P>(std::span<const double, P::kWords>(words));
}

std::optional<double> shortest_edge(const oracle::Case& c) {
  if (c.pair != oracle::Pair::kRayTriangle) return std::nullopt;
  const auto t = primitive<BasicTriangle<double>>(c.b);
  return std::min({(t.v1 - t.v0).norm(), (t.v2 - t.v1).norm(), (t.v0 - t.v2).norm()});
}

std::unique_ptr<Expected> expected(const oracle::Case& c, Algorithm algorithm, double u) {
  const auto ray = primitive<BasicRay<double>>(c.a);
  if (c.pair == oracle::Pair::kRaySphere)
    return std::make_unique<ExpectedSolid<ExactSphere>>(ray, primitive<BasicSphere<double>>(c.b),
                                                        reference::kRaySphereBand * u);
  if (c.pair == oracle::Pair::kRayCylinder)
    return std::make_unique<ExpectedSolid<ExactCylinder>>(
        ray, primitive<BasicCylinder<double>>(c.b), reference::kRayCylinderBand * u);
  return std::make_unique<ExpectedTriangle>(ray, primitive<BasicTriangle<double>>(c.b), algorithm,
                                            u);
}

class RayRange : public ::testing::TestWithParam<Parameter> {};

TEST_P(RayRange, WholeRange_IsRightOutsideTheBands) {
  const auto [pair, algorithm, format] = GetParam();
  const Shape target = secondary_shape(pair);
  const LengthRange range = LengthRange::of(format.exp_bits, format.man_bits),
                    ratio = LengthRange::ray_ratio(format.exp_bits, format.man_bits);
  const double u = std::ldexp(1, -format.man_bits - 1);
  const int cases = amount(1500, 20000);
  oracle::Random random(kSeed, static_cast<std::uint64_t>(pair), 0);
  struct Made {
    std::size_t expected;
    int j, m;
  };
  std::vector<std::unique_ptr<Expected>> all;
  std::vector<oracle::Case> from;
  std::vector<Made> made;
  std::vector<std::uint64_t> words_a, words_b;
  for (int i = 0; i < cases; ++i) {
    const oracle::Case c =
        oracle::generate(static_cast<oracle::Pair>(pair), kSeed, static_cast<std::uint64_t>(i),
                         {.exp_bits = format.exp_bits, .man_bits = format.man_bits});
    LengthRange length = scale_range(c, Shape::kRay, target, Kind::kLength, range);
    const LengthRange direction = scale_range(c, Shape::kRay, target, Kind::kDirection, range);
    if (const auto edge = shortest_edge(c))
      length.low = std::max(length.low, range.low + 1 - std::ilogb(*edge));
    if (length.low > length.high || direction.low > direction.high) continue;
    auto answer = expected(c, algorithm, u);
    if (answer->truth == Expected::Truth::kUncertain) continue;
    all.push_back(std::move(answer));
    from.push_back(c);
    const auto between = [&](LengthRange r) { return r.low + random.below(r.high - r.low + 1); };
    const std::pair<int, int> by[] = {
        {length.low, direction.low},           {length.high, direction.high},
        {length.low, direction.high},          {length.high, direction.low},
        {between(length), between(direction)}, {between(length), between(direction)}};
    for (auto [j, m] : by) {
      if (target != Shape::kTriangle) {
        // As far as the ratio of lengths and direction allows.
        const LengthRange apart = scale_range_apart(c, target, ratio);
        m = std::clamp(m, j - apart.high, j - apart.low);
        if (m < direction.low || m > direction.high) continue;
      }
      std::vector<std::uint64_t> x, y;
      if (!scaled_words(c.a, Shape::kRay, format, j, m, x) ||
          !scaled_words(c.b, target, format, j, m, y))
        continue;
      words_a.insert(words_a.end(), x.begin(), x.end());
      words_b.insert(words_b.end(), y.begin(), y.end());
      made.push_back({all.size() - 1, j, m});
    }
  }
  std::vector<PairResult> results(made.size());
  reference::test_pairs(pair, algorithm, format, words_a, words_b, results);
  std::size_t hits = 0, wrong = 0, bad = 0;
  for (std::size_t i = 0; i < made.size(); ++i) {
    const auto [of, j, m] = made[i];
    const PairResult& r = results[i];
    const bool hit = all[of]->truth == Expected::Truth::kHit;
    const double t = std::ldexp(format.decode(r.t), m - j);
    bad += r.bad, hits += r.f;
    bool right = r.f == hit;
    if (right && hit) {
      right = all[of]->accepts(t);
      for (int k = 0; k < 3; ++k) right = right && std::isfinite(format.decode(r.cp[k]));
    }
    if (!right && ++wrong <= 3)
      ADD_FAILURE() << from[of].family << " by 2^" << j << ", d 2^" << m << ": F " << r.f
                    << ", expected " << hit << ", T at size one " << t << '\n'
                    << from[of].describe();
  }
  std::printf("%s %s: seed %llu, %zu cases, %zu answers, %zu hits, %zu wrong, %zu bad\n",
              std::string(name(pair)).c_str(), format.name().c_str(),
              static_cast<unsigned long long>(kSeed), all.size(), made.size(), hits, wrong, bad);
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(bad, 0u);
  EXPECT_GT(made.size(), static_cast<std::size_t>(cases) / 2);
  EXPECT_GT(hits, made.size() / 10);
}

std::vector<Parameter> parameters() {
  std::vector<Parameter> all;
  for (const FpFormat format : {FpFormat{8, 7}, FpFormat{8, 23}, FpFormat{11, 52}}) {
    for (unsigned a = 0; a < 4; ++a)
      all.push_back({Pair::kRayTriangle, static_cast<Algorithm>(a), format});
    all.push_back({Pair::kRaySphere, {}, format});
    all.push_back({Pair::kRayCylinder, {}, format});
  }
  return all;
}

std::string label(const ::testing::TestParamInfo<Parameter>& info) {
  std::ostringstream words;
  words << name(info.param.pair);
  if (info.param.pair == Pair::kRayTriangle) words << '_' << name(info.param.algorithm);
  words << '_' << info.param.format.name();
  std::string text = words.str();
  std::replace(text.begin(), text.end(), '-', '_');
  return text;
}

INSTANTIATE_TEST_SUITE_P(Rays, RayRange, ::testing::ValuesIn(parameters()), label);

}  // namespace
}  // namespace cde::testing
