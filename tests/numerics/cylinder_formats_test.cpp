// SPDX-License-Identifier: Apache-2.0
// Answers of the mirror references of the three cylinder pairs against the certified oracle, in
// every format.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "cde/oracle/oracle.hpp"
#include "cde/oracle/random.hpp"
#include "cde/reference/pipes/cylinder/pairs.hpp"
#include "cylinder_cases.hpp"

namespace cde::testing {
namespace {

using oracle::Vec;
using reference::Outcome;

constexpr std::uint64_t kSeed = kCylinderSeed;
constexpr reference::cylinder::Iterations kFull{8, 16, 16};

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

/// The operand in binary64: exactly the reference's input.
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

/// Scenes of size 1, operands rounded to the format. s_K is never above s. All but a counted few
/// are within 2^8 u S (or the oracle's 1e-8 S) of it.
TYPED_TEST(CylinderFormats, Formats_GiveALowerBound) {
  using S = TypeParam;
  const double u = reference::kUnitRoundoff<S>;
  int tried = 0, flagged = 0, low = 0;
  double above = 0;
  for (const oracle::Pair pair : {oracle::Pair::kCylinderCylinder, oracle::Pair::kObbCylinder,
                                  oracle::Pair::kTriangleCylinder}) {
    for (int i = 0; i < 200; ++i) {
      const oracle::Shape shape = random_primary(pair, kSeed + static_cast<std::uint64_t>(i));
      oracle::Random random(kSeed, 14, static_cast<std::uint64_t>(i));
      const Vec centre = 2 * random.direction(), axis = random.direction();
      const double half = random.decades(0.2, 2), radius = random.decades(0.2, 2);
      const auto b = operand<S>(oracle::Cylinder{centre, axis, half, radius});
      const auto judge = [&](const auto& a) {
        const Outcome<S> outcome = reference::cylinder::run<S>(a, b, kFull);
        ++tried, flagged += outcome.bad;
        if (outcome.bad) return;
        const oracle::SignedDistance distance = oracle::signed_distance(exact(a), exact(b));
        const double size = oracle::scene_size(exact(a), exact(b)), s = signed_distance_of(outcome);
        above = std::max(above, (s - distance.hi) / (u * size));
        low += !(distance.lo - s <= std::max(256 * u, 1e-8) * size);
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

}  // namespace
}  // namespace cde::testing
