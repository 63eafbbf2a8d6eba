// SPDX-License-Identifier: Apache-2.0
// The certificate checker accepts correct answers and names errors.
#include "cde/oracle/certificate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "cde/oracle/cases.hpp"

namespace cde::oracle {
namespace {

constexpr std::uint64_t kSeed = 77;

/// The correct answer of two spheres, in binary64.
Result of_spheres(const Sphere& a, const Sphere& b) {
  const Vec offset = b.c - a.c;
  const double apart = offset.norm();
  const Vec n = apart > 0 ? Vec(offset / apart) : Vec::UnitZ();
  const double s = apart - a.r - b.r;
  return {s <= 0, std::abs(s), ((a.c + a.r * n) + (b.c - b.r * n)) / 2, n};
}

struct SpherePair {
  Shape a, b;
  Result right;
  double tol_t, tol_p;
  bool decided;  // |s| is well outside the band
};

SpherePair sphere_pair(int i) {
  const Case c = generate(Pair::kSphereSphere, kSeed, i);
  SpherePair p{c.shape_a(), c.shape_b(), {}, 0, 0, false};
  p.right = of_spheres(std::get<Sphere>(p.a), std::get<Sphere>(p.b));
  const Decision v = check(p.a, p.b, p.right);
  p.tol_t = v.tolerance_t;
  p.tol_p = v.tolerance_p;
  p.decided = p.right.t > 3 * v.tolerance_t;
  return p;
}

constexpr int kCount = 500;

TEST(Certificate, CorrectAnswer_Passes) {
  int hits = 0, band = 0;
  for (int i = 0; i < kCount; ++i) {
    const SpherePair p = sphere_pair(i);
    const Decision v = check(p.a, p.b, p.right, {.u = 0x1p-48});
    EXPECT_TRUE(v.ok()) << i << ' ' << v.describe();
    EXPECT_FALSE(v.excused) << i;
    hits += p.right.f;
    band += check(p.a, p.b, p.right).in_band;
  }
  EXPECT_GT(hits, kCount * 3 / 10);
  EXPECT_LT(hits, kCount * 7 / 10);
  EXPECT_GT(band, kCount / 20);
}

TEST(Certificate, WrongAnswer_IsNamed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  int decided = 0;
  for (int i = 0; i < kCount; ++i) {
    const SpherePair p = sphere_pair(i);
    if (!p.decided) continue;
    ++decided;
    const auto failure = [&](auto&& spoil) {
      Result wrong = p.right;
      spoil(wrong);
      return check(p.a, p.b, wrong).failure;
    };
    EXPECT_EQ(failure([](Result&) {}), Failure::kNone) << i;
    EXPECT_EQ(failure([&](Result& r) { r.t = nan; }), Failure::kNotFinite) << i;
    EXPECT_EQ(failure([&](Result& r) { r.cp.y() = nan; }), Failure::kNotFinite) << i;
    EXPECT_EQ(failure([](Result& r) { r.f = !r.f; }), Failure::kFlag) << i;
    EXPECT_EQ(failure([](Result& r) { r.t = -r.t; }), Failure::kNegativeT) << i;
    EXPECT_EQ(failure([](Result& r) { r.n *= 1.001; }), Failure::kNotUnit) << i;
    EXPECT_EQ(failure([&](Result& r) { r.t += 1.5 * p.tol_t; }), Failure::kCertificate) << i;
    EXPECT_EQ(failure([&](Result& r) { r.t += 0.5 * p.tol_t; }), Failure::kNone) << i;
    // A true value of g, but for a normal that is 1 - cos(0.1) of the centre line worse.
    if (0.004 * (center(p.b) - center(p.a)).norm() > 2 * p.tol_t) {
      const auto tilt = [&](Result& r) {
        r.n = (r.n + 0.1 * r.n.unitOrthogonal()).normalized();
        const double s = distance_along(p.a, p.b, r.n);
        r.f = s <= 0, r.t = std::abs(s);
      };
      const Failure found = failure(tilt);
      EXPECT_TRUE(found == Failure::kOutside || found == Failure::kFlag) << i;
    }
    EXPECT_EQ(failure([&](Result& r) { r.cp += 1.5 * p.tol_p * r.n; }), Failure::kWitness) << i;
    EXPECT_EQ(failure([&](Result& r) { r.cp -= 1.5 * p.tol_p * r.n; }), Failure::kWitness) << i;
    EXPECT_EQ(failure([&](Result& r) { r.cp += 0.5 * p.tol_p * r.n; }), Failure::kNone) << i;
  }
  EXPECT_GT(decided, kCount / 3);
}

TEST(Certificate, WrongFlagInTheBand_IsCounted) {
  const Shape a = Sphere{Vec::Zero(), 1}, b = Sphere{Vec(0, 0, 2 + 1e-7), 1};
  const Result result{true, 0, Vec(0, 0, 1), Vec::UnitZ()};
  const Decision v = check(a, b, result);
  EXPECT_TRUE(v.ok()) << v.describe();
  EXPECT_TRUE(v.in_band);
  EXPECT_TRUE(v.excused);
  EXPECT_EQ(check(a, b, result, {.u = 0x1p-40}).failure, Failure::kFlag);
}

TEST(Certificate, BothNormalsOfAPlane_AreAccepted) {
  const Shape box = Obb{Vec(0, 0, 3), Vec::Ones(), Eigen::Matrix3d::Identity()};
  const Shape plane = Plane{Vec::UnitZ(), 1};
  const Result right{false, 1, Vec(0.5, -0.5, 1.5), -Vec::UnitZ()};
  EXPECT_TRUE(check(box, plane, right).ok()) << check(box, plane, right).describe();
  Result rounded = right;
  rounded.n.x() = 1e-7;
  EXPECT_TRUE(check(box, plane, rounded).ok());
  rounded.n.x() = 1e-3;
  EXPECT_EQ(check(box, plane, rounded).failure, Failure::kCertificate);
  Result beside = right;
  beside.cp.x() = 1.1;  // the plane's point is right, the box's point is not in the box
  EXPECT_EQ(check(box, plane, beside).failure, Failure::kWitness);
  Result flipped = right;
  flipped.n = Vec::UnitZ();
  EXPECT_EQ(check(box, plane, flipped).failure, Failure::kCertificate);
}

TEST(Certificate, LowerBound_ReportsShortfallAndRefusesAMiss) {
  int short_of = 0, false_hits = 0, refused = 0;
  for (int i = 0; i < kCount; ++i) {
    const Case c = generate(Pair::kCylinderCylinder, kSeed, i);
    const Shape a = c.shape_a(), b = c.shape_b();
    // The poorest possible list of normals: the centre line and the two axes.
    Vec n = Vec::UnitZ();
    double s = -std::numeric_limits<double>::infinity();
    for (const Vec& guess :
         {Vec(center(b) - center(a)), std::get<Cylinder>(a).axis, std::get<Cylinder>(b).axis})
      for (const double sign : {-1.0, 1.0})
        if (guess.norm() > 0 && distance_along(a, b, sign * guess) > s)
          n = sign * guess.normalized(), s = distance_along(a, b, n);
    const Vec cp = (center(a) + center(b)) / 2;
    const CheckOptions lower{.lower_bound = true};
    const Decision v = check(a, b, {s <= 0, std::abs(s), cp, n}, lower);
    EXPECT_TRUE(v.ok()) << v.describe() << '\n' << c.describe();
    EXPECT_NEAR(v.shortfall, std::max(0.0, v.distance.lo - s), 1e-12 * v.scale);
    short_of += v.shortfall > v.tolerance_t;
    false_hits += v.false_hit;
    // Claiming more than s is refused, and so is a miss of overlapping shapes.
    const double more = v.distance.hi + 2 * v.tolerance_t;
    EXPECT_FALSE(check(a, b, {more <= 0, std::abs(more), cp, n}, lower).ok());
    if (v.distance.hi < -v.tolerance_t) {
      EXPECT_EQ(check(a, b, {false, 0, cp, n}, lower).failure, Failure::kFlag);
      ++refused;
    }
  }
  EXPECT_GT(short_of, kCount / 5);
  EXPECT_GT(false_hits, kCount / 50);
  EXPECT_GT(refused, kCount / 5);
}

TEST(Certificate, VagueOracle_IsReported) {
  const Case c = generate(Pair::kObbObb, kSeed, 3);
  const Shape a = c.shape_a(), b = c.shape_b();
  const SignedDistance bounds = signed_distance(a, b, {1e-12, 200000});
  const CheckOptions vague{.u = 0x1p-45, .distance = {1e-3, 200000}, .lower_bound = true};
  const Decision v = check(a, b, {bounds.lo <= 0, std::abs(bounds.lo), center(a), bounds.n}, vague);
  EXPECT_EQ(v.failure, Failure::kOracleTooWide) << v.describe();
}

}  // namespace
}  // namespace cde::oracle
