// SPDX-License-Identifier: Apache-2.0
/// The trigger vector of the generated model: one bit per clock, in one word. It replaces
/// Verilator's array of bools, which is written one byte at a time and read several bytes at a
/// time. Such reads stall the processor in every evaluation.
#pragma once
#include <cstddef>
#include <cstdint>

#define VlTriggerVec VlTriggerVecOfVerilator
#include "verilated.h"
#undef VlTriggerVec

template <std::size_t N>
class VlTriggerVec final {
  static_assert(N <= 64);

  class Bit {
   public:
    Bit(std::uint64_t& word, std::size_t bit) : word_(word), bit_(bit) {}
    Bit& operator=(std::uint64_t value) {
      word_ = (word_ & ~(std::uint64_t{1} << bit_)) | (value & 1) << bit_;
      return *this;
    }
    operator unsigned() const { return word_ >> bit_ & 1; }

   private:
    std::uint64_t& word_;
    std::size_t bit_;
  };

 public:
  Bit at(std::size_t index) { return {word_, index}; }
  void clear() { word_ = 0; }
  bool any() const { return word_ != 0; }
  void set(const VlTriggerVec& other) { word_ |= other.word_; }
  void andNot(const VlTriggerVec& a, const VlTriggerVec& b) { word_ = a.word_ & ~b.word_; }

 private:
  std::uint64_t word_ = 0;
};

/// A read that the compiler does not combine with adjacent reads.
template <class T>
T read_alone(const T& variable) {
  return *static_cast<const volatile T*>(&variable);
}
