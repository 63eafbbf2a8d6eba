// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Cases of the oracle's generators at other sizes: their lengths times a power of two.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "cde/fp/fp_format.hpp"
#include "cde/geometry/length_range.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/oracle/cases.hpp"

namespace cde::testing {

/// The kind of a word in a slot.
enum class Kind { kLength, kDirection, kInterval, kPure };

inline Kind kind(Shape shape, std::size_t word) {
  switch (shape) {
    case Shape::kRay:
      return word < 3 ? Kind::kLength : word < 6 ? Kind::kDirection : Kind::kInterval;
    case Shape::kPlane:
      return word < 3 ? Kind::kPure : Kind::kLength;
    case Shape::kCylinder:
      return word >= 3 && word < 6 ? Kind::kPure : Kind::kLength;
    case Shape::kObb:
      return word >= 6 ? Kind::kPure : Kind::kLength;
    default:
      return Kind::kLength;
  }
}

/// The words of a case with lengths times 2^j and the direction times 2^m; empty if a scaled word
/// is not an exact normal number.
inline bool scaled_words(const std::vector<double>& words, Shape shape, FpFormat format, int j,
                         int m, std::vector<std::uint64_t>& to) {
  const int emin = 2 - (1 << (format.exp_bits - 1));
  for (std::size_t k = 0; k < words.size(); ++k) {
    const Kind of = kind(shape, k);
    const int by = of == Kind::kLength      ? j
                   : of == Kind::kDirection ? m
                   : of == Kind::kInterval  ? j - m
                                            : 0;
    const double x = std::ldexp(words[k], by);
    const double size = std::abs(x);
    if (of != Kind::kPure && size != 0 && std::isfinite(x) &&
        (size < std::ldexp(1, emin) || size >= std::ldexp(1, -emin + 1) ||
         std::abs(words[k]) < std::ldexp(1, emin)))
      return false;
    to.push_back(format.encode(x));
  }
  return true;
}

/// Radius, half height, half extents.
inline bool is_size(Shape shape, std::size_t k) {
  return (shape == Shape::kSphere && k == 3) || (shape == Shape::kCylinder && k >= 6) ||
         (shape == Shape::kObb && k >= 3 && k < 6);
}

/// The exponents by which a pair's lengths (of === kDirection: its direction) can be scaled within
/// the range.
inline LengthRange scale_range(const oracle::Case& c, Shape a, Shape b, Kind of,
                               LengthRange range) {
  double largest = 0, least_size = std::ldexp(1, 900);
  const auto look = [&](Shape shape, const std::vector<double>& words) {
    for (std::size_t k = 0; k < words.size(); ++k) {
      if (kind(shape, k) != of) continue;
      largest = std::max(largest, std::abs(words[k]));
      if (is_size(shape, k)) least_size = std::min(least_size, words[k]);
    }
  };
  look(a, c.a);
  look(b, c.b);
  least_size = std::min(least_size, largest);
  int up = 0, down = 0;
  while (std::ldexp(largest, up + 1) <= std::ldexp(1, range.high)) ++up;
  while (std::ldexp(largest, up) > std::ldexp(1, range.high)) --up;
  while (std::ldexp(least_size, down) < std::ldexp(1, range.low)) ++down;
  while (std::ldexp(least_size, down - 1) >= std::ldexp(1, range.low)) --down;
  return {down, up};
}

/// The exponents by which a ray's solid can be scaled against the ray's direction, within a range
/// of their ratio (LengthRange::ray_ratio).
inline LengthRange scale_range_apart(const oracle::Case& c, Shape target, LengthRange range) {
  double largest = 0, least_size = std::ldexp(1, 900), direction = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    largest = std::max(largest, std::abs(c.a[k]));
    direction = std::max(direction, std::abs(c.a[3 + k]));
  }
  for (std::size_t k = 0; k < c.b.size(); ++k) {
    if (kind(target, k) != Kind::kLength) continue;
    largest = std::max(largest, std::abs(c.b[k]));
    if (is_size(target, k)) least_size = std::min(least_size, c.b[k]);
  }
  // Up to 2^ilogb(x) <= |x| < 2^(ilogb(x) + 1).
  return {range.low - std::ilogb(least_size) + std::ilogb(direction) + 1,
          range.high - std::ilogb(largest) + std::ilogb(direction) - 1};
}

/// The lengths over which a pair's answers scale exactly: all allowed lengths. For rays in formats
/// without scaling it is half as many exponents. There, lengths are multiplied unscaled, and a
/// cancelled product of three must still be a normal number.
inline LengthRange exact_range(Pair pair, FpFormat format) {
  const LengthRange all = LengthRange::of(format.exp_bits, format.man_bits);
  return is_solid(pair) || format.exp_bits < 8 ? all : LengthRange{all.low / 2, all.high / 2};
}

}  // namespace cde::testing
