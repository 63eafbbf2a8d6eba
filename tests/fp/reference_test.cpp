// SPDX-License-Identifier: Apache-2.0
// The reference itself, against the host's FPU with its flags, and against a search for the nearest
// word in the tiny formats.
#include "cde/fp/fp_reference.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cfenv>
#include <cmath>

#include "operands.hpp"

namespace cde::testing {
namespace {

template <class T>
FpResult on_host(FpOp op, T a, T b) {
  using Word = std::conditional_t<sizeof(T) == 4, uint32_t, uint64_t>;
  const FpFormat f = sizeof(T) == 4 ? FpFormat{8, 23} : FpFormat{11, 52};
  volatile T x = a, y = b;
  volatile T r = 0;
  std::feclearexcept(FE_ALL_EXCEPT);
  switch (op) {
    case FpOp::kAdd:
      r = x + y;
      break;
    case FpOp::kSub:
      r = x - y;
      break;
    case FpOp::kMul:
      r = x * y;
      break;
    case FpOp::kDiv:
      r = x / y;
      break;
    default:
      r = std::sqrt(x);
      break;
  }
  const int raised = std::fetestexcept(FE_ALL_EXCEPT);
  uint8_t flags = 0;
  if ((raised & FE_INEXACT) != 0) flags |= kFpInexact;
  if ((raised & FE_UNDERFLOW) != 0) flags |= kFpUnderflow;
  if ((raised & FE_OVERFLOW) != 0) flags |= kFpOverflow;
  if ((raised & FE_DIVBYZERO) != 0) flags |= kFpDivideByZero;
  if ((raised & FE_INVALID) != 0) flags |= kFpInvalid;
  const T result = r;
  return {std::isnan(result) ? f.canonical_nan() : std::bit_cast<Word>(result), flags};
}

template <class T>
void compare_with_host(FpFormat f) {
  using Word = std::conditional_t<sizeof(T) == 4, uint32_t, uint64_t>;
  std::mt19937_64 random(kSeed);
  int flagged = 0;
  const auto check = [&](uint64_t a, uint64_t b) {
    for (const FpOp op : {FpOp::kAdd, FpOp::kSub, FpOp::kMul, FpOp::kDiv, FpOp::kSqrt}) {
      const FpResult want = on_host(op, std::bit_cast<T>(static_cast<Word>(a)),
                                    std::bit_cast<T>(static_cast<Word>(b)));
      const FpResult got = fp_reference(op, f, a, b);
      ASSERT_EQ(got.word, want.word) << std::hex << static_cast<int>(op) << " " << a << " " << b;
#if defined(__x86_64__)  // other hosts may detect tininess before rounding
      ASSERT_EQ(got.flags, want.flags) << std::hex << static_cast<int>(op) << " " << a << " " << b;
#endif
      flagged += (want.flags & (kFpUnderflow | kFpOverflow)) != 0 ? 1 : 0;
    }
  };
  for (const uint64_t a : special_words(f))
    for (const uint64_t b : special_words(f)) check(a, b);
  for (const auto& [a, b] : boundary_pairs(f, random)) check(a, b);
  for (int i = 0; i < 200000; i++) {
    const auto [a, b] = random_pair(f, random);
    check(a, b);
  }
  EXPECT_GT(flagged, 10000);  // the edges were reached
}

TEST(FpReference, Fp32_EqualsTheHost) {
  compare_with_host<float>({8, 23});
}
TEST(FpReference, Fp64_EqualsTheHost) {
  compare_with_host<double>({11, 52});
}

/// The nearest word of a tiny format to x, from a search over all words. The value after the
/// largest finite one stands for infinity. A double holds x exactly, or so closely that ties are
/// not affected.
uint64_t nearest_by_search(FpFormat f, double x, bool minus) {
  const double magnitude = std::fabs(x);
  uint64_t best = 0;
  double distance = magnitude;
  for (uint64_t w = 1; w <= f.infinity(); w++) {
    const double value = w < f.infinity() ? f.decode(w) : 2 * f.decode(w - 1) - f.decode(w - 2);
    const double d = std::fabs(value - magnitude);
    if (d < distance || (d == distance && w % 2 == 0)) best = w, distance = d;
    if (w == f.infinity() && magnitude >= value) best = w;
  }
  return best | (minus ? f.sign_bit() : 0);
}

TEST(FpReference, TinyFormats_RoundToTheNearestWord) {
  for (const FpFormat f : {FpFormat{4, 3}, FpFormat{3, 2}}) {
    const uint64_t words = uint64_t{1} << f.width();
    for (uint64_t a = 0; a < words; a++) {
      for (uint64_t b = 0; b < words; b++) {
        const double x = f.decode(a), y = f.decode(b);
        for (const FpOp op : {FpOp::kAdd, FpOp::kSub, FpOp::kMul, FpOp::kDiv}) {
          const double exact = op == FpOp::kAdd   ? x + y
                               : op == FpOp::kSub ? x - y
                               : op == FpOp::kMul ? x * y
                                                  : x / y;
          const FpResult got = fp_reference(op, f, a, b);
          if (std::isnan(exact)) {
            ASSERT_EQ(got.word, f.canonical_nan());
          } else {
            ASSERT_EQ(got.word, nearest_by_search(f, exact, std::signbit(exact)))
                << static_cast<int>(op) << std::hex << " " << a << " " << b;
          }
        }
      }
      const double root = std::sqrt(f.decode(a));
      ASSERT_EQ(
          fp_reference(FpOp::kSqrt, f, a).word,
          std::isnan(root) ? f.canonical_nan() : nearest_by_search(f, root, std::signbit(root)));
    }
  }
}

TEST(FpReference, Integers_EqualTheHost) {
  std::mt19937_64 random(kSeed);
  const FpFormat f{8, 23}, d{11, 52};
  for (int i = 0; i < 100000; i++) {
    const uint64_t n = random_integer(random);
    EXPECT_EQ(fp_reference(FpOp::kFromI32, f, n).word,
              std::bit_cast<uint32_t>(static_cast<float>(static_cast<int32_t>(n))));
    EXPECT_EQ(fp_reference(FpOp::kFromUi64, f, n).word,
              std::bit_cast<uint32_t>(static_cast<float>(n)));
    EXPECT_EQ(fp_reference(FpOp::kFromI64, d, n).word,
              std::bit_cast<uint64_t>(static_cast<double>(static_cast<int64_t>(n))));
    const uint64_t w = random_word(d, random);
    const double x = std::bit_cast<double>(w);
    if (std::fabs(x) < 9e18) {
      EXPECT_EQ(fp_reference(FpOp::kToI64, d, w).word, static_cast<uint64_t>(std::llrint(x)));
      EXPECT_EQ(fp_reference(FpOp::kToI64Trunc, d, w).word,
                static_cast<uint64_t>(static_cast<int64_t>(x)));
    }
  }
  EXPECT_EQ(fp_reference(FpOp::kToI32, f, f.encode(2147483648.0)),
            (FpResult{0x7fffffff, kFpInvalid}));
  EXPECT_EQ(fp_reference(FpOp::kToI32, f, f.encode(-2147483648.0)), (FpResult{0x80000000, 0}));
  EXPECT_EQ(fp_reference(FpOp::kToUi32, f, f.encode(-0.25)), (FpResult{0, kFpInexact}));
  EXPECT_EQ(fp_reference(FpOp::kToUi32, f, f.encode(-1.0)), (FpResult{0, kFpInvalid}));
  EXPECT_EQ(fp_reference(FpOp::kToI32, f, f.encode(2.5)), (FpResult{2, kFpInexact}));
  EXPECT_EQ(fp_reference(FpOp::kToI32Trunc, f, f.encode(-2.75)),
            (FpResult{0xfffffffe, kFpInexact}));
  EXPECT_EQ(fp_reference(FpOp::kToI32, f, f.canonical_nan()), (FpResult{0x7fffffff, kFpInvalid}));
}

TEST(FpReference, MinAndMax_OrderZerosAndSkipNan) {
  const FpFormat f{8, 23};
  const uint64_t nan = f.canonical_nan(), signalling = f.infinity() | 1, one = f.encode(1),
                 zero = 0, minus_zero = f.sign_bit();
  EXPECT_EQ(fp_reference(FpOp::kMin, f, zero, minus_zero), (FpResult{minus_zero, 0}));
  EXPECT_EQ(fp_reference(FpOp::kMax, f, minus_zero, zero), (FpResult{zero, 0}));
  EXPECT_EQ(fp_reference(FpOp::kMin, f, nan, one), (FpResult{one, 0}));
  EXPECT_EQ(fp_reference(FpOp::kMax, f, one, signalling), (FpResult{one, kFpInvalid}));
  EXPECT_EQ(fp_reference(FpOp::kMax, f, nan | f.sign_bit(), nan), (FpResult{nan, 0}));
}

}  // namespace
}  // namespace cde::testing
