// SPDX-License-Identifier: Apache-2.0
// The host back end of rtl/fp (ARITH = "host"): one lane's operation on the host's FPU,
// bit-identical to the gates.
//
// The code is straight-line, so that clang turns LANES calls into vector instructions. fp32 and
// fp64 are native. A format of at most 10 exponent bits and p <= 25 significand bits is computed in
// double and rounded once more to the format. This second rounding is innocuous because 53 >= 2p +
// 2. Other formats are computed in binary128 (113 >= 2p + 2), with a library call per operation.
// The FPU must be in its default mode (nearest even, no flush to zero).
#pragma once
#include <bit>
#include <cfenv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "cde/contract/formats.hpp"

extern "C" __float128 sqrtf128(__float128);  // of glibc's libm

namespace host_fp {

using cde::FpOp;
using cde::contract::Class;
using cde::contract::Convert;
using cde::contract::Exponent;
using cde::contract::Sign;

/// Codes are plain numbers in template parameters, as the generated models write them.
template <class Op>
constexpr unsigned code(Op op) {
  return static_cast<unsigned>(op);
}
template <class Op>
constexpr bool is(unsigned number, Op op) {
  return number == code(op);
}

__extension__ using Quad = __float128;
__extension__ using QuadBits = unsigned __int128;

constexpr uint32_t kInexact = cde::kFpInexact, kUnderflow = cde::kFpUnderflow,
                   kOverflow = cde::kFpOverflow, kDivideByZero = cde::kFpDivideByZero,
                   kInvalid = cde::kFpInvalid;

/// Selects by mask (all ones or all zeros), without a branch.
template <class U>
inline U select(bool c, U t, U f) {
  return f ^ ((f ^ t) & (U{0} - U{c}));
}
/// The bit layout of a type used for computation.
template <class W>
struct Layout;
template <>
struct Layout<double> {
  using Bits = uint64_t;
  static constexpr int kFraction = 52, kBias = 1023;
};
template <>
struct Layout<Quad> {
  using Bits = QuadBits;
  static constexpr int kFraction = 112, kBias = 16383;
};

inline double select(bool c, double t, double f) {
  return std::bit_cast<double>(select(c, std::bit_cast<uint64_t>(t), std::bit_cast<uint64_t>(f)));
}

template <unsigned E, unsigned M>
struct Format {
  static_assert(3 <= E && E <= 11 && 2 <= M && M <= 52, "no such format");
  static constexpr bool kSingle = E == 8 && M == 23, kDouble = E == 11 && M == 52;
  using Bits = std::conditional_t<(1 + E + M <= 32), uint32_t, uint64_t>;
  using Native = std::conditional_t<kSingle, float, double>;
  /// The type in which rounding before the rounding to the format is innocuous.
  using Wide = std::conditional_t<kDouble || (E <= 10 && M <= 24), double, Quad>;
  static constexpr Bits kSign = Bits{1} << (E + M), kMag = kSign - 1, kFrac = (Bits{1} << M) - 1;
  static constexpr Bits kInf = kMag & ~kFrac, kQuiet = Bits{1} << (M - 1), kNan = kInf | kQuiet;
  static constexpr int kBias = (1 << (E - 1)) - 1, kEmin = 1 - kBias;
  static unsigned is_nan(Bits a) { return (a & kMag) > kInf; }
  static unsigned is_snan(Bits a) { return is_nan(a) & unsigned{(a & kQuiet) == 0}; }
  static unsigned is_inf(Bits a) { return (a & kMag) == kInf; }
  static unsigned is_zero(Bits a) { return (a & kMag) == 0; }
};

template <class W = double>
constexpr W exp2_const(int e) {
  using L = Layout<W>;
  return std::bit_cast<W>(typename L::Bits(e + L::kBias) << L::kFraction);
}

/// The exact value of a word, including NaN.
template <unsigned E, unsigned M>
inline double decode(typename Format<E, M>::Bits a) {
  using F = Format<E, M>;
  if constexpr (F::kSingle) {
    return double(std::bit_cast<float>(a));
  } else if constexpr (F::kDouble) {
    return std::bit_cast<double>(a);
  } else {
    // Read as a double with the small format's exponent, then scale. This is exact, and it
    // normalises subnormals.
    const uint64_t mag = uint64_t(a & F::kMag) << (52 - M);
    const double scaled = std::bit_cast<double>(mag) * exp2_const(1023 - F::kBias);
    const double special = std::bit_cast<double>(mag | (uint64_t{2047} << 52));
    const double v = select((a & F::kMag) >= F::kInf, special, scaled);
    return std::bit_cast<double>(std::bit_cast<uint64_t>(v) | uint64_t((a & F::kSign) != 0) << 63);
  }
}

/// A number rounded to the format, to nearest even. NaN becomes the canonical NaN.
template <unsigned E, unsigned M, class W>
inline typename Format<E, M>::Bits encode(W x) {
  using F = Format<E, M>;
  using Bits = typename F::Bits;
  if constexpr (F::kSingle) {
    const Bits r = std::bit_cast<Bits>(float(x));
    return select<Bits>(x != x, F::kNan, r);
  } else if constexpr (F::kDouble) {
    return select<Bits>(x != x, F::kNan, std::bit_cast<Bits>(x));
  } else {
    using L = Layout<W>;
    using U = typename L::Bits;
    constexpr int kDrop = L::kFraction - int(M), kTop = int(sizeof(U)) * 8 - 1;
    constexpr U kInfinity = (~U{0} >> (L::kFraction + 1)) << L::kFraction;
    const U u = std::bit_cast<U>(x), mag = u & (~U{0} >> 1);
    const U odd = (mag >> kDrop) & 1;
    const U normal =
        ((mag + ((U{1} << (kDrop - 1)) - 1) + odd) >> kDrop) - (U(L::kBias - F::kBias) << M);
    // Below the normal range, adding a constant with the subnormal unit makes the FPU round at that
    // unit.
    constexpr W kMagic = exp2_const<W>(F::kEmin - int(M) + L::kFraction);
    const U sub = std::bit_cast<U>(std::bit_cast<W>(mag) + kMagic) - std::bit_cast<U>(kMagic);
    U r = select(mag < std::bit_cast<U>(exp2_const<W>(F::kEmin)), sub, normal);
    r = select(mag >= std::bit_cast<U>(exp2_const<W>(F::kBias + 1)), U{F::kInf}, r);
    r = select(r > F::kInf, U{F::kInf}, r);
    r |= (u >> kTop) << (E + M);
    return Bits(select(mag > kInfinity, U{F::kNan}, r));
  }
}

struct Add {
  template <class T>
  static T of(T a, T b) {
    return a + b;
  }
};
struct Sub {
  template <class T>
  static T of(T a, T b) {
    return a - b;
  }
};
struct Mul {
  template <class T>
  static T of(T a, T b) {
    return a * b;
  }
};
struct Div {
  template <class T>
  static T of(T a, T b) {
    return a / b;
  }
};
struct Sqrt {
  template <class T>
  static T of(T a, T) {
    return std::sqrt(a);
  }
  static Quad of(Quad a, Quad) { return sqrtf128(a); }
};

template <class Op, unsigned E, unsigned M, bool Canonical = true,
          class Bits = typename Format<E, M>::Bits>
inline Bits binary(Bits a, Bits b) {
  using F = Format<E, M>;
  if constexpr (F::kSingle || F::kDouble) {
    using T = typename F::Native;
    const T r = Op::of(std::bit_cast<T>(a), std::bit_cast<T>(b));
    if constexpr (!Canonical)
      return std::bit_cast<Bits>(r);
    else
      return select<Bits>(r != r, F::kNan, std::bit_cast<Bits>(r));
  } else {
    using W = typename F::Wide;
    return encode<E, M>(Op::of(W(decode<E, M>(a)), W(decode<E, M>(b))));
  }
}

/// Rounding flags of a result r with the value x before rounding. x itself must not have been
/// rounded across a boundary.
template <unsigned E, unsigned M, class W, class Bits = typename Format<E, M>::Bits>
inline uint32_t rounding_flags(Bits r, W x, bool inexact) {
  using F = Format<E, M>;
  // Tiny after rounding: below the smallest normal even when rounded to full precision.
  constexpr W kTiny = exp2_const<W>(F::kEmin) * (1 - exp2_const<W>(-int(M) - 2));
  const uint32_t overflow = F::is_inf(r), tiny = (x < 0 ? -x : x) < kTiny;
  const uint32_t nx = uint32_t{inexact} | overflow;
  return nx * kInexact | (nx & tiny) * kUnderflow | overflow * kOverflow;
}

/// Flags of fp64 come from the FPU, which detects tininess after rounding on x86.
template <class Op>
inline uint32_t fpu_flags(double a, double b) {
  std::feclearexcept(FE_ALL_EXCEPT);
  volatile double x = a, y = b;
  volatile double r = Op::of(double(x), double(y));
  (void)r;
  const int f = std::fetestexcept(FE_ALL_EXCEPT);
  return uint32_t((f & FE_INEXACT) != 0) * kInexact |
         uint32_t((f & FE_UNDERFLOW) != 0) * kUnderflow |
         uint32_t((f & FE_OVERFLOW) != 0) * kOverflow |
         uint32_t((f & FE_DIVBYZERO) != 0) * kDivideByZero |
         uint32_t((f & FE_INVALID) != 0) * kInvalid;
}

template <class Op, unsigned E, unsigned M, class Bits = typename Format<E, M>::Bits>
inline uint32_t binary_flags(Bits a, Bits b) {
  using F = Format<E, M>;
  if constexpr (F::kDouble) {
    return fpu_flags<Op>(std::bit_cast<double>(a), std::bit_cast<double>(b));
  } else {
    const Bits r = binary<Op, E, M>(a, b);
    using W = typename F::Wide;
    const W x = decode<E, M>(a), y = decode<E, M>(b), z = Op::of(x, y), w = decode<E, M>(r);
    unsigned inexact;
    if constexpr (std::is_same_v<Op, Add> || std::is_same_v<Op, Sub>) {
      const W t = std::is_same_v<Op, Sub> ? -y : y, v = z - x;
      inexact = unsigned{w != z} | unsigned{(x - (z - v)) + (t - v) !=
                                            0};  // Knuth's two-sum: the double sum may also round
    } else if constexpr (std::is_same_v<Op, Mul>) {
      inexact = w != z;  // the product of two significands fits a double
    } else if constexpr (std::is_same_v<Op, Div>) {
      inexact = w * y != x;
    } else {
      inexact = w * w != x;
    }
    const unsigned nan_in = F::is_nan(a) | F::is_nan(b), inf_in = F::is_inf(a) | F::is_inf(b);
    const unsigned by_zero =
        unsigned{std::is_same_v<Op, Div>} & F::is_zero(b) & ~F::is_zero(a) & ~(inf_in | nan_in);
    const unsigned invalid = F::is_snan(a) | F::is_snan(b) | (~nan_in & F::is_nan(r));
    const uint32_t rounding = rounding_flags<E, M>(r, z, inexact != 0);
    const unsigned finite = 1 & ~(nan_in | inf_in | by_zero | F::is_nan(r));
    return rounding * finite | by_zero * kDivideByZero | invalid * kInvalid;
  }
}

/// minimumNumber and maximumNumber: a number is preferred to a NaN, and -0 is below +0.
template <bool Max, unsigned E, unsigned M, class Bits = typename Format<E, M>::Bits>
inline Bits minmax(Bits a, Bits b) {
  using F = Format<E, M>;
  using Signed = std::make_signed_t<Bits>;
  const Bits a_sign = Bits{0} - ((a >> (E + M)) & 1), b_sign = Bits{0} - ((b >> (E + M)) & 1);
  const bool less = Signed((a & F::kMag) ^ a_sign) < Signed((b & F::kMag) ^ b_sign);
  const Bits r = select<Bits>(((unsigned{less != Max} | F::is_nan(b)) & ~F::is_nan(a)) != 0, a, b);
  return select<Bits>((F::is_nan(a) & F::is_nan(b)) != 0, F::kNan, r);
}

/// One lane's operation. Comparisons return all ones or all zeros; they are false if an operand is
/// NaN.
template <unsigned C, unsigned E, unsigned M, bool Canonical = true,
          class Bits = typename Format<E, M>::Bits>
inline Bits compute(std::type_identity_t<Bits> a, std::type_identity_t<Bits> b) {
  using T = typename Format<E, M>::Native;
  if constexpr (is(C, FpOp::kAdd))
    return binary<Add, E, M, Canonical>(a, b);
  else if constexpr (is(C, FpOp::kSub))
    return binary<Sub, E, M, Canonical>(a, b);
  else if constexpr (is(C, FpOp::kMul))
    return binary<Mul, E, M, Canonical>(a, b);
  else if constexpr (is(C, FpOp::kDiv))
    return binary<Div, E, M, Canonical>(a, b);
  else if constexpr (is(C, FpOp::kSqrt))
    return binary<Sqrt, E, M, Canonical>(a, a);
  else if constexpr (is(C, FpOp::kLt))
    return Bits{0} - Bits(T(decode<E, M>(a)) < T(decode<E, M>(b)));
  else if constexpr (is(C, FpOp::kLe))
    return Bits{0} - Bits(T(decode<E, M>(a)) <= T(decode<E, M>(b)));
  else if constexpr (is(C, FpOp::kEq))
    return Bits{0} - Bits(T(decode<E, M>(a)) == T(decode<E, M>(b)));
  else
    return minmax<is(C, FpOp::kMax), E, M>(a, b);
}

/// The same as an out-of-line call. In a format without native support an operation takes a hundred
/// instructions, so inlining it everywhere would take very long to compile.
template <unsigned C, unsigned E, unsigned M, bool Canonical, class Bits>
[[gnu::noinline]] Bits call(Bits a, Bits b) {
  return compute<C, E, M, Canonical, Bits>(a, b);
}

template <unsigned C, unsigned E, unsigned M, bool Canonical = true,
          class Bits = typename Format<E, M>::Bits>
inline Bits op(std::type_identity_t<Bits> a, std::type_identity_t<Bits> b) {
  if constexpr (Format<E, M>::kSingle || Format<E, M>::kDouble)
    return compute<C, E, M, Canonical, Bits>(a, b);
  else
    return call<C, E, M, Canonical, Bits>(a, b);
}

/// The operation's flags. lt and le are signalling comparisons; eq is quiet.
template <unsigned C, unsigned E, unsigned M, class Bits = typename Format<E, M>::Bits>
inline Bits flags(std::type_identity_t<Bits> a, std::type_identity_t<Bits> b) {
  using F = Format<E, M>;
  if constexpr (is(C, FpOp::kAdd))
    return binary_flags<Add, E, M>(a, b);
  else if constexpr (is(C, FpOp::kSub))
    return binary_flags<Sub, E, M>(a, b);
  else if constexpr (is(C, FpOp::kMul))
    return binary_flags<Mul, E, M>(a, b);
  else if constexpr (is(C, FpOp::kDiv))
    return binary_flags<Div, E, M>(a, b);
  else if constexpr (is(C, FpOp::kSqrt))
    return binary_flags<Sqrt, E, M>(a, a);
  else if constexpr (C >= code(FpOp::kEq))
    return Bits(F::is_snan(a) | F::is_snan(b)) * kInvalid;
  else
    return Bits(F::is_nan(a) | F::is_nan(b)) * kInvalid;
}

/// rtl/fp/fp_sign.sv.
template <unsigned C, unsigned E, unsigned M, class Bits>
inline Bits sign(Bits a, Bits b = Bits{}) {
  constexpr auto kSign = Format<E, M>::kSign;
  if constexpr (is(C, Sign::kAbs))
    return a & ~kSign;
  else if constexpr (is(C, Sign::kNeg))
    return a ^ kSign;
  else if constexpr (is(C, Sign::kCopy))
    return (a & ~kSign) | (b & kSign);
  else
    return a ^ (b & kSign);
}

/// The sign bit as a mask: all ones or all zeros.
template <unsigned E, unsigned M, class Bits>
inline Bits negative(Bits a) {
  return Bits{} - ((a >> (E + M)) & 1);
}

/// A condition as a mask: all ones or all zeros, of a word or of each word of a vector.
template <class Bits, class Condition>
inline Bits mask(Condition c) {
  if constexpr (std::is_same_v<Condition, bool>)
    return Bits{} - Bits(c);
  else
    return (Bits)c;
}

/// rtl/fp/fp_class.sv.
template <unsigned C, unsigned E, unsigned M, class Bits>
inline Bits classify(Bits a) {
  using F = Format<E, M>;
  const Bits mag = a & F::kMag;
  if constexpr (is(C, Class::kFinite))
    return mask<Bits>(mag < F::kInf);
  else if constexpr (is(C, Class::kNan))
    return mask<Bits>(mag > F::kInf);
  else if constexpr (is(C, Class::kPositive))
    return mask<Bits>(a != 0) & mask<Bits>(a <= F::kInf);
  else
    return mask<Bits>(mag != 0);
}

/// rtl/fp/fp_finite.sv: whether all three are finite; one comparison, of the largest magnitude.
template <unsigned E, unsigned M, class Bits>
inline Bits all_finite(Bits a, Bits b, Bits c) {
  using F = Format<E, M>;
  const Bits x = a & F::kMag, y = b & F::kMag, z = c & F::kMag;
  const Bits xy = select<Bits>(x > y, x, y);
  return mask<Bits>(select<Bits>(xy > z, xy, z) < F::kInf);
}

/// rtl/fp/fp_range.sv: whether a word's magnitude lies between two powers of two. With Signed it
/// compares the bits including the sign. The exponents are given as in a word.
template <unsigned E, unsigned M, bool Signed, unsigned Least, unsigned Most, class Bits>
inline Bits within(Bits a) {
  const Bits x = Signed ? a : a & Format<E, M>::kMag;
  return mask<Bits>(x >= (Least << M)) & mask<Bits>(x <= (Most << M));
}

/// rtl/fp/fp_exponent.sv: kMax, kMove.
template <unsigned C, unsigned E, unsigned M, bool Keep, class Bits>
inline Bits exponent(Bits a, Bits b) {
  using F = Format<E, M>;
  if constexpr (is(C, Exponent::kMax)) {
    const Bits x = a & F::kInf, y = b & F::kInf, more = mask<Bits>(x > y);
    return (x & more) | (y & ~more);
  } else {
    const Bits x = a & F::kMag, moved = x + b, below = (x - (1u << M)) | (moved - (1u << M));
    const Bits gone = Bits{} - (below >> 31);
    const Bits least = Keep ? (Bits{} + (1u << M)) & mask<Bits>(x >= (1u << M)) : Bits{};
    return (moved & F::kMag & ~gone) | (least & gone) | (a & F::kSign);
  }
}
/// Operations kDown and kUp. k is the exponent of a, at least Least as stored.
template <unsigned C, unsigned E, unsigned M, unsigned Least, class Bits>
inline Bits shift(Bits a) {
  using F = Format<E, M>;
  const Bits k = exponent<code(Exponent::kMax), E, M, false, Bits>(a, Bits{} + (Least << M));
  const Bits one = Bits{} + (unsigned(F::kBias) << M);
  return is(C, Exponent::kDown) ? one - k : k - one;
}

/// formats_pkg::power_of_two: the word of 2^e, which may be subnormal.
template <unsigned E, unsigned M, class Bits>
constexpr Bits power_of_two(int e) {
  const int biased = (1 << (E - 1)) - 1 + e, down = biased + int(M) - 1;
  return biased > 0 ? Bits(biased) << M : down >= 0 ? Bits{1} << down : Bits{};
}

/// rtl/pipes/ray_box.sv and triangle_bounds.sv for one lane. The caller calls it only if a lane is
/// hit, which is rare. v: the triangle's words, three per vertex.
template <unsigned E, unsigned M, class Bits>
[[gnu::noinline]] Bits in_box(Bits met, const Bits (&td)[3], const Bits (&p)[3],
                              const Bits (&v)[9]) {
  using F = Format<E, M>;
  const auto add = [](Bits a, Bits b) { return op<code(FpOp::kAdd), E, M, true, Bits>(a, b); };
  const auto sub = [](Bits a, Bits b) { return op<code(FpOp::kSub), E, M, true, Bits>(a, b); };
  const auto mul = [](Bits a, Bits b) { return op<code(FpOp::kMul), E, M, true, Bits>(a, b); };
  const auto min = [](Bits a, Bits b) { return op<code(FpOp::kMin), E, M, true, Bits>(a, b); };
  const auto max = [](Bits a, Bits b) { return op<code(FpOp::kMax), E, M, true, Bits>(a, b); };
  const auto abs = [](Bits a) { return sign<code(Sign::kAbs), E, M, Bits>(a); };
  const auto two_to = [](int e) { return power_of_two<E, M, Bits>(e); };
  constexpr int m = M;
  Bits centre[3], size[3], reach[3], e1[3], e2[3];
  for (int k = 0; k < 3; ++k) {
    const Bits low = min(min(v[k], v[3 + k]), v[6 + k]), high = max(max(v[k], v[3 + k]), v[6 + k]);
    centre[k] = mul(add(low, high), two_to(-1));
    size[k] = sub(high, centre[k]);
    reach[k] = add(abs(centre[k]), size[k]);
    e1[k] = sub(v[3 + k], v[k]);
    e2[k] = sub(v[6 + k], v[k]);
  }
  const Bits world = mul(max(max(reach[0], reach[1]), reach[2]), two_to(2 - m));
  Bits flat = ~Bits{};
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const Bits x = mul(e1[i], e2[j]), y = mul(e1[j], e2[i]);
    const Bits noise = mul(add(add(abs(x), Bits{1} << M), abs(y)), two_to(1 - m));
    flat &= op<code(FpOp::kLe), E, M, true, Bits>(abs(sub(x, y)), noise);
  }
  const Bits scaled = mul(add(add(abs(td[0]), abs(td[1])), abs(td[2])), two_to(5 - m));
  const Bits margin = scaled & classify<code(Class::kFinite), E, M, Bits>(scaled);
  Bits accepted = met;
  for (int k = 0; k < 3; ++k) {
    const Bits half = select<Bits>(flat != 0, F::kInf | F::kSign, add(size[k], world));
    const Bits out = sub(abs(sub(p[k], centre[k])), half);
    accepted &= op<code(FpOp::kLt), E, M, true, Bits>(out, margin);
  }
  return accepted;
}
template <unsigned E, unsigned M, class Bits>
inline Bits in_box(Bits met, Bits td0, Bits td1, Bits td2, Bits p0, Bits p1, Bits p2, Bits v0,
                   Bits v1, Bits v2, Bits v3, Bits v4, Bits v5, Bits v6, Bits v7, Bits v8) {
  if (met == 0) return Bits{};
  return in_box<E, M, Bits>(met, {td0, td1, td2}, {p0, p1, p2},
                            {v0, v1, v2, v3, v4, v5, v6, v7, v8});
}

template <unsigned N>
using Word = std::conditional_t<N == 32, uint32_t, uint64_t>;

/// An integer as a number in the type used for computation. A double with more than 53 bits is
/// rounded to odd at a bit that leaves at least 43 bits. Rounding that to at most 25 bits is
/// innocuous.
template <unsigned N, bool Unsigned, class W>
inline W from_integer(Word<N> a) {
  const bool minus = !Unsigned && (a >> (N - 1)) != 0;
  const uint64_t mag = minus ? uint64_t(Word<N>(Word<N>{0} - a)) : uint64_t{a};
  const uint64_t odd = (mag & ~uint64_t{0x7ff}) | (uint64_t{(mag & 0x7ff) != 0} << 11);
  const W x = W(std::is_same_v<W, double> && (mag >> 53) != 0 ? odd : mag);
  return minus ? -x : x;
}

/// Conversions: format E, M to format P, Q; integer of P bits to E, M; E, M to integer of P bits.
/// For integers, Q has bit 0 for unsigned and bit 1 for truncate.
template <unsigned C, unsigned E, unsigned M, unsigned P, unsigned Q, class B>
inline auto convert(B a) {
  if constexpr (is(C, Convert::kFormat)) {
    return encode<P, Q>(typename Format<P, Q>::Wide(decode<E, M>(a)));
  } else if constexpr (is(C, Convert::kFromInt)) {
    if constexpr (Format<E, M>::kDouble && P == 64) {
      return encode<E, M>((Q & 1) != 0 ? double(uint64_t(a)) : double(int64_t(a)));
    } else {
      return encode<E, M>(from_integer<P, (Q & 1) != 0, typename Format<E, M>::Wide>(a));
    }
  } else {
    using Int = std::conditional_t<(Q & 1) != 0, Word<P>, std::make_signed_t<Word<P>>>;
    constexpr double kLimit = exp2_const(int(P) - 1 + int(Q & 1));  // first value that is too large
    constexpr double kLowest = (Q & 1) != 0 ? 0.0 : -kLimit;
    const double x = decode<E, M>(a), y = (Q & 2) != 0 ? std::trunc(x) : std::nearbyint(x);
    if (y >= kLowest && y < kLimit) return Word<P>(Int(y));
    return Word<P>(y < 0 ? std::numeric_limits<Int>::min() : std::numeric_limits<Int>::max());
  }
}

template <unsigned C, unsigned E, unsigned M, unsigned P, unsigned Q, class B>
inline uint32_t convert_flags(B a) {
  if constexpr (is(C, Convert::kFormat)) {
    const typename Format<P, Q>::Wide x = decode<E, M>(a);
    const auto r = encode<P, Q>(x);
    if ((Format<E, M>::is_nan(a) | Format<E, M>::is_inf(a)) != 0)
      return Format<E, M>::is_snan(a) * kInvalid;
    return P == 11 && Q == 52 ? 0 : rounding_flags<P, Q>(r, x, decode<P, Q>(r) != x);
  } else if constexpr (is(C, Convert::kFromInt)) {
    const auto x = from_integer<P, (Q & 1) != 0, typename Format<E, M>::Wide>(a);
    const auto r = convert<C, E, M, P, Q>(a);
    if constexpr (Format<E, M>::kDouble) {
      const uint64_t mag =
          (Q & 1) == 0 && (a >> (P - 1)) != 0 ? uint64_t(B(B{0} - a)) : uint64_t{a};
      return mag == 0 ? 0 : ((mag << std::countl_zero(mag)) & 0x7ff) != 0;
    }
    return rounding_flags<E, M>(r, x, decode<E, M>(r) != x) & ~kUnderflow;
  } else {
    const double x = decode<E, M>(a), y = (Q & 2) != 0 ? std::trunc(x) : std::nearbyint(x);
    constexpr double kLimit = exp2_const(int(P) - 1 + int(Q & 1));
    const bool fits = y >= ((Q & 1) != 0 ? 0.0 : -kLimit) && y < kLimit;
    return fits ? uint32_t(x != y) * kInexact : kInvalid;
  }
}

}  // namespace host_fp
