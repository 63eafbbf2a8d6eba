// SPDX-License-Identifier: Apache-2.0
// The card's answers for rays and triangles against exact arithmetic. A decision that the error
// bound of bounds.hpp leaves uncertain is excused and counted. Every other decision must be right,
// and T and CP must lie within their bounds.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "cde/card/board.hpp"
#include "cde/geometry/bounds.hpp"
#include "cde/oracle/exact.hpp"

namespace {

using cde::Ray;
using cde::Triangle;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr unsigned kSeed = 20070129;

struct Case {
  const char* name;
  double offset;     ///< distance of the scene from the world's origin
  double size;       ///< of the triangles
  double near_edge;  ///< share of rays aimed within 1e-2 .. 1e-7 of an edge
};

std::ostream& operator<<(std::ostream& out, const Case& c) {
  return out << c.name;
}

class Generator {
 public:
  explicit Generator(const Case& c) : case_(c) {}
  Ray ray() {
    Ray r;
    r.o = (vector() + Vector3d::Constant(case_.offset)).cast<float>();
    r.d = vector().cast<float>();
    return r;
  }
  /// A triangle that the ray meets at known, often awkward, barycentric coordinates.
  Triangle triangle(const Ray& ray) {
    const Vector3d at = ray.o.cast<double>() + (0.5 + 4 * unit()) * ray.d.cast<double>();
    const Vector3d e1 = case_.size * vector(), e2 = case_.size * vector();
    double u = 1.3 * unit() - 0.15, v = (1.3 * unit() - 0.15) * (1 - u);
    if (unit() < case_.near_edge) {
      const double distance = (unit() < 0.5 ? 1 : -1) * std::pow(10.0, -2 - 5 * unit());
      switch (bits_() % 3) {
        case 0:
          u = distance, v = unit();
          break;
        case 1:
          v = distance, u = unit();
          break;
        default:
          u = unit(), v = 1 - u + distance;
      }
    }
    const Vector3d v0 = at - u * e1 - v * e2;
    return {v0.cast<float>(), (v0 + e1).cast<float>(), (v0 + e2).cast<float>()};
  }

 private:
  double unit() { return (bits_() >> 11) * 0x1p-53; }
  Vector3d vector() { return {2 * unit() - 1, 2 * unit() - 1, 2 * unit() - 1}; }
  Case case_;
  std::mt19937_64 bits_{kSeed};
};

enum class Truth { kHit, kMiss, kUncertain };

/// The required decision, given the error of each compared quantity.
Truth decide(const Ray& ray, const ExactHit& exact, const cde::MollerBound& bound) {
  const double det = static_cast<double>(exact.det);
  if (exact.det == 0) return bound.det == 0 ? Truth::kMiss : Truth::kUncertain;
  const double size = std::abs(det);
  if (size <= bound.det) return Truth::kUncertain;
  const double u = static_cast<double>(exact.u), v = static_cast<double>(exact.v),
               t = static_cast<double>(exact.t);
  const double rest = static_cast<double>(ExactHit::Rational(1 - exact.u - exact.v));
  const double dt = bound.t(det, t);
  const double margins[] = {u * size - bound.u, v * size - bound.v,
                            rest * size - bound.uv - bound.det, t - ray.tmin - dt,
                            ray.tmax - t - dt};
  const double failures[] = {-u * size - bound.u, -v * size - bound.v,
                             -rest * size - bound.uv - bound.det, ray.tmin - t - dt,
                             t - ray.tmax - dt};
  for (double f : failures)
    if (f > 0) return Truth::kMiss;
  for (double m : margins)
    if (!(m > 0)) return Truth::kUncertain;
  return Truth::kHit;
}

class MollerAgainstExact : public ::testing::TestWithParam<Case> {};

TEST_P(MollerAgainstExact, Decisions_AreRightOutsideTheBand) {
  constexpr int kRays = 40, kTriangles = 500;
  Generator generate(GetParam());
  cde::Board board = cde::Board::open(cde::BoardConfig{});
  int hits = 0, uncertain = 0, wrong_in_band = 0;
  double worst_t = 0;
  for (int r = 0; r < kRays; ++r) {
    Ray ray = generate.ray();
    if (r % 4 == 0) ray.tmin = 1, ray.tmax = 3;
    std::vector<Triangle> triangles;
    triangles.reserve(kTriangles);
    for (int i = 0; i < kTriangles; ++i) triangles.push_back(generate.triangle(ray));
    board.upload(triangles);
    board.load({&ray, 1});
    const std::vector<cde::Record> records = board.run(cde::Query{.mode = cde::Mode::kAll});
    ASSERT_EQ(records.size(), triangles.size());
    for (int i = 0; i < kTriangles; ++i) {
      const ExactHit exact(ray, triangles[i]);
      const cde::MollerBound bound = cde::moller_bound(ray, triangles[i]);
      const Truth truth = decide(ray, exact, bound);
      const bool f = records[i].f;
      hits += f;
      if (truth == Truth::kUncertain) {
        ++uncertain;
        wrong_in_band += f != exact.hit(ray);
      } else {
        ASSERT_EQ(f, truth == Truth::kHit)
            << "ray " << r << " triangle " << i << " seed " << kSeed << std::hexfloat << "\n o "
            << ray.o.transpose() << "\n d " << ray.d.transpose() << "\n v0 "
            << triangles[i].v0.transpose() << "\n v1 " << triangles[i].v1.transpose() << "\n v2 "
            << triangles[i].v2.transpose();
      }
      if (!f || exact.det == 0) continue;
      const double det = static_cast<double>(exact.det), t = static_cast<double>(exact.t),
                   dt = bound.t(det, t);
      if (!std::isfinite(dt)) continue;  // det itself is uncertain; counted above
      EXPECT_LE(std::abs(records[i].t - t), dt);
      worst_t = std::max(worst_t, std::abs(records[i].t - t) / dt);
      const Vector3d cp = ray.o.cast<double>() + t * ray.d.cast<double>();
      EXPECT_LE((records[i].cp.cast<double>() - cp).cwiseAbs().maxCoeff(), bound.cp(ray, det, t));
    }
  }
  const int pairs = kRays * kTriangles;
  std::printf(
      "%s: seed %u, %d pairs, %.1f %% hit, %d (%.2f %%) left uncertain by the bound, %d of them "
      "decided "
      "otherwise than exact arithmetic, "
      "largest error of T %.2f of its bound\n",
      GetParam().name, kSeed, pairs, 100.0 * hits / pairs, uncertain, 100.0 * uncertain / pairs,
      wrong_in_band, worst_t);
  EXPECT_GT(hits, 0.3 * pairs);
  EXPECT_LT(hits, 0.7 * pairs);
  EXPECT_LT(uncertain, 0.5 * pairs) << "the band excuses too many pairs";
}

INSTANTIATE_TEST_SUITE_P(Scenes, MollerAgainstExact,
                         ::testing::Values(Case{"AtOrigin", 0, 1, 0.5}, Case{"TenAway", 10, 1, 0.5},
                                           Case{"ThousandAway", 1000, 1, 0.2},
                                           Case{"Small", 0, 1e-3, 0.5}, Case{"Large", 0, 1e3, 0.5}),
                         [](const auto& info) { return info.param.name; });

TEST(Exact, HandWorkedHit_IsExact) {
  Ray ray;
  ray.o = Vector3f(0.25f, 0.25f, 2);
  ray.d = Vector3f(0, 0, -0.5f);
  const Triangle triangle{Vector3f(0, 0, 0), Vector3f(1, 0, 0), Vector3f(0, 1, 0)};
  const ExactHit hit(ray, triangle);
  EXPECT_EQ(hit.u, ExactHit::Rational(1, 4));
  EXPECT_EQ(hit.v, ExactHit::Rational(1, 4));
  EXPECT_EQ(hit.t, 4);
  EXPECT_TRUE(hit.hit(ray));
  ray.tmax = 3.9f;
  EXPECT_FALSE(hit.hit(ray));
}

}  // namespace
