// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <string_view>

/// @file
/// Number formats and operation codes: rtl/contract/formats_pkg.sv in C++.
namespace cde {

/// Operations of an fp_unit simulation model. The pipes use the operations up to kMax.
enum class FpOp : std::uint32_t {
  kAdd,
  kSub,
  kMul,
  kDiv,
  kSqrt,
  kLt,
  kLe,
  kEq,
  kMin,
  kMax,
  kToFp16,
  kToBf16,
  kToTf32,
  kToFp24,
  kToFp32,
  kToFp64,
  kToE4m3,
  kToE3m2,
  kFromI32,
  kFromUi32,
  kFromI64,
  kFromUi64,
  kToI32,
  kToUi32,
  kToI64,
  kToUi64,  ///< nearest even
  kToI32Trunc,
  kToUi32Trunc,
  kToI64Trunc,
  kToUi64Trunc,  ///< toward zero
};
inline constexpr std::uint32_t kFpOps = 30;
inline constexpr std::uint32_t kFpArithmetic = 10;  ///< operations that are not conversions

/// Exception flags, with the bit values of Berkeley TestFloat. Underflow means tiny after rounding
/// and inexact.
inline constexpr std::uint8_t kFpInexact = 1, kFpUnderflow = 2, kFpOverflow = 4,
                              kFpDivideByZero = 8, kFpInvalid = 16;

namespace contract {

enum class Convert : unsigned { kFormat, kFromInt, kToInt };
/// Operations on bits, without arithmetic.
enum class Sign : unsigned { kAbs, kNeg, kCopy, kXor };
enum class Class : unsigned { kFinite, kNan, kPositive, kNonzero };
enum class Exponent : unsigned { kMax, kDown, kUp, kMove };
enum class Wire : unsigned { kSign, kAnd, kOr, kXor };

/// Named formats, in the order of their conversions.
struct FormatRow {
  std::string_view name;
  int exp_bits, man_bits;
};
inline constexpr std::array<FormatRow, 8> kFormatTable{{{"fp16", 5, 10},
                                                        {"bf16", 8, 7},
                                                        {"tf32", 8, 10},
                                                        {"fp24", 7, 16},
                                                        {"fp32", 8, 23},
                                                        {"fp64", 11, 52},
                                                        {"e4m3", 4, 3},
                                                        {"e3m2", 3, 2}}};

/// Bits of the word that holds a number of the format.
constexpr int container(int exp_bits, int man_bits) {
  return 1 + exp_bits + man_bits <= 32 ? 32 : 64;
}

}  // namespace contract
}  // namespace cde
