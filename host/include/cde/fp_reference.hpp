#pragma once
#include <cstdint>

#include "cde/fp_format.hpp"

namespace cde {

/// Operations of an fp_unit bitstream; the numbers are those of verilator/abi_fp.h.
enum class FpOp : uint32_t {
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
inline constexpr uint32_t kFpOps = 30;

/// Exception flags, with the bit values of Berkeley TestFloat. Underflow is tininess after
/// rounding, and inexact.
inline constexpr uint8_t kFpInexact = 1, kFpUnderflow = 2, kFpOverflow = 4, kFpDivideByZero = 8,
                         kFpInvalid = 16;

/// A result word (a format's word, an integer's two's complement, or 0/1 of a comparison) and its
/// flags.
struct FpResult {
  uint64_t word = 0;
  uint8_t flags = 0;
  bool operator==(const FpResult&) const = default;
};

/// Operands of the operation: 1 or 2.
[[nodiscard]] int fp_operands(FpOp op);

/// The operation by definition: the exact value as a wide integer, rounded once to nearest even.
/// Independent of the RTL. NaN results are canonical. min and max are minimumNumber and
/// maximumNumber of IEEE 754-2019. lt and le signal on any NaN, eq on a signalling one. To integer:
/// out of range saturates, NaN gives the largest integer, both with invalid alone; an inexact
/// result is flagged. Operands beyond the format's width are ignored.
[[nodiscard]] FpResult fp_reference(FpOp op, FpFormat format, uint64_t a, uint64_t b = 0);

/// Conversion between any two formats.
[[nodiscard]] FpResult fp_convert(FpFormat from, FpFormat to, uint64_t a);

}  // namespace cde
