// SPDX-License-Identifier: Apache-2.0
// The software scalar Fp<E, M> against the reference of the floating-point units.
#include <gtest/gtest.h>

#include <bit>
#include <compare>
#include <cstdio>

#include "cde/fp/fp.hpp"
#include "cde/fp/fp_reference.hpp"
#include "cde/geometry/ops.hpp"
#include "operands.hpp"

namespace cde::testing {
namespace {

template <typename T>
class Scalar : public ::testing::Test {};

struct FormatName {
  template <typename T>
  static std::string GetName(int) {
    return FpFormat{T::kExponentBits, T::kFractionBits}.name();
  }
};
using Formats =
    ::testing::Types<Fp16, Bf16, Tf32, Fp24, E4m3, E3m2, Fp<8, 23>, Fp<10, 24>, Fp<5, 24>>;
TYPED_TEST_SUITE(Scalar, Formats, FormatName);

template <typename T>
T of(std::uint64_t word) {
  return T::from_bits(static_cast<typename T::Bits>(word));
}

template <typename T>
void compare(FpFormat f, std::uint64_t a, std::uint64_t b) {
  const T x = of<T>(a), y = of<T>(b);
  const std::pair<FpOp, T> values[] = {{FpOp::kAdd, x + y},
                                       {FpOp::kSub, x - y},
                                       {FpOp::kMul, x * y},
                                       {FpOp::kDiv, x / y},
                                       {FpOp::kSqrt, sqrt(x)},
                                       {FpOp::kMin, reference::min_num(x, y)},
                                       {FpOp::kMax, reference::max_num(x, y)}};
  for (const auto& [op, got] : values)
    ASSERT_EQ(std::uint64_t{got.bits()}, fp_reference(op, f, a, b).word)
        << "operation " << static_cast<int>(op) << std::hex << " of " << a << " " << b;
  const std::pair<FpOp, bool> decisions[] = {
      {FpOp::kLt, x < y}, {FpOp::kLe, x <= y}, {FpOp::kEq, x == y}};
  for (const auto& [op, got] : decisions)
    ASSERT_EQ(std::uint64_t{got}, fp_reference(op, f, a, b).word)
        << "comparison " << static_cast<int>(op) << std::hex << " of " << a << " " << b;
}

TYPED_TEST(Scalar, EveryOperation_EqualsTheUnit) {
  const FpFormat f{TypeParam::kExponentBits, TypeParam::kFractionBits};
  std::mt19937_64 random(kSeed);
  const std::vector<std::uint64_t> special = special_words(f);
  for (const std::uint64_t a : special)
    for (const std::uint64_t b : special) compare<TypeParam>(f, a, b);
  for (const auto& [a, b] : boundary_pairs(f, random)) compare<TypeParam>(f, a, b);
  for (int i = 0; i < 100000; ++i) {
    const auto [a, b] = random_pair(f, random);
    compare<TypeParam>(f, a, b);
  }
}

TYPED_TEST(Scalar, Conversions_RoundOnce) {
  const FpFormat f{TypeParam::kExponentBits, TypeParam::kFractionBits};
  std::mt19937_64 random(kSeed);
  for (int i = 0; i < 100000; ++i) {
    const std::uint64_t word = random_word(f, random);
    const TypeParam x = of<TypeParam>(word);
    const double value = static_cast<double>(x);
    if (!f.is_nan(word)) {
      ASSERT_EQ(std::bit_cast<std::uint64_t>(value), std::bit_cast<std::uint64_t>(f.decode(word)));
      ASSERT_EQ(std::uint64_t{TypeParam(value).bits()}, word);
    } else {
      ASSERT_TRUE(value != value);
    }
    const std::uint64_t wide = random_word({11, 52}, random);
    ASSERT_EQ(std::uint64_t{TypeParam(std::bit_cast<double>(wide)).bits()},
              fp_convert({11, 52}, f, wide).word)
        << std::hex << wide;
    ASSERT_EQ(std::uint64_t{TypeParam(Fp<7, 16>(value)).bits()},
              fp_convert({7, 16}, f, fp_convert(f, {7, 16}, word).word).word);
  }
}

TYPED_TEST(Scalar, SignOperationsAndClasses_FollowTheBits) {
  const FpFormat f{TypeParam::kExponentBits, TypeParam::kFractionBits};
  for (const std::uint64_t word : special_words(f)) {
    const TypeParam x = of<TypeParam>(word);
    EXPECT_EQ((-x).bits(), word ^ f.sign_bit());
    EXPECT_EQ(abs(x).bits(), word & ~f.sign_bit());
    // Operators give positive NaNs only.
    EXPECT_EQ(reference::move_sign(x, TypeParam(-1)).bits(),
              f.encode(-1) ^ (f.is_nan(word) ? 0 : word & f.sign_bit()));
    EXPECT_EQ(isnan(x), f.is_nan(word));
    EXPECT_EQ(isfinite(x), (word & f.magnitude_mask()) < f.infinity());
    EXPECT_EQ(signbit(x), (word & f.sign_bit()) != 0);
    EXPECT_EQ(reference::canonical(x).bits(), f.is_nan(word) ? f.canonical_nan() : word);
  }
}

TYPED_TEST(Scalar, Limits_AreThoseOfTheFormat) {
  using Limits = std::numeric_limits<TypeParam>;
  const FpFormat f{TypeParam::kExponentBits, TypeParam::kFractionBits};
  EXPECT_EQ(Limits::infinity().bits(), f.infinity());
  EXPECT_EQ(Limits::quiet_NaN().bits(), f.canonical_nan());
  EXPECT_EQ(Limits::max().bits(), f.infinity() - 1);
  EXPECT_EQ(static_cast<double>(Limits::min()), std::ldexp(1.0, f.emin()));
  EXPECT_EQ(static_cast<double>(Limits::denorm_min()), std::ldexp(1.0, f.emin() - f.man_bits));
  EXPECT_EQ(static_cast<double>(Limits::epsilon()), std::ldexp(1.0, -f.man_bits));
  EXPECT_EQ(reference::kUnitRoundoff<TypeParam>, std::ldexp(1.0, -f.man_bits - 1));
  EXPECT_EQ(Limits::digits, f.man_bits + 1);
  EXPECT_EQ(static_cast<double>(Limits::max()),
            std::ldexp(2 - std::ldexp(1.0, -f.man_bits), Limits::max_exponent - 1));
}

/// min and max of float and double equal the operators.
TEST(ScalarOps, NativeMinAndMax_EqualTheUnit) {
  const FpFormat f{8, 23};
  int zeros = 0;
  for (const std::uint64_t a : special_words(f)) {
    for (const std::uint64_t b : special_words(f)) {
      const auto x = std::bit_cast<float>(static_cast<std::uint32_t>(a)),
                 y = std::bit_cast<float>(static_cast<std::uint32_t>(b));
      ASSERT_EQ(std::bit_cast<std::uint32_t>(reference::min_num(x, y)),
                fp_reference(FpOp::kMin, f, a, b).word);
      ASSERT_EQ(std::bit_cast<std::uint32_t>(reference::max_num(x, y)),
                fp_reference(FpOp::kMax, f, a, b).word);
      zeros += x == 0 && y == 0;
    }
  }
  EXPECT_EQ(zeros, 4);
}

TEST(ScalarOps, EigenVectors_Compute) {
  using Vector = Eigen::Matrix<Fp16, 3, 1>;
  const Vector a(Fp16(1), Fp16(-2), Fp16(2));
  EXPECT_EQ(a.squaredNorm(), Fp16(9));
  EXPECT_EQ(a.norm(), Fp16(3));
  EXPECT_EQ((a * Fp16(0.5) + a).x(), Fp16(1.5));
  EXPECT_EQ(a.cast<double>().z(), 2.0);
  EXPECT_EQ(a.cwiseAbs().maxCoeff(), Fp16(2));
  EXPECT_TRUE(a.allFinite());
}

}  // namespace
}  // namespace cde::testing
