// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "cde/bvh/node.hpp"
#include "cde/contract/pairs.hpp"
#include "cde/reference/pipes/root_bounds.hpp"

/// @file
/// A ray and the eight boxes of a node in whole numbers (rtl/bvh/node_boxes_int.sv), bit-exact.
/// docs/background/bvh_integer.md has the proof. Solids are in solid_node.hpp.
///
/// Three subtractions and three products per node are in fp32. Everything after them is a whole
/// number of time steps: T = T_ref + n 2^E. T has the unit of the ray's interval, that is, lengths
/// of d. Bounds are rounded outwards: near down, far up.
namespace cde::reference {

/// Bits of the whole numbers.
struct IntegerFormat {
  /// Bits of the T of one byte step, the factor of each product: 12 to 16.
  int unit_bits = 16;
  /// The shared step 2^E is 2^-step_bits of the smallest unit, rounded to a power of two: 2 to 6.
  int step_bits = 6;
};

/// A ray as nodes use it.
struct IntegerRay {
  Vector<float> o;        ///< origin
  Vector<float> inverse;  ///< 1 / d, with components of d of at least 2^-80
  Vector<float>
      margin;  ///< T in which the ray moves by the margin M' along the axis; may be infinite
};

/// M' = 208 u R + 13 u W, which is 13/16 of M = 256 u R + 16 u W. Here u is 2^-24, R the largest
/// distance along an axis from o to the root's box, and W the largest |coordinate| of that box. The
/// margin M' is infinite for rays that meet spheres if R is not between 2^-42 and 2^37 times the
/// largest component of d. `sixteenths` is for tests.
/// Once per ray: 5 mul, 3 div, 1 add, 6 sub, 8 max. For spheres 2 mul, 2 cmp, 2 max more.
[[nodiscard]] IntegerRay integer_ray(const Vector<float>& o, const Vector<float>& d,
                                     const RootBounds<float>& root, Shape leaf = Shape::kTriangle,
                                     int sixteenths = 13);

/// The shared steps of a node for a ray: T = reference + n 2^exponent.
struct TimeScale {
  float reference;  ///< T_ref
  int exponent;     ///< E
  bool operator==(const TimeScale&) const = default;
};

/// The children of a node that a ray enters.
struct IntegerVisit {
  /// Keys have 12 bits. The least key is visited first. Key 0 is never culled.
  static constexpr int kKeyBits = 12;

  TimeScale scale;
  unsigned entered = 0;  ///< bit i: the ray enters child i
  /// Per child, near T - T_ref, or T_ref - far T when searching downwards, in quarters of
  /// 2^(E + step_bits). It is rounded down, limited to 12 bits, then increased by 2^11.
  std::array<std::uint16_t, bvh::Node::kChildren> keys{};
};

/// Tests all boxes. A child is entered unless its near T is above its far T or above `limit`, or
/// its far T is below `floor`. Both limits may be infinite.
[[nodiscard]] IntegerVisit integer_visit(const IntegerRay& ray, const bvh::Node& node, float floor,
                                         float limit, bool farthest,
                                         const IntegerFormat& format = {});

/// The largest key that counts, 0 to 2^12 - 1, for the best T so far. A child with a larger key has
/// no hit with a smaller T, or no hit with a larger T if `farthest`.
[[nodiscard]] unsigned key_limit(const TimeScale& scale, float t, bool farthest,
                                 const IntegerFormat& format = {});

}  // namespace cde::reference
