// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "cde/contract/formats.hpp"
#include "cde/fp/number_like.hpp"
#include "cde/fp/scalars.hpp"
#include "cde/geometry/ops.hpp"
#include "cde/reference/pipes/scale.hpp"

/// @file
/// A scalar that records what a mirror reference computes. Each operator becomes a step with its
/// operands, its result and the origin of its operands.
namespace cde::explain {

/// A step of a reference. Wires (selections, signs, mask logic) are also steps, so that the origin
/// of an operand can be followed. They compute nothing for which hardware has an operator.
struct Step {
  bool is_operator = false;
  FpOp operation = FpOp::kAdd;               ///< for an operator, up to kMax
  std::uint64_t a = 0, b = 0, result = 0;    ///< words; 0 or 1 for a comparison. sqrt: b equals a
  std::array<std::int32_t, 2> from{-1, -1};  ///< steps that it depends on; -1: none
};

/// The steps of one call, in order of computation.
class Recording {
 public:
  std::vector<Step> steps;

  /// Recording of this thread that receives steps; null: steps are lost.
  static inline thread_local Recording* now = nullptr;

  static std::int32_t add(const Step& step) {
    if (now == nullptr) return -1;
    now->steps.push_back(step);
    return static_cast<std::int32_t>(now->steps.size()) - 1;
  }
  static std::int32_t wire(std::int32_t a, std::int32_t b) {
    if (a < 0 || a == b) return b;
    return b < 0 ? a : add({.from = {a, b}});
  }
};

/// Result of a comparison.
class RecordedMask {
 public:
  RecordedMask() = default;
  RecordedMask(bool value, std::int32_t step = -1) : value_(value), step_(step) {}
  explicit operator bool() const { return value_; }
  [[nodiscard]] std::int32_t step() const { return step_; }
  friend RecordedMask operator&&(RecordedMask a, RecordedMask b) {
    return {a.value_ && b.value_, Recording::wire(a.step_, b.step_)};
  }
  friend RecordedMask operator||(RecordedMask a, RecordedMask b) {
    return {a.value_ || b.value_, Recording::wire(a.step_, b.step_)};
  }
  RecordedMask operator!() const { return {!value_, step_}; }

 private:
  bool value_ = false;
  std::int32_t step_ = -1;
};

template <class S>
class Recorded : public NumberLike<Recorded<S>> {
 public:
  Recorded() = default;
  explicit Recorded(double value) : value_(static_cast<S>(value)) {}
  explicit Recorded(float value) : value_(static_cast<S>(value)) {}
  explicit Recorded(int value) : value_(static_cast<S>(value)) {}
  static Recorded of(S value, std::int32_t step = -1) {
    Recorded r;
    r.value_ = value;
    r.step_ = step;
    return r;
  }
  [[nodiscard]] S value() const { return value_; }
  [[nodiscard]] std::int32_t step() const { return step_; }

  Recorded operator-() const { return of(-value_, step_); }
  friend Recorded operator+(Recorded a, Recorded b) {
    return operation(FpOp::kAdd, a, b, a.value_ + b.value_);
  }
  friend Recorded operator-(Recorded a, Recorded b) {
    return operation(FpOp::kSub, a, b, a.value_ - b.value_);
  }
  friend Recorded operator*(Recorded a, Recorded b) {
    return operation(FpOp::kMul, a, b, a.value_ * b.value_);
  }
  friend Recorded operator/(Recorded a, Recorded b) {
    return operation(FpOp::kDiv, a, b, a.value_ / b.value_);
  }
  friend RecordedMask operator<(Recorded a, Recorded b) {
    return decision(FpOp::kLt, a, b, a.value_ < b.value_);
  }
  friend RecordedMask operator<=(Recorded a, Recorded b) {
    return decision(FpOp::kLe, a, b, a.value_ <= b.value_);
  }
  friend RecordedMask operator==(Recorded a, Recorded b) {
    return decision(FpOp::kEq, a, b, a.value_ == b.value_);
  }

  friend Recorded sqrt(Recorded a) {
    using std::sqrt;
    return operation(FpOp::kSqrt, a, a, sqrt(a.value_));
  }
  friend Recorded min_num(Recorded a, Recorded b) {
    return operation(FpOp::kMin, a, b, reference::min_num(a.value_, b.value_));
  }
  friend Recorded max_num(Recorded a, Recorded b) {
    return operation(FpOp::kMax, a, b, reference::max_num(a.value_, b.value_));
  }

  // Wires.
  friend Recorded abs(Recorded a) {
    using std::abs;
    return of(abs(a.value_), a.step_);
  }
  friend Recorded no_minus_zero(Recorded a) {
    return of(reference::no_minus_zero(a.value_), a.step_);
  }
  friend RecordedMask signbit(Recorded a) {
    using std::signbit;
    return {signbit(a.value_), a.step_};
  }
  friend Recorded canonical(Recorded a) { return of(reference::canonical(a.value_), a.step_); }
  friend Recorded move_sign(Recorded a, Recorded b) {
    return of(reference::move_sign(a.value_, b.value_), Recording::wire(a.step_, b.step_));
  }
  friend int stored_exponent(Recorded a) { return reference::stored_exponent(a.value_); }
  friend Recorded times_power_of_two(Recorded a, int k, bool keep = false) {
    return of(reference::times_power_of_two(a.value_, k, keep), a.step_);
  }
  friend Recorded select(RecordedMask mask, Recorded a, Recorded b) {
    const Recorded& chosen = mask ? a : b;
    return of(chosen.value_, Recording::wire(mask.step(), chosen.step_));
  }

 private:
  static std::int32_t note(FpOp op, Recorded a, Recorded b, std::uint64_t result) {
    return Recording::add(
        {true, op, to_word(a.value_), to_word(b.value_), result, {a.step_, b.step_}});
  }
  static Recorded operation(FpOp op, Recorded a, Recorded b, S value) {
    return of(value, note(op, a, b, to_word(value)));
  }
  static RecordedMask decision(FpOp op, Recorded a, Recorded b, bool value) {
    return {value, note(op, a, b, value ? 1 : 0)};
  }

  S value_{};
  std::int32_t step_ = -1;
};

}  // namespace cde::explain

template <class S>
class std::numeric_limits<cde::explain::Recorded<S>>
    : public cde::LimitsOf<cde::explain::Recorded<S>, S> {};

/// @cond
template <class S>
struct Eigen::NumTraits<cde::explain::Recorded<S>> : cde::EigenTraitsOf<cde::explain::Recorded<S>> {
};
/// @endcond
