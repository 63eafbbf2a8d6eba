// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>

namespace cde::oracle {

/// A binary floating-point format of IEEE encoding, binary32 by default. Values are held in
/// binary64. Up to 11 exponent bits and 52 fraction bits.
struct Format {
  int exp_bits = 8, man_bits = 23;

  /// Unit roundoff.
  [[nodiscard]] double u() const { return std::ldexp(1, -1 - man_bits); }
  /// Exponent of the smallest normal number.
  [[nodiscard]] int emin() const { return 2 - (1 << (exp_bits - 1)); }
  [[nodiscard]] double largest() const { return std::ldexp(2 - 2 * u(), 1 - emin()); }
  /// Exponent of the last place of x.
  [[nodiscard]] int last_place(double x) const {
    return (x == 0 ? emin() : std::max(std::ilogb(x), emin())) - man_bits;
  }
  /// Nearest value, ties to even; infinite beyond the range.
  [[nodiscard]] double round(double x) const {
    if (!std::isfinite(x)) return x;
    const int last = last_place(x);
    const double r = std::ldexp(std::nearbyint(std::ldexp(x, -last)), last);
    return std::abs(r) > largest() ? std::copysign(INFINITY, x) : r;
  }
  /// The next value after x towards `to`. x must be finite and exact in the format.
  [[nodiscard]] double next(double x, double to) const {
    const double step = std::ldexp(to > x ? 1.0 : -1.0, last_place(x));
    const double half = x + step / 2;  // a value only below a power of two
    return half != x && round(half) == half ? half : round(x + step);
  }
};

}  // namespace cde::oracle
