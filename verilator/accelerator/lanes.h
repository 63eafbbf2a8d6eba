// SPDX-License-Identifier: Apache-2.0
// Vector statements that `reroll` writes, for CDE_LANE_WORDS lanes at a time (8 or 16). They are
// the operations of host_fp.h on vectors of 32-bit words. Each lane gives the bits of the scalar
// operation.
#pragma once
#include "host_nodes.h"
#include "triggers.h"

/// One instruction instead of Verilator's dozen.
#define VL_COUNTONES_I(word) IData(__builtin_popcount(word))

namespace lanes {

constexpr unsigned kLanes = CDE_LANE_WORDS;
typedef uint32_t Words __attribute__((ext_vector_type(CDE_LANE_WORDS)));
typedef float Floats __attribute__((ext_vector_type(CDE_LANE_WORDS)));

template <std::size_t N>
inline Words get(const VlWide<N>& from, unsigned word) {
  Words v;
  __builtin_memcpy(&v, from.m_storage + word, sizeof v);
  return v;
}
template <std::size_t N>
inline void put(VlWide<N>& to, unsigned word, Words v) {
  __builtin_memcpy(to.m_storage + word, &v, sizeof v);
}

inline Words word(Words v) {
  return v;
}
inline IData word(IData v) {
  return v;
}

}  // namespace lanes

namespace host_fp {

using lanes::Floats;
using lanes::Words;

template <unsigned C, unsigned E, unsigned M, bool Canonical>
inline Words lane_by_lane(Words a, Words b) {
  Words r;
  for (unsigned i = 0; i < lanes::kLanes; ++i)
    r[i] = compute<C, E, M, Canonical, uint32_t>(a[i], b[i]);
  return r;
}
template <unsigned C, unsigned E, unsigned M, bool Canonical>
[[gnu::noinline]] Words call_lane_by_lane(Words a, Words b) {
  return lane_by_lane<C, E, M, Canonical>(a, b);
}

template <unsigned C, unsigned E, unsigned M, bool Canonical = true>
requires(1 + E + M <= 32)  // wider words are scalars
    inline Words op(Words a, Words b) {
  if constexpr (Format<E, M>::kSingle && C <= code(FpOp::kEq) && !is(C, FpOp::kSqrt)) {
    const Floats x = (Floats)a, y = (Floats)b;
    if constexpr (is(C, FpOp::kLt)) {
      return (Words)(x < y);
    } else if constexpr (is(C, FpOp::kLe)) {
      return (Words)(x <= y);
    } else if constexpr (is(C, FpOp::kEq)) {
      return (Words)(x == y);
    } else {
      const Floats r = is(C, FpOp::kAdd)   ? x + y
                       : is(C, FpOp::kSub) ? x - y
                       : is(C, FpOp::kMul) ? x * y
                                           : x / y;
      if constexpr (!Canonical) return (Words)r;
      const Words nan = (Words)(r != r);
      return ((Words)r & ~nan) | (Format<E, M>::kNan & nan);
    }
  } else if constexpr (Format<E, M>::kSingle) {
    return lane_by_lane<C, E, M, Canonical>(a, b);
  } else {
    return call_lane_by_lane<C, E, M, Canonical>(a, b);
  }
}
template <unsigned C, unsigned E, unsigned M, bool Canonical = true>
requires(1 + E + M <= 32)  // wider words are scalars
    inline Words op(Words a, uint32_t b) {
  return op<C, E, M, Canonical>(a, Words{} + b);
}
template <unsigned C, unsigned E, unsigned M, bool Canonical = true>
requires(1 + E + M <= 32)  // wider words are scalars
    inline Words op(uint32_t a, Words b) {
  return op<C, E, M, Canonical>(Words{} + a, b);
}

template <unsigned C, unsigned E, unsigned M>
requires(1 + E + M <= 32)  // wider words are scalars
    inline Words sign(Words a, Words b = Words{}) {
  return sign<C, E, M, Words>(a, b);
}
template <unsigned C, unsigned E, unsigned M>
requires(1 + E + M <= 32)  // wider words are scalars
    inline Words classify(Words a) {
  return classify<C, E, M, Words>(a);
}
template <unsigned E, unsigned M>
requires(1 + E + M <= 32)  // wider words are scalars
    inline Words negative(Words a) {
  return negative<E, M, Words>(a);
}
template <unsigned E, unsigned M, bool Signed, unsigned Least, unsigned Most>
requires(1 + E + M <= 32)  // wider words are scalars
    inline Words within(Words a) {
  return within<E, M, Signed, Least, Most, Words>(a);
}
template <unsigned C, unsigned E, unsigned M, bool Keep>
requires(1 + E + M <= 32)  // wider words are scalars
    inline Words exponent(Words a, Words b) {
  return exponent<C, E, M, Keep, Words>(a, b);
}
template <unsigned C, unsigned E, unsigned M, bool Keep>
requires(1 + E + M <= 32)  // wider words are scalars
    inline Words exponent(uint32_t a, Words b) {
  return exponent<C, E, M, Keep, Words>(Words{} + a, b);
}
template <unsigned C, unsigned E, unsigned M, bool Keep>
requires(1 + E + M <= 32)  // wider words are scalars
    inline Words exponent(Words a, uint32_t b) {
  return exponent<C, E, M, Keep, Words>(a, Words{} + b);
}
template <unsigned C, unsigned E, unsigned M, unsigned Least>
requires(1 + E + M <= 32)  // wider words are scalars
    inline Words shift(Words a) {
  return shift<C, E, M, Least, Words>(a);
}
template <unsigned C, unsigned E, unsigned M>
requires(1 + E + M <= 32)  // wider words are scalars
    inline Words sign(uint32_t a, Words b) {
  return sign<C, E, M, Words>(Words{} + a, b);
}
template <unsigned C, unsigned E, unsigned M>
requires(1 + E + M <= 32)  // wider words are scalars
    inline Words sign(Words a, uint32_t b) {
  return sign<C, E, M, Words>(a, Words{} + b);
}

}  // namespace host_fp
