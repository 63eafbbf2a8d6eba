// SPDX-License-Identifier: Apache-2.0
// The input contract of every primitive: defect() in words, and bad() as on the card. Also the
// order of the words in a slot.
#include "cde/geometry/primitives.hpp"

#include <cmath>
#include <cstdio>
#include <limits>
#include <random>

#include "cde/geometry/check.hpp"
#include "testing.hpp"

namespace cde {
namespace {

using testing::expect_error;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

template <typename P>
P numbered() {
  std::array<float, P::kWords> words;
  for (std::size_t i = 0; i < words.size(); ++i) words[i] = static_cast<float>(i);
  return from_words<P>(words);
}

TEST(PrimitiveWords, Words_StandInSlotOrder) {
  const Ray ray = numbered<Ray>();
  EXPECT_EQ(ray.o, Eigen::Vector3f(0, 1, 2));
  EXPECT_EQ(ray.d, Eigen::Vector3f(3, 4, 5));
  EXPECT_EQ(ray.tmin, 6);
  EXPECT_EQ(ray.tmax, 7);
  EXPECT_EQ(numbered<Triangle>().v2, Eigen::Vector3f(6, 7, 8));
  EXPECT_EQ(numbered<Sphere>().r, 3);
  EXPECT_EQ(numbered<Aabb>().max, Eigen::Vector3f(3, 4, 5));
  EXPECT_EQ(numbered<Plane>().n, Eigen::Vector3f(0, 1, 2));
  EXPECT_EQ(numbered<Plane>().d, 3);
  const Cylinder cylinder = numbered<Cylinder>();
  EXPECT_EQ(cylinder.axis, Eigen::Vector3f(3, 4, 5));
  EXPECT_EQ(cylinder.half_height, 6);
  EXPECT_EQ(cylinder.radius, 7);
  const Obb box = numbered<Obb>();
  EXPECT_EQ(box.half, Eigen::Vector3f(3, 4, 5));
  for (int axis = 0; axis < 3; ++axis) {
    const float first = 6 + static_cast<float>(axis);
    EXPECT_EQ(Eigen::Vector3f(box.rotation.col(axis)),
              Eigen::Vector3f(first, first + 3, first + 6));
  }
}

template <typename P>
void expect_round_trip() {
  const auto words = to_words(numbered<P>());
  for (std::size_t i = 0; i < words.size(); ++i) EXPECT_EQ(words[i], static_cast<float>(i));
  const auto wide = to_words(primitive_cast<double>(numbered<P>()));
  for (std::size_t i = 0; i < wide.size(); ++i) EXPECT_EQ(wide[i], static_cast<double>(i));
}

TEST(PrimitiveWords, Words_SurviveRoundTripAndCast) {
  for (unsigned shape = 0; shape < kShapes; ++shape)
    with_shape<float>(static_cast<Shape>(shape), []<class P>() { expect_round_trip<P>(); });
  Ray ray = numbered<Ray>();
  ray.o.x() = 1.0f / 3;
  EXPECT_EQ(static_cast<double>(primitive_cast<Fp16>(ray).o.x()), 0x1.554p-2);
}

const Sphere kSphere{{0, 0, 0}, 1};
const Aabb kAabb{{-1, -1, -1}, {1, 1, 1}};
const Plane kPlane{{0, 0.6f, 0.8f}, 2};
const Cylinder kCylinder{{0, 0, 0}, {0, -1, 0}, 2, 1};
const Obb kObb{{0, 0, 0}, {1, 2, 3}, Eigen::Matrix3f::Identity()};

/// The primitive with one word replaced.
template <typename P>
P with(P primitive, std::size_t word, float value) {
  auto words = to_words(primitive);
  words[word] = value;
  return from_words<P>(words);
}

TEST(PrimitiveContract, PlainPrimitives_AreValid) {
  EXPECT_EQ(defect(kSphere), std::nullopt);
  EXPECT_EQ(defect(kAabb), std::nullopt);
  EXPECT_EQ(defect(kPlane), std::nullopt);
  EXPECT_EQ(defect(kCylinder), std::nullopt);
  EXPECT_EQ(defect(kObb), std::nullopt);
  Obb mirrored = kObb;
  mirrored.rotation.col(1) *= -1;
  EXPECT_EQ(defect(mirrored), std::nullopt) << "a reflected box is the same box";
}

TEST(PrimitiveContract, Violation_NamesFieldAndExpectation) {
  EXPECT_EQ(defect(with(kSphere, 1, kNan)), "center.y is nan");
  EXPECT_EQ(defect(with(kSphere, 3, kInf)), "radius is inf");
  EXPECT_EQ(defect(with(kSphere, 3, 0)), "radius is 0, must be > 0");
  EXPECT_EQ(defect(with(kSphere, 3, -2)), "radius is -2, must be > 0");
  EXPECT_EQ(defect(with(kSphere, 3, 0x1p-34f)), std::nullopt);
  EXPECT_EQ(defect(with(kSphere, 3, 5e-11f)), "radius is 5.00000007e-11, must be 2^-34 to 2^40");
  EXPECT_EQ(defect(with(kSphere, 3, 2e12f)),
            "radius is 1.99999999e+12, must be at most 2^40 in size");
  EXPECT_EQ(defect(with(kPlane, 3, -2e12f)), "d is -1.99999999e+12, must be at most 2^40 in size");
  EXPECT_EQ(defect(with(kAabb, 4, -1)), "max.y is -1, must be > min.y = -1");
  EXPECT_EQ(defect(with(kAabb, 2, -kInf)), "min.z is -inf");
  EXPECT_EQ(defect(with(kPlane, 3, kInf)), "d is inf");
  EXPECT_EQ(defect(with(kPlane, 0, 0.1f)),
            "normal has squared length 1.01, must be 1 within 9.54e-07");
  EXPECT_EQ(defect(with(kCylinder, 4, 0)), "axis has squared length 0, must be 1 within 9.54e-07");
  EXPECT_EQ(defect(with(kCylinder, 6, 0)), "half height is 0, must be > 0");
  EXPECT_EQ(defect(with(kCylinder, 7, -0.0f)), "radius is -0, must be > 0");
  EXPECT_EQ(defect(with(kObb, 4, 0)), "half extent.y is 0, must be > 0");
  EXPECT_EQ(defect(with(kObb, 7, kNan)), "rotation[0][1] is nan");
  EXPECT_EQ(defect(with(kObb, 7, 0.25f)),
            "rotation is not orthonormal: the product of columns 0 and 1 is 0.25, must be 0 within "
            "9.54e-07");
  EXPECT_EQ(defect(with(kObb, 14, 3e38f)),
            "rotation is not orthonormal: the product of columns 2 and 2 is inf, must be 1 within "
            "9.54e-07");
  expect_error(ErrorCode::kBadInput, "sphere 3: radius is 0, must be > 0",
               [] { check(with(kSphere, 3, 0), "sphere 3"); });
}

TEST(PrimitiveContract, UnitVectors_HaveTheStatedTolerance) {
  EXPECT_EQ(reference::kUnitTolerance<float>, 0x1p-20);
  EXPECT_EQ(reference::kUnitTolerance<double>, 0x1p-20);
  EXPECT_EQ(reference::kUnitTolerance<Fp16>, 0x1p-7);
  EXPECT_EQ(defect(with(kCylinder, 4, 1 + 0x1p-22f)), std::nullopt);
  EXPECT_EQ(defect(with(kCylinder, 4, 1 + 0x1p-21f + 0x1p-23f)),
            "axis has squared length 1.0000012, must be 1 within 9.54e-07");
}

/// defect() and bad() agree for all words.
template <typename P>
void expect_agreement(const P& plain, std::mt19937& random, int& flagged, int& clean) {
  constexpr float kValues[] = {
      0,        -0.0f,           1,        -1,       kNan,           kInf,
      -kInf,    1e-45f,          0.5f,     2,        3e38f,          1e-30f,
      0x1p-34f, 0x1.fffffep-35f, 0x1p40f,  -0x1p40f, 0x1.000002p40f, 0.999999f,
      0.9999f,  1.0000001f,      1.000001f};
  ASSERT_EQ(defect(plain), std::nullopt);
  for (int i = 0; i < 20000; ++i) {
    auto words = to_words(plain);
    for (unsigned changes = random() % 3; changes > 0; --changes)
      words[random() % words.size()] = kValues[random() % std::size(kValues)];
    const P primitive = from_words<P>(words);
    const bool bad = reference::bad(primitive);
    ASSERT_EQ(defect(primitive).has_value(), bad) << *defect(primitive);
    ++(bad ? flagged : clean);
  }
}

TEST(PrimitiveContract, DefectAndBad_Agree) {
  constexpr unsigned kSeed = 13;
  std::mt19937 random(kSeed);
  int flagged = 0, clean = 0;
  expect_agreement(Ray{{0, 0, 0}, {0, 0, 1}}, random, flagged, clean);
  expect_agreement(numbered<Triangle>(), random, flagged, clean);
  expect_agreement(kSphere, random, flagged, clean);
  expect_agreement(kAabb, random, flagged, clean);
  expect_agreement(kPlane, random, flagged, clean);
  expect_agreement(kCylinder, random, flagged, clean);
  expect_agreement(kObb, random, flagged, clean);
  std::printf("seed %u: %d flagged, %d clean\n", kSeed, flagged, clean);
  EXPECT_GT(flagged, 40000);
  EXPECT_GT(clean, 40000);
}

}  // namespace
}  // namespace cde
