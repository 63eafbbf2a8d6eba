// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <type_traits>

#include "cde/fp/number_like.hpp"
#include "cde/geometry/ops.hpp"
#include "cde/reference/pipes/scale.hpp"

/// @file
/// A scalar with which a mirror reference computes what hardware with fused multiply-add would. A
/// sum or difference with a product as a term rounds once.
namespace cde::accuracy {

template <class S>
class Fused : public NumberLike<Fused<S>> {
 public:
  Fused() = default;
  explicit Fused(double value) : value_(static_cast<S>(value)) {}
  explicit Fused(float value) : value_(static_cast<S>(value)) {}
  explicit Fused(int value) : value_(static_cast<S>(value)) {}
  static Fused of(S value) {
    Fused f;
    f.value_ = value;
    return f;
  }
  [[nodiscard]] S value() const { return value_; }

  Fused operator-() const {
    Fused f(*this);
    f.value_ = -f.value_;
    f.a_ = -f.a_;
    return f;
  }
  friend Fused operator*(Fused a, Fused b) {
    Fused f = of(a.value_ * b.value_);
    f.a_ = a.value_;
    f.b_ = b.value_;
    f.product_ = true;
    return f;
  }
  friend Fused operator/(Fused a, Fused b) { return of(a.value_ / b.value_); }
  /// If both terms are products, the second is not rounded, as in a row of multiply-adds.
  friend Fused operator+(Fused a, Fused b) {
    if (b.product_) return of(fma(b.a_, b.b_, a.value_));
    if (a.product_) return of(fma(a.a_, a.b_, b.value_));
    return of(a.value_ + b.value_);
  }
  friend Fused operator-(Fused a, Fused b) { return a + -b; }
  friend bool operator<(Fused a, Fused b) { return a.value_ < b.value_; }
  friend bool operator<=(Fused a, Fused b) { return a.value_ <= b.value_; }
  friend bool operator==(Fused a, Fused b) { return a.value_ == b.value_; }

  friend Fused sqrt(Fused a) {
    using std::sqrt;
    return of(sqrt(a.value_));
  }
  friend Fused min_num(Fused a, Fused b) { return of(reference::min_num(a.value_, b.value_)); }
  friend Fused max_num(Fused a, Fused b) { return of(reference::max_num(a.value_, b.value_)); }
  friend Fused abs(Fused a) {
    using std::abs;
    return of(abs(a.value_));
  }
  friend Fused no_minus_zero(Fused a) { return of(reference::no_minus_zero(a.value_)); }
  friend bool signbit(Fused a) {
    using std::signbit;
    return signbit(a.value_);
  }
  friend Fused canonical(Fused a) { return of(reference::canonical(a.value_)); }
  friend Fused move_sign(Fused a, Fused b) { return of(reference::move_sign(a.value_, b.value_)); }
  friend int stored_exponent(Fused a) { return reference::stored_exponent(a.value_); }
  friend Fused times_power_of_two(Fused a, int k, bool keep = false) {
    return of(reference::times_power_of_two(a.value_, k, keep));
  }
  friend Fused select(bool mask, Fused a, Fused b) { return mask ? of(a.value_) : of(b.value_); }

 private:
  /// Formats below binary32 use binary64, which holds their products exactly. The sum then rounds
  /// twice, which differs from one rounding in only a few of 2^29 cases.
  static S fma(S a, S b, S c) {
    if constexpr (std::is_floating_point_v<S>)
      return std::fma(a, b, c);
    else
      return static_cast<S>(
          std::fma(static_cast<double>(a), static_cast<double>(b), static_cast<double>(c)));
  }

  S value_{}, a_{}, b_{};  ///< value_ is the rounded product a_ b_
  bool product_ = false;
};

}  // namespace cde::accuracy

template <class S>
class std::numeric_limits<cde::accuracy::Fused<S>>
    : public cde::LimitsOf<cde::accuracy::Fused<S>, S> {};

/// @cond
template <class S>
struct Eigen::NumTraits<cde::accuracy::Fused<S>> : cde::EigenTraitsOf<cde::accuracy::Fused<S>> {};
/// @endcond
