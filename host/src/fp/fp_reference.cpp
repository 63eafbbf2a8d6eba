// SPDX-License-Identifier: Apache-2.0
#include "cde/fp/fp_reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <limits>

#include "cde/support/error.hpp"

namespace cde {
namespace {

__extension__ using Wide = unsigned __int128;

int bit_length(Wide v) {
  const auto high = static_cast<uint64_t>(v >> 64);
  return high != 0 ? 64 + std::bit_width(high) : std::bit_width(static_cast<uint64_t>(v));
}

/// A finite number: (-1)^minus * magnitude * 2^exponent. The last bit may be sticky: it may stand
/// for any nonzero remainder below it. The magnitude then needs at least two bits more than the
/// format that it is rounded to.
struct Value {
  bool minus = false;
  Wide magnitude = 0;
  int exponent = 0;
};

struct Operand {
  bool nan = false, signalling = false, infinite = false;
  Value value;
  [[nodiscard]] bool zero() const { return !nan && !infinite && value.magnitude == 0; }
};

Operand unpack(FpFormat f, uint64_t word) {
  Operand o;
  const uint64_t magnitude = word & f.magnitude_mask();
  o.value.minus = (word & f.sign_bit()) != 0;
  o.nan = f.is_nan(word);
  o.signalling = f.is_signalling(word);
  o.infinite = magnitude == f.infinity();
  const auto exponent = static_cast<int>(magnitude >> f.man_bits);
  o.value.magnitude = magnitude & f.fraction_mask();
  if (exponent != 0) o.value.magnitude += Wide{1} << f.man_bits;
  o.value.exponent = std::max(exponent, 1) - f.bias() - f.man_bits;
  return o;
}

/// magnitude / 2^shift to the nearest integer, ties to even.
Wide round_shift(Wide magnitude, int shift, bool& inexact) {
  inexact = false;
  if (shift <= 0) return magnitude << -shift;
  if (shift > 127) {
    inexact = magnitude != 0;
    return 0;
  }
  const Wide whole = magnitude >> shift, rest = magnitude - (whole << shift),
             half = Wide{1} << (shift - 1);
  inexact = rest != 0;
  return whole + (rest > half || (rest == half && (whole & 1) != 0) ? 1 : 0);
}

FpResult infinity(FpFormat f, bool minus, uint8_t flags = 0) {
  return {f.infinity() | (minus ? f.sign_bit() : 0), flags};
}
FpResult zero(FpFormat f, bool minus) {
  return {minus ? f.sign_bit() : 0, 0};
}
FpResult nan(FpFormat f, bool invalid) {
  return {f.canonical_nan(), invalid ? kFpInvalid : uint8_t{0}};
}

/// Rounds once: to the format's precision, or to its smallest unit for a value that small.
FpResult round_to(FpFormat f, const Value& v) {
  if (v.magnitude == 0) return zero(f, v.minus);
  const int leading = bit_length(v.magnitude) - 1 + v.exponent;
  const int unit = std::max(leading - f.man_bits, f.emin() - f.man_bits);
  bool inexact = false;
  const Wide rounded = round_shift(v.magnitude, unit - v.exponent, inexact);
  bool ignored = false;
  const Wide unbounded = round_shift(v.magnitude, leading - f.man_bits - v.exponent, ignored);
  const bool tiny = bit_length(unbounded) - 1 + leading - f.man_bits < f.emin();
  const int top = bit_length(rounded) - 1 + unit;
  if (rounded != 0 && top > f.bias()) return infinity(f, v.minus, kFpOverflow | kFpInexact);
  uint64_t word = 0;
  if (rounded != 0 && top >= f.emin()) {
    // A carry to the next power of two leaves one trailing zero too many.
    const Wide significand = rounded >> (bit_length(rounded) - 1 - f.man_bits);
    word = (static_cast<uint64_t>(top + f.bias()) << f.man_bits) |
           (static_cast<uint64_t>(significand) & f.fraction_mask());
  } else {
    word = static_cast<uint64_t>(rounded);
  }
  if (v.minus) word |= f.sign_bit();
  uint8_t flags = inexact ? kFpInexact : 0;
  if (inexact && tiny) flags |= kFpUnderflow;
  return {word, flags};
}

FpResult add(FpFormat f, const Operand& a, const Operand& b) {
  if (a.nan || b.nan) return nan(f, a.signalling || b.signalling);
  if (a.infinite && b.infinite && a.value.minus != b.value.minus) return nan(f, true);
  if (a.infinite || b.infinite) return infinity(f, a.infinite ? a.value.minus : b.value.minus);
  if (a.zero() && b.zero()) return zero(f, a.value.minus && b.value.minus);
  if (a.zero()) return round_to(f, b.value);
  if (b.zero()) return round_to(f, a.value);
  const bool a_high = a.value.exponent >= b.value.exponent;
  const Value &high = a_high ? a.value : b.value, &low = a_high ? b.value : a.value;
  const int distance = high.exponent - low.exponent;
  Value sum{high.minus, 0, 0};
  Wide addend = 0;
  if (distance <= 70) {
    sum.magnitude = high.magnitude << distance;
    sum.exponent = low.exponent;
    addend = low.magnitude;
  } else {  // the lower operand is below one unit at 2^-60 of the higher one: only its presence
            // counts
    sum.magnitude = high.magnitude << 60;
    sum.exponent = high.exponent - 60;
    addend = 1;
  }
  if (high.minus == low.minus) {
    sum.magnitude += addend;
  } else if (addend > sum.magnitude) {
    sum.magnitude = addend - sum.magnitude;
    sum.minus = low.minus;
  } else {
    sum.magnitude -= addend;
  }
  if (sum.magnitude == 0) return zero(f, false);
  return round_to(f, sum);
}

FpResult multiply(FpFormat f, const Operand& a, const Operand& b) {
  if (a.nan || b.nan) return nan(f, a.signalling || b.signalling);
  const bool minus = a.value.minus != b.value.minus;
  if (a.infinite || b.infinite) return a.zero() || b.zero() ? nan(f, true) : infinity(f, minus);
  return round_to(
      f, {minus, a.value.magnitude * b.value.magnitude, a.value.exponent + b.value.exponent});
}

FpResult divide(FpFormat f, const Operand& a, const Operand& b) {
  if (a.nan || b.nan) return nan(f, a.signalling || b.signalling);
  const bool minus = a.value.minus != b.value.minus;
  if ((a.infinite && b.infinite) || (a.zero() && b.zero())) return nan(f, true);
  if (a.infinite) return infinity(f, minus);
  if (b.zero()) return infinity(f, minus, kFpDivideByZero);
  if (a.zero() || b.infinite) return zero(f, minus);
  const int shift = 126 - bit_length(a.value.magnitude);
  const Wide numerator = a.value.magnitude << shift;
  const Wide quotient = numerator / b.value.magnitude, rest = numerator % b.value.magnitude;
  return round_to(f, {minus, (quotient << 1) | (rest != 0 ? 1 : 0),
                      a.value.exponent - shift - b.value.exponent - 1});
}

FpResult square_root(FpFormat f, const Operand& a) {
  if (a.nan) return nan(f, a.signalling);
  if (a.zero()) return zero(f, a.value.minus);
  if (a.value.minus) return nan(f, true);
  if (a.infinite) return infinity(f, false);
  int shift = 124 - bit_length(a.value.magnitude);
  if ((a.value.exponent - shift) % 2 != 0) shift++;
  const Wide radicand = a.value.magnitude << shift;
  Wide root = 0;
  for (int bit = 62; bit >= 0; bit--) {
    const Wide trial = root | (Wide{1} << bit);
    if (trial * trial <= radicand) root = trial;
  }
  return round_to(f, {false, (root << 1) | (root * root != radicand ? 1 : 0),
                      (a.value.exponent - shift) / 2 - 1});
}

/// Order of two operands that are not NaN: -1, 0, 1. Every format's values are doubles.
int compare(FpFormat f, uint64_t a, uint64_t b) {
  const double x = f.decode(a), y = f.decode(b);
  return x < y ? -1 : x > y ? 1 : 0;
}

FpResult extremum(FpFormat f, uint64_t a, uint64_t b, bool maximum) {
  const uint8_t flags = f.is_signalling(a) || f.is_signalling(b) ? kFpInvalid : 0;
  if (f.is_nan(a) && f.is_nan(b)) return {f.canonical_nan(), flags};
  if (f.is_nan(a)) return {b, flags};
  if (f.is_nan(b)) return {a, flags};
  int order = compare(f, a, b);
  if (order == 0 && a != b) order = (a & f.sign_bit()) != 0 ? -1 : 1;  // the two zeros
  return {(order < 0) != maximum ? a : b, flags};
}

FpResult from_integer(FpFormat f, uint64_t a, int bits, bool is_signed) {
  if (bits == 32) a &= 0xffffffffu;
  const bool minus = is_signed && (a >> (bits - 1)) != 0;
  const uint64_t magnitude = minus ? (bits == 32 ? (uint64_t{1} << 32) - a : uint64_t{0} - a) : a;
  return round_to(f, {minus, magnitude, 0});
}

FpResult to_integer(const Operand& a, int bits, bool is_signed, bool truncate) {
  const uint64_t all = bits == 32 ? 0xffffffffu : std::numeric_limits<uint64_t>::max();
  const uint64_t largest = is_signed ? all >> 1 : all, lowest = is_signed ? largest + 1 : 0;
  const bool minus = a.value.minus && !a.nan;
  const FpResult saturated{minus ? lowest : largest, kFpInvalid};
  if (a.nan || a.infinite) return saturated;
  if (a.value.magnitude != 0 && bit_length(a.value.magnitude) + a.value.exponent > 65)
    return saturated;
  bool inexact = false;
  Wide whole = round_shift(a.value.magnitude, -a.value.exponent, inexact);
  if (truncate && a.value.exponent < 0)
    whole = a.value.exponent <= -128 ? 0 : a.value.magnitude >> -a.value.exponent;
  if (whole > (minus ? lowest : largest)) return saturated;
  const auto word = static_cast<uint64_t>(whole);
  return {(minus ? uint64_t{0} - word : word) & all, inexact ? kFpInexact : uint8_t{0}};
}

}  // namespace

int fp_operands(FpOp op) {
  return op == FpOp::kSqrt || op >= FpOp::kToFp16 ? 1 : 2;
}

FpResult fp_convert(FpFormat from, FpFormat to, uint64_t a) {
  const Operand o = unpack(from, a);
  if (o.nan) return nan(to, o.signalling);
  if (o.infinite) return infinity(to, o.value.minus);
  return round_to(to, o.value);
}

FpResult fp_reference(FpOp op, FpFormat f, uint64_t a, uint64_t b) {
  const auto number = static_cast<uint32_t>(op);
  if (number >= kFpOps)
    throw Error(ErrorCode::kUsage,
                fmt::format("there is no operation {}; expected 0 to {}", number, kFpOps - 1));
  if (op >= FpOp::kFromI32 && op <= FpOp::kFromUi64) {
    const uint32_t k = number - static_cast<uint32_t>(FpOp::kFromI32);
    return from_integer(f, a, k < 2 ? 32 : 64, k % 2 == 0);
  }
  const uint64_t mask = f.sign_bit() | f.magnitude_mask();
  a &= mask;
  b &= mask;
  if (op >= FpOp::kToI32) {
    const uint32_t k = number - static_cast<uint32_t>(FpOp::kToI32);
    return to_integer(unpack(f, a), k % 4 < 2 ? 32 : 64, k % 2 == 0, k >= 4);
  }
  if (op >= FpOp::kToFp16)
    return fp_convert(f, kFpFormats.at(number - static_cast<uint32_t>(FpOp::kToFp16)).format, a);
  const bool any_nan = f.is_nan(a) || f.is_nan(b);
  const bool signalling = f.is_signalling(a) || f.is_signalling(b);
  switch (op) {
    case FpOp::kAdd:
      return add(f, unpack(f, a), unpack(f, b));
    case FpOp::kSub: {
      Operand minus_b = unpack(f, b);
      minus_b.value.minus = !minus_b.value.minus;
      return add(f, unpack(f, a), minus_b);
    }
    case FpOp::kMul:
      return multiply(f, unpack(f, a), unpack(f, b));
    case FpOp::kDiv:
      return divide(f, unpack(f, a), unpack(f, b));
    case FpOp::kSqrt:
      return square_root(f, unpack(f, a));
    case FpOp::kLt:
      return {!any_nan && compare(f, a, b) < 0, any_nan ? kFpInvalid : uint8_t{0}};
    case FpOp::kLe:
      return {!any_nan && compare(f, a, b) <= 0, any_nan ? kFpInvalid : uint8_t{0}};
    case FpOp::kEq:
      return {!any_nan && compare(f, a, b) == 0, signalling ? kFpInvalid : uint8_t{0}};
    case FpOp::kMin:
      return extremum(f, a, b, false);
    default:
      return extremum(f, a, b, true);
  }
}

}  // namespace cde
