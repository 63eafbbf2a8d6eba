// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <limits>

/// @file
/// Common parts of scalars that wrap another scalar and compute as it does.
namespace cde {

/// Base class of N: operators that follow from + - * / < <= ==. N::value() is the wrapped scalar.
template <class N>
class NumberLike {
 public:
  explicit operator double() const { return static_cast<double>(self().value()); }
  explicit operator float() const { return static_cast<float>(self().value()); }
  N& operator+=(N b) { return self() = self() + b; }
  N& operator-=(N b) { return self() = self() - b; }
  N& operator*=(N b) { return self() = self() * b; }
  N& operator/=(N b) { return self() = self() / b; }
  friend auto operator>(N a, N b) { return b < a; }
  friend auto operator>=(N a, N b) { return b <= a; }
  friend auto operator!=(N a, N b) { return !(a == b); }
  friend bool isfinite(N a) {
    using std::isfinite;
    return isfinite(a.value());
  }
  friend bool isnan(N a) {
    using std::isnan;
    return isnan(a.value());
  }

 private:
  N& self() { return static_cast<N&>(*this); }
  [[nodiscard]] const N& self() const { return static_cast<const N&>(*this); }
};

/// std::numeric_limits of N, which wraps an S and is made from one by N::of.
template <class N, class S>
class LimitsOf : public std::numeric_limits<S> {
  using Base = std::numeric_limits<S>;

 public:
  static N min() { return N::of(Base::min()); }
  static N max() { return N::of(Base::max()); }
  static N lowest() { return N::of(Base::lowest()); }
  static N infinity() { return N::of(Base::infinity()); }
  static N quiet_NaN() { return N::of(Base::quiet_NaN()); }
};

/// Eigen::NumTraits of N.
template <class N>
struct EigenTraitsOf : Eigen::GenericNumTraits<float> {
  using Real = N;
  using NonInteger = N;
  using Nested = N;
  using Literal = double;
  static N epsilon() { return N(0); }
  static N dummy_precision() { return N(0); }
  enum { IsComplex = 0, IsInteger = 0, IsSigned = 1, RequireInitialization = 1 };
};

}  // namespace cde
