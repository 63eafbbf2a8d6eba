// SPDX-License-Identifier: Apache-2.0
// The host back end of rtl/bvh: tests a BVH node against a query, eight children at once.
#pragma once
#include <algorithm>

#include "host_fp.h"

namespace host_fp {

/// Prefetches an object from memory that may not be in the processor's caches.
template <class T>
inline void expect(const T& object) {
  const char* const at = reinterpret_cast<const char*>(&object);
  __builtin_prefetch(at);
  if (sizeof object > 64) __builtin_prefetch(at + sizeof object - 1);
}
/// rtl/bvh/traversal_unit.sv: the children that are hit, in order.
struct NodeVisit {
  uint32_t order;      ///< three bits per child; above them the number of children hit
  uint64_t low, high;  ///< culling keys by child, KEY bits each: low holds the first four
  uint64_t scale;      ///< of a ray's keys: T_ref, and below it the biased exponent of a step
};
/// One word per child. Passed by reference: the registers for passing by value depend on the
/// processor.
using Children = int32_t __attribute__((vector_size(32)));
using ChildrenBits = uint32_t __attribute__((vector_size(32)));
using ChildrenFloat = float __attribute__((vector_size(32)));
using ChildrenWide = uint64_t __attribute__((vector_size(64)));
using Times = double __attribute__((vector_size(64)));
using TimesBits = int64_t __attribute__((vector_size(64)));
/// One word per axis, and one that is not used.
using Axes = int32_t __attribute__((vector_size(16)));

template <class Word, class Vector>
inline Word sum(const Vector& x) {
  typedef Word Half __attribute__((vector_size(4 * sizeof(Word))));
  typedef Word Quarter __attribute__((vector_size(2 * sizeof(Word))));
  Half half[2];
  __builtin_memcpy(half, &x, sizeof x);
  half[0] += half[1];
  Quarter quarter[2];
  __builtin_memcpy(quarter, half, sizeof quarter);
  quarter[0] += quarter[1];
  return quarter[0][0] + quarter[0][1];
}
inline float real(uint32_t x) {
  return std::bit_cast<float>(x);
}
/// The corners of the children on an axis: a byte per child, four in a half of the node.
inline uint64_t bytes_of(const uint32_t (&node)[18], unsigned word) {
  return node[word] | uint64_t{node[9 + word]} << 32;
}
inline uint64_t lower_of(const uint32_t (&node)[18], unsigned axis) {
  return bytes_of(node, 3 + axis);
}
inline uint64_t upper_of(const uint32_t (&node)[18], unsigned axis) {
  return bytes_of(node, 6 + axis);
}
inline void per_child(Children& r, uint64_t bytes) {
  using Bytes = uint8_t __attribute__((vector_size(8)));
  Bytes b;
  __builtin_memcpy(&b, &bytes, sizeof b);
  r = __builtin_convertvector(b, Children);
}
/// node_order.sv: ranks of children, of which some are hit.
template <unsigned KEY>
[[gnu::always_inline]] inline NodeVisit in_order(const Children& rank, const Children& met,
                                                 const Children& stored) {
  const Children number = {0, 1, 2, 3, 4, 5, 6, 7};
  const ChildrenWide place = {0, KEY, 2 * KEY, 3 * KEY, 0, KEY, 2 * KEY, 3 * KEY};
  const ChildrenWide keys = __builtin_convertvector(stored, ChildrenWide) << place;
  const ChildrenBits order = (ChildrenBits)((number << (3 * rank)) + (met & (1 << 24)));
  typedef uint64_t Half __attribute__((vector_size(32)));
  Half half[2];
  __builtin_memcpy(half, &keys, sizeof keys);
  return {sum<uint32_t>(order), half[0][0] | half[0][1] | half[0][2] | half[0][3],
          half[1][0] | half[1][1] | half[1][2] | half[1][3], 0};
}
/// Children that are not empty.
inline void present(Children& r, const uint32_t (&node)[18]) {
  const Children number = {0, 1, 2, 3, 4, 5, 6, 7};
  const Children kinds =
      Children{} + int32_t(node[9] >> 24 | node[10] >> 28 << 8 | node[11] >> 28 << 12);
  r = (Children)((kinds >> (2 * number) & 3) != 0);
}

// ---- Rays: node_boxes_int.sv ----

/// (time - reference) 2^-step, rounded down, and whether that changes it; time_steps.sv with 27
/// bits. The difference is exact: its rounding error is known, and decides if the result is whole.
[[gnu::always_inline]] inline void in_steps(Children& steps, Children& inexact, const Times& time,
                                            double reference, const TimesBits& step) {
  constexpr int32_t kMost = (1 << 26) - 1, kLeast = -kMost - 1;
  const Times to = Times{} - reference;
  const Times difference = time + to, part = difference - time;
  const Times error = (time - (difference - part)) + (to - part);
  Times v = difference * (Times)((1023 + 127 - step) << 52);
  const Times limit = Times{} + 0x1p27;
  v = v < limit ? v : limit;
  v = v > -limit ? v : -limit;
  Children n = __builtin_convertvector(v, Children);
  const Times whole = __builtin_convertvector(n, Times);
  const Times none = {};
  const Children below = __builtin_convertvector(whole > v, Children),
                 same = __builtin_convertvector(whole == v, Children),
                 less = __builtin_convertvector(error < none, Children),
                 more = __builtin_convertvector(error > none, Children);
  n += below | (same & less);
  inexact = ~same | less | more;
  const Children outside = (Children)(n > kMost) | (Children)(n < kLeast);
  n = n > kMost ? Children{} + kMost : n;
  n = n < kLeast ? Children{} + kLeast : n;
  inexact &= ~outside;
  steps = n;
}

template <unsigned KEY>
[[gnu::always_inline]] inline NodeVisit ray_visit(const uint32_t (&node)[18],
                                                  const uint32_t (&ray)[9], uint32_t floor,
                                                  uint32_t limit, bool farthest) {
  constexpr int32_t kUnit = 16, kStep = 6, kByte = 8, kFour = 2, kFraction = 23;
  constexpr int32_t kBound = 1 << (kUnit + 9), kMost = (1 << 26) - 1, kLeast = -kMost - 1;
  const auto larger = [](const Axes& a, const Axes& b) -> Axes { return a > b ? a : b; };

  // node_scale.sv
  const Axes inverse = {int32_t(ray[6]), int32_t(ray[7]), int32_t(ray[8]), 0};
  const Axes margin_word = {int32_t(ray[3]), int32_t(ray[4]), int32_t(ray[5]), 0};
  const int32_t exponents = int32_t(node[9]);
  const Axes exponent = {int8_t(exponents), int8_t(exponents >> 8), int8_t(exponents >> 16), 0};
  const Axes negative = inverse >> 31, infinite = (Axes)(margin_word == 0x7f800000);
  const Axes unit_at = (inverse >> kFraction & 255) + exponent;
  const Axes margin_field = margin_word >> kFraction & 255;
  const Axes margin_at = larger(margin_field, Axes{} + 1);
  const Axes range = larger(unit_at + kByte, margin_at + kFour);
  const unsigned first = range[1] < range[0] ? 1 : 0, lo = range[2] < range[first] ? 2 : first;
  const int32_t scale = range[lo] - kByte - kStep;
  const Axes longer = range - (kByte + kUnit - 1);
  const Axes slow = (Axes)(longer > scale);
  const Axes step = slow ? longer : Axes{} + scale;
  const auto shift_of = [](const Axes& places) -> Axes { return places > 31 ? 31 : places; };
  const Axes unit_shift = shift_of(step - unit_at + kFraction),
             margin_shift = shift_of(step - margin_at + kFraction);
  const Axes unit_size = (inverse & 0x7fffff) | 0x800000;
  const Axes margin_size = (margin_word & 0x7fffff) | ((Axes)(margin_field != 0) & 0x800000);
  const Axes down = unit_size >> unit_shift;
  const Axes up = down - (Axes)((down << unit_shift) != unit_size);
  const Axes margin = (margin_size >> margin_shift) + 1;
  const int32_t length = 255 * up[lo];
  const int32_t before = margin[lo] + (length & negative[lo]),
                after = margin[lo] + (length & ~negative[lo]);

  // T of the planes of byte 0, and the ray's interval
  Times time = {};
  float reference = 0;
  for (unsigned k = 0; k < 3; ++k) {
    const float corner = (real(node[k]) - real(ray[k])) * real(ray[6 + k]);
    time[k] = corner;
    reference = k == lo ? corner : reference;
  }
  time[3] = real(floor);
  time[4] = real(limit);
  Children steps, inexact;
  in_steps(steps, inexact, time, reference,
           TimesBits{step[0], step[1], step[2], scale, scale, scale, scale, scale});
  const int32_t lowest = std::min(steps[3] - inexact[3], kMost), highest = steps[4];
  const Axes plane = {steps[0], steps[1], steps[2], 0},
             ceil = plane - Axes{inexact[0], inexact[1], inexact[2], 0};

  // Planes of byte 0, widened
  Axes near_0 = plane - margin - (slow & before), far_0 = ceil + margin + (slow & after);
  const Axes no_near = infinite | (Axes)(near_0 < -kBound),
             no_far = infinite | (Axes)(far_0 > kBound);
  near_0 = near_0 > kBound ? kBound : near_0;
  far_0 = far_0 < -kBound ? -kBound : far_0;
  near_0 = no_near ? kLeast : near_0;
  far_0 = no_far ? kMost : far_0;
  const Axes near_unit = (negative ? -up : down) & ~no_near,
             far_unit = (negative ? -down : up) & ~no_far;

  // Per child
  Children near = Children{} + kLeast, far = Children{} + kMost;
  for (unsigned k = 0; k < 3; ++k) {
    const uint64_t lower = lower_of(node, k), upper = upper_of(node, k);
    const bool swap = (ray[6 + k] >> 31) != 0;
    Children n, f;
    per_child(n, swap ? upper : lower);
    per_child(f, swap ? lower : upper);
    n = n * near_unit[k] + near_0[k];
    f = f * far_unit[k] + far_0[k];
    near = near > n ? near : n;
    far = far < f ? far : f;
  }
  Children met;
  present(met, node);
  met &= (Children)(near <= far) & (Children)(far >= lowest) & (Children)(near <= highest);
  Children key = (farthest ? -far : near) >> (kStep - 2);
  key = key > 2047 ? 2047 : key;
  key = (key < -2048 ? -2048 : key) + 2048;

  const Children number = {0, 1, 2, 3, 4, 5, 6, 7};
  const Children place = key * 8 + number + (~met & 1 << 16);
  Children rank = {};
  for (int k = 0; k < 8; ++k) rank -= (Children)(place > place[k]);
  NodeVisit visit = in_order<KEY>(rank, met, key);
  visit.scale = uint64_t{std::bit_cast<uint32_t>(reference)} << 8 | uint8_t(scale);
  return visit;
}

/// rtl/bvh/key_limit.sv
inline uint32_t key_limit(uint32_t time, uint32_t reference, uint32_t step, uint32_t farthest) {
  const double t = real(time), to = -double{real(reference)};
  const double difference = t + to, part = difference - t;
  const double error = (t - (difference - part)) + (to - part);
  const double v = std::clamp(
      difference * std::bit_cast<double>((1023 + 127 - uint64_t{step}) << 52), -8192.0, 8192.0);
  int32_t n = int32_t(v);
  const bool same = n == v, less = error < 0, inexact = !same || less || error > 0;
  n -= n > v || (same && less);
  return uint32_t(std::clamp(farthest ? -(n + inexact) : n, -2048, 2047) + 2048);
}

// ---- Solids: node_boxes.sv, node_distances.sv ----

/// Converts words of numbers to integers of the same order, and back. -0 is below 0.
template <class Signed, class Bits>
inline void turn(Signed& x) {
  x ^= (Signed)((Bits)(x >> 31) >> 1);
}
/// byte 2^exponent + base. A NaN becomes `loser`.
[[gnu::always_inline]] inline void along(Children& r, const Children& bytes, uint32_t exponent,
                                         float base, int32_t loser) {
  const ChildrenFloat q = __builtin_convertvector(bytes, ChildrenFloat);
  const Children offset = ((Children)q + int32_t(exponent << 23)) & (Children)(bytes != 0);
  const ChildrenFloat t = (ChildrenFloat)offset + base;
  r = (Children)t;
  turn<Children, ChildrenBits>(r);
  const Children nan = (Children)(t != t);
  r = (r & ~nan) | (nan & loser);
}

template <unsigned KEY>
[[gnu::always_inline]] inline NodeVisit solid_visit(const uint32_t (&node)[18],
                                                    const uint32_t (&solid)[9], uint32_t limit) {
  constexpr int32_t kLeast = INT32_MIN, kMost = INT32_MAX, kNan = Format<8, 23>::kNan;
  constexpr int32_t kInfinite = Format<8, 23>::kInf;
  Children widest = Children{} + kLeast;
  ChildrenFloat square = {};
  for (unsigned k = 0; k < 3; ++k) {
    const uint32_t exponent = uint32_t(int8_t(node[9] >> (8 * k)));
    Children lower, upper, above, below;
    per_child(lower, lower_of(node, k));
    per_child(upper, upper_of(node, k));
    along(above, lower, exponent, real(node[k]) - real(solid[k]), kLeast);
    along(below, upper, exponent, real(node[k]) - real(solid[3 + k]), kMost);
    const Children distance = above > ~below ? above : ~below;  // ~: less than zero by as much
    const ChildrenFloat clamped = (ChildrenFloat)(distance > 0 ? distance : 0);
    widest = widest > distance ? widest : distance;
    square += clamped * clamped;
  }
  const Children key = widest > 0         ? (Children)square
                       : widest == kLeast ? Children{} + kNan
                                          : widest;
  const Children n = key - (Children)(key == -1);  // bvh_pkg::ordered
  int32_t most = int32_t(limit);
  turn<int32_t, uint32_t>(most);
  most = most == -1 ? 0 : most;
  Children met;
  present(met, node);
  met &= (Children)(n <= kInfinite) & (Children)(n <= most);

  const Children number = {0, 1, 2, 3, 4, 5, 6, 7};
  const Children whole = met ? n : Children{} + kMost;
  Children rank = {};
  for (int k = 0; k < 8; ++k) rank -= (Children)(whole > whole[k] + (Children)(number > k));
  Children x = key;
  turn<Children, ChildrenBits>(x);
  const Children inexact = (Children)((x & 0xffff) != 0) & (x >> 31);
  const Children half = ((x >> 16) - inexact) & 0xffff;
  return in_order<KEY>(rank, met, half);
}

template <unsigned KEY>
[[gnu::always_inline]] inline NodeVisit node_visit(const uint32_t (&node)[18],
                                                   const uint32_t (&front)[9], uint32_t floor,
                                                   uint32_t limit, uint32_t asked) {
  if ((asked & 2) != 0) return solid_visit<KEY>(node, front, limit);
  return ray_visit<KEY>(node, front, floor, limit, (asked & 1) != 0);
}

}  // namespace host_fp
