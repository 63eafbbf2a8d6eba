// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include "cde/fp/number_like.hpp"
#include "cde/geometry/ops.hpp"
#include "cde/reference/pipes/scale.hpp"

/// A scalar that counts the operators of a mirror reference and the depth of their chains. It
/// computes like float, and every operator adds to Counted::tally.
namespace cde::testing {

struct Tally {
  int add = 0, sub = 0, mul = 0, div = 0, sqrt = 0, cmp = 0, minmax = 0;
  int depth = 0;  ///< operators on the longest path from an input to any result

  bool operator==(const Tally&) const = default;
  [[nodiscard]] std::string text() const {
    const auto field = [](int n, const char* name) {
      return n == 0 ? std::string() : std::to_string(n) + " " + name + ", ";
    };
    return field(mul, "mul") + field(div, "div") + field(sqrt, "sqrt") + field(add, "add") +
           field(sub, "sub") + field(cmp, "cmp") + field(minmax, "min/max") + "depth " +
           std::to_string(depth);
  }
};

/// The result of a comparison; && || ! are wires.
class CountedMask {
 public:
  CountedMask() = default;
  CountedMask(bool value, int depth = 0) : value_(value), depth_(depth) {}
  explicit operator bool() const { return value_; }
  [[nodiscard]] int depth() const { return depth_; }
  friend CountedMask operator&&(CountedMask a, CountedMask b) {
    return {a.value_ && b.value_, std::max(a.depth_, b.depth_)};
  }
  friend CountedMask operator||(CountedMask a, CountedMask b) {
    return {a.value_ || b.value_, std::max(a.depth_, b.depth_)};
  }
  CountedMask operator!() const { return {!value_, depth_}; }

 private:
  bool value_ = false;
  int depth_ = 0;
};

class Counted : public NumberLike<Counted> {
 public:
  static inline Tally tally;

  Counted() = default;
  explicit Counted(float value, int depth = 0) : value_(value), depth_(depth) {}
  explicit Counted(double value) : value_(static_cast<float>(value)) {}
  explicit Counted(int value) : value_(static_cast<float>(value)) {}
  static Counted of(float value) { return Counted(value); }
  [[nodiscard]] float value() const { return value_; }

  Counted operator-() const { return Counted(-value_, depth_); }
  friend Counted operator+(Counted a, Counted b) {
    return a.result(tally.add, a.value_ + b.value_, b);
  }
  friend Counted operator-(Counted a, Counted b) {
    return a.result(tally.sub, a.value_ - b.value_, b);
  }
  friend Counted operator*(Counted a, Counted b) {
    return a.result(tally.mul, a.value_ * b.value_, b);
  }
  friend Counted operator/(Counted a, Counted b) {
    return a.result(tally.div, a.value_ / b.value_, b);
  }
  friend CountedMask operator<(Counted a, Counted b) { return a.decision(a.value_ < b.value_, b); }
  friend CountedMask operator<=(Counted a, Counted b) {
    return a.decision(a.value_ <= b.value_, b);
  }
  friend CountedMask operator==(Counted a, Counted b) {
    return a.decision(a.value_ == b.value_, b);
  }

  friend Counted sqrt(Counted a) { return a.result(tally.sqrt, std::sqrt(a.value_), a); }
  friend Counted min_num(Counted a, Counted b) {
    return a.result(tally.minmax, reference::min_num(a.value_, b.value_), b);
  }
  friend Counted max_num(Counted a, Counted b) {
    return a.result(tally.minmax, reference::max_num(a.value_, b.value_), b);
  }

  // Wires.
  friend Counted abs(Counted a) { return Counted(std::abs(a.value_), a.depth_); }
  friend Counted no_minus_zero(Counted a) {
    return Counted(reference::no_minus_zero(a.value_), a.depth_);
  }
  friend CountedMask signbit(Counted a) { return {std::signbit(a.value_), a.depth_}; }
  friend Counted canonical(Counted a) { return Counted(reference::canonical(a.value_), a.depth_); }
  friend Counted move_sign(Counted a, Counted b) {
    return Counted(reference::move_sign(a.value_, b.value_), std::max(a.depth_, b.depth_));
  }
  friend int stored_exponent(Counted a) { return reference::stored_exponent(a.value_); }
  friend Counted times_power_of_two(Counted a, int k, bool keep = false) {
    return Counted(reference::times_power_of_two(a.value_, k, keep), a.depth_);
  }
  friend Counted select(CountedMask mask, Counted a, Counted b) {
    return Counted(mask ? a.value_ : b.value_, std::max({mask.depth(), a.depth_, b.depth_}));
  }

 private:
  [[nodiscard]] int after(Counted b) const {
    const int depth = std::max(depth_, b.depth_) + 1;
    tally.depth = std::max(tally.depth, depth);
    return depth;
  }
  [[nodiscard]] Counted result(int& operators, float value, Counted b) const {
    ++operators;
    return Counted(value, after(b));
  }
  [[nodiscard]] CountedMask decision(bool value, Counted b) const {
    ++tally.cmp;
    return {value, after(b)};
  }

  float value_ = 0;
  int depth_ = 0;
};

}  // namespace cde::testing

template <>
class std::numeric_limits<cde::testing::Counted>
    : public cde::LimitsOf<cde::testing::Counted, float> {};

template <>
struct Eigen::NumTraits<cde::testing::Counted> : cde::EigenTraitsOf<cde::testing::Counted> {};
