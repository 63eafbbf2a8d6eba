// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <bit>
#include <cmath>
#include <compare>
#include <cstdint>
#include <limits>
#include <ostream>
#include <type_traits>

namespace cde {

/// A software scalar: binary floating point with E exponent bits and M fraction bits in IEEE 754
/// encoding, with subnormals, infinities and one NaN. E is 3..10, M is 2..24. For the two formats
/// of the processor use float and double.
///
/// Every operation rounds once to nearest, ties to even. It is computed in binary64 and rounded
/// again. That is innocuous because 53 >= 2 (M + 1) + 2 (Figueroa, "When is double rounding
/// innocuous?", SIGNUM 1995). A NaN result is the canonical one: positive, quiet, no payload. The
/// processor must round to nearest and keep subnormals, its default.
template <int E, int M>
class Fp {
  static_assert(3 <= E && E <= 10 && 2 <= M && M <= 24, "double rounding would show");

 public:
  using Bits =
      std::conditional_t<(1 + E + M <= 16), std::uint16_t,
                         std::conditional_t<(1 + E + M <= 32), std::uint32_t, std::uint64_t>>;
  static constexpr int kExponentBits = E, kFractionBits = M;
  static constexpr Bits kSign = Bits{1} << (E + M), kMagnitude = kSign - 1;
  static constexpr Bits kInfinity = ((Bits{1} << E) - 1) << M;
  static constexpr Bits kNan = kInfinity | (Bits{1} << (M - 1));
  static constexpr int kBias = (1 << (E - 1)) - 1, kEmin = 1 - kBias;

  constexpr Fp() = default;
  /// Rounded to nearest even.
  explicit constexpr Fp(double value) : bits_(round(value)) {}
  explicit constexpr Fp(float value) : Fp(static_cast<double>(value)) {}
  explicit constexpr Fp(int value) : Fp(static_cast<double>(value)) {}
  template <int E2, int M2>
  requires(E2 != E || M2 != M) explicit constexpr Fp(Fp<E2, M2> value)
      : Fp(static_cast<double>(value)) {}

  [[nodiscard]] static constexpr Fp from_bits(Bits bits) {
    Fp x;
    x.bits_ = bits;
    return x;
  }
  /// The word, in the low 1 + E + M bits.
  [[nodiscard]] constexpr Bits bits() const { return bits_; }

  /// Exact.
  explicit constexpr operator double() const {
    const std::uint64_t sign = std::uint64_t{(bits_ & kSign) != 0} << 63;
    const std::uint64_t magnitude = std::uint64_t{static_cast<Bits>(bits_ & kMagnitude)}
                                    << (52 - M);
    if ((bits_ & kMagnitude) >= kInfinity)
      return std::bit_cast<double>(sign | (std::uint64_t{2047} << 52) | magnitude);
    // Read as a double with the small format's exponent, then scaled: exact, and subnormals
    // normalise themselves.
    return std::bit_cast<double>(sign | magnitude) * power_of_two(1023 - kBias);
  }
  /// Rounded once, exact if the format is no wider.
  explicit constexpr operator float() const { return static_cast<float>(double(*this)); }
  explicit constexpr operator int() const { return static_cast<int>(double(*this)); }

  friend constexpr Fp operator+(Fp a, Fp b) { return Fp(double(a) + double(b)); }
  friend constexpr Fp operator-(Fp a, Fp b) { return Fp(double(a) - double(b)); }
  friend constexpr Fp operator*(Fp a, Fp b) { return Fp(double(a) * double(b)); }
  friend constexpr Fp operator/(Fp a, Fp b) { return Fp(double(a) / double(b)); }
  constexpr Fp& operator+=(Fp b) { return *this = *this + b; }
  constexpr Fp& operator-=(Fp b) { return *this = *this - b; }
  constexpr Fp& operator*=(Fp b) { return *this = *this * b; }
  constexpr Fp& operator/=(Fp b) { return *this = *this / b; }
  /// Flips the sign bit, also of zeros and NaN.
  constexpr Fp operator-() const { return from_bits(bits_ ^ kSign); }
  constexpr Fp operator+() const { return *this; }

  /// Comparisons of values: false when an operand is NaN, but != ; the two zeros are equal.
  friend constexpr bool operator==(Fp a, Fp b) { return double(a) == double(b); }
  friend constexpr auto operator<=>(Fp a, Fp b) { return double(a) <=> double(b); }

  friend constexpr Fp abs(Fp a) { return from_bits(a.bits_ & kMagnitude); }
  friend Fp sqrt(Fp a) { return Fp(std::sqrt(double(a))); }
  friend constexpr bool isnan(Fp a) { return (a.bits_ & kMagnitude) > kInfinity; }
  friend constexpr bool isinf(Fp a) { return (a.bits_ & kMagnitude) == kInfinity; }
  friend constexpr bool isfinite(Fp a) { return (a.bits_ & kMagnitude) < kInfinity; }
  friend constexpr bool signbit(Fp a) { return (a.bits_ & kSign) != 0; }
  friend std::ostream& operator<<(std::ostream& out, Fp a) { return out << double(a); }

 private:
  static constexpr double power_of_two(int e) {
    return std::bit_cast<double>(static_cast<std::uint64_t>(e + 1023) << 52);
  }

  static constexpr Bits round(double x) {
    const auto word = std::bit_cast<std::uint64_t>(x);
    const std::uint64_t magnitude = word & ~(std::uint64_t{1} << 63);
    const double size = std::bit_cast<double>(magnitude);
    if (x != x) return kNan;
    const auto sign = static_cast<Bits>((word >> 63) << (E + M));
    if (size < power_of_two(kEmin)) {
      // The processor rounds at the subnormal unit when a constant with that unit is added.
      constexpr double kMagic = power_of_two(kEmin - M + 52);
      const std::uint64_t steps =
          std::bit_cast<std::uint64_t>(size + kMagic) - std::bit_cast<std::uint64_t>(kMagic);
      return sign | static_cast<Bits>(steps);
    }
    if (size >= power_of_two(kBias + 1)) return sign | kInfinity;
    constexpr int kDrop = 52 - M;
    const std::uint64_t odd = (magnitude >> kDrop) & 1;
    const std::uint64_t half_below = (std::uint64_t{1} << (kDrop - 1)) - 1;
    // A carry out of the fraction goes into the exponent, from the largest one to infinity.
    return sign | static_cast<Bits>(((magnitude + half_below + odd) >> kDrop) -
                                    (std::uint64_t{1023 - kBias} << M));
  }

  Bits bits_ = 0;
};

using Fp16 = Fp<5, 10>;
using Bf16 = Fp<8, 7>;
using Tf32 = Fp<8, 10>;
using Fp24 = Fp<7, 16>;
using E4m3 = Fp<4, 3>;  ///< with infinities, unlike the OCP format of that name
using E3m2 = Fp<3, 2>;  ///< likewise

}  // namespace cde

template <int E, int M>
class std::numeric_limits<cde::Fp<E, M>> {
  using T = cde::Fp<E, M>;
  using Bits = typename T::Bits;

 public:
  static constexpr bool is_specialized = true, is_signed = true, is_integer = false,
                        is_exact = false, has_infinity = true, has_quiet_NaN = true,
                        has_signaling_NaN = true, is_iec559 = true, is_bounded = true,
                        is_modulo = false, traps = false, tinyness_before = false;
  static constexpr std::float_denorm_style has_denorm = std::denorm_present;
  static constexpr bool has_denorm_loss = false;
  static constexpr std::float_round_style round_style = std::round_to_nearest;
  static constexpr int digits = M + 1, radix = 2, min_exponent = T::kEmin + 1,
                       max_exponent = T::kBias + 1;
  static constexpr int digits10 = static_cast<int>(M * 0.30103),
                       max_digits10 = static_cast<int>((M + 1) * 0.30103 + 2);
  static constexpr int min_exponent10 = static_cast<int>(T::kEmin * 0.30103),
                       max_exponent10 = static_cast<int>((T::kBias + 1) * 0.30103);
  static constexpr T min() { return T::from_bits(Bits{1} << M); }
  static constexpr T max() { return T::from_bits(T::kInfinity - 1); }
  static constexpr T lowest() { return T::from_bits((T::kInfinity - 1) | T::kSign); }
  static constexpr T denorm_min() { return T::from_bits(1); }
  /// 2^-M, also where that is subnormal.
  static constexpr T epsilon() {
    return T(std::bit_cast<double>(static_cast<std::uint64_t>(1023 - M) << 52));
  }
  static constexpr T round_error() { return T(0.5); }
  static constexpr T infinity() { return T::from_bits(T::kInfinity); }
  static constexpr T quiet_NaN() { return T::from_bits(T::kNan); }
  static constexpr T signaling_NaN() { return T::from_bits(T::kInfinity | 1); }
};

/// @cond
template <int E, int M>
struct Eigen::NumTraits<cde::Fp<E, M>> : Eigen::GenericNumTraits<cde::Fp<E, M>> {
  using T = cde::Fp<E, M>;
  using Real = T;
  using NonInteger = T;
  using Nested = T;
  using Literal = double;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 0,
    ReadCost = 1,
    AddCost = 8,
    MulCost = 8
  };
  static constexpr T dummy_precision() { return T(4) * std::numeric_limits<T>::epsilon(); }
};
/// @endcond
