// SPDX-License-Identifier: Apache-2.0
// The host back end of rtl/bvh: tests a BVH node against a query, eight children at once.
#pragma once
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
  uint64_t low, high;  ///< culling keys, 16 bits each: low holds the first four
};
/// One word per child. Passed by reference: the registers for passing by value depend on the
/// processor.
using Children = int32_t __attribute__((vector_size(32)));
using ChildrenBits = uint32_t __attribute__((vector_size(32)));
using ChildrenFloat = float __attribute__((vector_size(32)));
using ChildrenWide = uint64_t __attribute__((vector_size(64)));

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
/// Converts words of numbers to integers of the same order, and back. -0 is below 0.
template <class Signed, class Bits>
inline void turn(Signed& x) {
  x ^= (Signed)((Bits)(x >> 31) >> 1);
}
/// base + byte * unit in that order. A NaN becomes `loser`.
[[gnu::always_inline]] inline void along(Children& r, uint64_t bytes, float unit, float base,
                                         int32_t loser) {
  using Bytes = uint8_t __attribute__((vector_size(8)));
  Bytes b;
  __builtin_memcpy(&b, &bytes, sizeof b);
  const Children q = __builtin_convertvector(b, Children);
  const ChildrenFloat t = __builtin_convertvector(q, ChildrenFloat) * unit + base;
  r = (Children)t;
  turn<Children, ChildrenBits>(r);
  const Children nan = (Children)(t != t);
  r = (r & ~nan) | (nan & loser);
}
[[gnu::always_inline]] inline NodeVisit node_visit(const uint32_t (&node)[18],
                                                   const uint32_t (&ray)[9], uint32_t floor,
                                                   uint32_t limit, uint32_t asked) {
  const bool solid = (asked & 2) != 0;  // bit 0: farthest
  constexpr int32_t kLeast = INT32_MIN, kMost = INT32_MAX, kNan = Format<8, 23>::kNan;
  constexpr int32_t kInfinite = Format<8, 23>::kInf;
  const Children number = {0, 1, 2, 3, 4, 5, 6, 7};
  const auto real = [](uint32_t x) { return std::bit_cast<float>(x); };
  const auto eight = [&](unsigned word) { return node[word] | uint64_t{node[word + 1]} << 32; };

  // node_planes.sv, node_boxes.sv
  Children near = Children{} + kLeast, far = Children{} + kMost, widest = near;
  ChildrenFloat square = {};
  for (unsigned k = 0; k < 3; ++k) {
    const uint32_t inverse = ray[6 + k], exponent = uint32_t(int8_t(node[3] >> (8 * k)));
    const float unit = real(inverse + (exponent << 23));
    const float above = (real(node[k]) - real(ray[k])) * real(inverse);
    const float below = (real(node[k]) - real(ray[3 + k])) * real(inverse);
    const bool down = (inverse >> 31) != 0;
    Children n, f;
    const uint64_t lower = eight(6 + 2 * k), upper = eight(12 + 2 * k);
    along(n, down ? upper : lower, unit, down ? below : above, kLeast);
    along(f, down ? lower : upper, unit, down ? above : below, kMost);
    near = near > n ? near : n;
    far = far < f ? far : f;
    if (!solid) continue;
    const Children distance = n > ~f ? n : ~f;  // ~: less than zero by as much
    const ChildrenFloat clamped = (ChildrenFloat)(distance > 0 ? distance : 0);
    widest = widest > distance ? widest : distance;
    square += clamped * clamped;
  }
  near = near == kLeast ? Children{} + kNan : near;
  far = far == kMost ? Children{} + kNan : far;
  if (solid) {  // node_distances.sv
    near = widest > 0 ? (Children)square : widest == kLeast ? Children{} + kNan : widest;
    far = Children{} + kInfinite;
  }

  // node_order.sv
  const auto in_order = [](uint32_t word) {  // bvh_pkg::ordered
    int32_t x = int32_t(word);
    turn<int32_t, uint32_t>(x);
    return x == -1 ? 0 : x;
  };
  const Children kinds =
      Children{} + int32_t(node[3] >> 24 | node[4] >> 28 << 8 | node[5] >> 28 << 12);
  const Children n = near - (Children)(near == -1), f = far - (Children)(far == -1);
  const Children met = (Children)((kinds >> (2 * number) & 3) != 0) & (Children)(n <= f) &
                       (Children)(f >= in_order(floor)) & (Children)(n <= in_order(limit));
  const Children down = Children{} - int32_t(asked & 1);
  const Children key = met ? (down & ~f) | (~down & n) : Children{} + kMost;
  Children rank = {};
  for (int k = 0; k < 8; ++k) rank -= (Children)(key > key[k] + (Children)(number > k));
  Children x = (down & far) | (~down & near);
  turn<Children, ChildrenBits>(x);
  const Children inexact = (Children)((x & 0xffff) != 0) & ((x >> 31) ^ down);
  const Children half = ((x >> 16) - inexact) & 0xffff;
  const ChildrenWide at = __builtin_convertvector(rank, ChildrenWide);
  const ChildrenWide key_at = __builtin_convertvector(half, ChildrenWide) << (16 * (at & 3));
  const ChildrenWide above = (ChildrenWide)(at > 3);
  const ChildrenBits order = (ChildrenBits)((number << (3 * rank)) + (met & (1 << 24)));
  return {sum<uint32_t>(order), sum<uint64_t>(ChildrenWide(key_at & ~above)),
          sum<uint64_t>(ChildrenWide(key_at & above))};
}

}  // namespace host_fp
