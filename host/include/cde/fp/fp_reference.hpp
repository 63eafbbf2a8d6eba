// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <string_view>

#include "cde/contract/formats.hpp"
#include "cde/fp/fp_format.hpp"

namespace cde {

/// A result word and its flags. The word is a format's word, an integer in two's complement, or 0/1
/// for a comparison.
struct FpResult {
  uint64_t word = 0;
  uint8_t flags = 0;
  bool operator==(const FpResult&) const = default;
};

/// Names for the command line and messages, by code.
inline constexpr std::array<const char*, kFpOps> kFpOpNames{
    "add",      "sub",       "mul",          "div",           "sqrt",         "lt",
    "le",       "eq",        "min",          "max",           "to_fp16",      "to_bf16",
    "to_tf32",  "to_fp24",   "to_fp32",      "to_fp64",       "to_e4m3",      "to_e3m2",
    "from_i32", "from_ui32", "from_i64",     "from_ui64",     "to_i32",       "to_ui32",
    "to_i64",   "to_ui64",   "to_i32_trunc", "to_ui32_trunc", "to_i64_trunc", "to_ui64_trunc"};
static_assert(
    [] {
      constexpr auto kFirst = static_cast<std::size_t>(FpOp::kToFp16);
      if (static_cast<std::size_t>(FpOp::kFromI32) != kFirst + kFpFormats.size()) return false;
      for (std::size_t k = 0; k < kFpFormats.size(); ++k) {
        const std::string_view name = kFpOpNames[kFirst + k];
        if (!name.starts_with("to_") || name.substr(3) != kFpFormats[k].name) return false;
      }
      return true;
    }(),
    "each format with a name has a conversion, FpOp::kToNAME and \"to_name\", in the same order");
static_assert(
    static_cast<std::uint32_t>(FpOp::kToUi64Trunc) + 1 == kFpOps && kFpOps <= 32,
    "kFpOps counts the operations; the parameter OPS of fp_unit has a bit for 32 of them");

/// Number of operands: 1 or 2.
[[nodiscard]] int fp_operands(FpOp op);

/// The operation by definition: the exact value as a wide integer, rounded once to nearest even.
/// Independent of the RTL. NaN results are canonical. The operations min and max are minimumNumber
/// and maximumNumber of IEEE 754-2019. Comparisons lt and le signal on any NaN, eq on a signalling
/// one. Conversion to integer: out of range saturates, and NaN gives the largest integer, both with
/// invalid alone. An inexact result is flagged. Operand bits beyond the format's width are ignored.
[[nodiscard]] FpResult fp_reference(FpOp op, FpFormat format, uint64_t a, uint64_t b = 0);

/// Conversion between any two formats.
[[nodiscard]] FpResult fp_convert(FpFormat from, FpFormat to, uint64_t a);

}  // namespace cde
