// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <optional>

#include "cde/geometry/primitives.hpp"

/// Ray against sphere and cylinder with 168 bits of precision: an independent oracle. Its formulas
/// differ from the formulas of the pipes: textbook quadratics in the plane across the axis. They
/// lose half of the digits, which this precision allows.
namespace cde::testing {

using Real = boost::multiprecision::number<boost::multiprecision::cpp_bin_float_50::backend_type,
                                           boost::multiprecision::et_off>;
using RealVector = std::array<Real, 3>;

inline RealVector real(const Eigen::Vector3d& v) {
  return {Real(v.x()), Real(v.y()), Real(v.z())};
}
inline Real dot(const RealVector& a, const RealVector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
/// a + s b
inline RealVector along(const RealVector& a, const Real& s, const RealVector& b) {
  return {a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]};
}

/// The interval of a ray's line inside a solid.
struct Stretch {
  Real enter, leave;
};

/// The interval where A t^2 + 2 B t + C <= 0, for A > 0.
inline std::optional<Stretch> roots(const Real& a, const Real& b, const Real& c) {
  const Real discriminant = b * b - a * c;
  if (discriminant < 0) return std::nullopt;
  const Real root = sqrt(discriminant);
  return Stretch{(-b - root) / a, (-b + root) / a};
}

/// A ray against one sphere, grown by `more`.
class ExactSphere {
 public:
  ExactSphere(const BasicRay<double>& ray, const BasicSphere<double>& sphere)
      : d_(real(ray.d)), w_(along(real(ray.o), -1, real(sphere.c))), r_(sphere.r) {}
  [[nodiscard]] std::optional<Stretch> stretch(const Real& more) const {
    const Real r = r_ + more;
    if (r < 0) return std::nullopt;
    return roots(dot(d_, d_), dot(w_, d_), dot(w_, w_) - r * r);
  }
  /// Distance of the point at t from the surface.
  [[nodiscard]] Real residual(const Real& t) const {
    const RealVector p = along(w_, t, d_);
    return abs(sqrt(dot(p, p)) - r_);
  }
  /// The smallest of the pipe's products that carry its relative accuracy.
  [[nodiscard]] double least_product() const { return static_cast<double>(dot(d_, d_)); }
  /// |o - c| + r, the unit of the band.
  [[nodiscard]] double size() const { return static_cast<double>(sqrt(dot(w_, w_)) + r_); }

 private:
  RealVector d_, w_;
  Real r_;
};

/// The same for a cylinder; both of its sizes grow. The axis is normalised first.
class ExactCylinder {
 public:
  ExactCylinder(const BasicRay<double>& ray, const BasicCylinder<double>& cylinder)
      : r_(cylinder.radius), h_(cylinder.half_height) {
    const RealVector d = real(ray.d), w = along(real(ray.o), -1, real(cylinder.c));
    RealVector axis = real(cylinder.axis);
    const Real length = sqrt(dot(axis, axis));
    for (Real& x : axis) x /= length;
    dz_ = dot(d, axis), wz_ = dot(w, axis);
    d_ = along(d, -dz_, axis), w_ = along(w, -wz_, axis);
  }
  [[nodiscard]] std::optional<Stretch> stretch(const Real& more) const {
    const Real r = r_ + more, h = h_ + more;
    if (r < 0 || h < 0) return std::nullopt;
    const Real a = dot(d_, d_), c = dot(w_, w_) - r * r;
    constexpr double kFar = 1e300;
    // Below this the ray is parallel to the axis up to rounding of the projection.
    const bool parallel = a <= dz_ * dz_ * Real(1e-90);
    std::optional<Stretch> s;
    if (parallel) {
      if (c > 0) return std::nullopt;
      s = Stretch{-kFar, kFar};
    } else {
      s = roots(a, dot(w_, d_), c);
    }
    if (!s || dz_ == 0) return abs(wz_) <= h ? s : std::nullopt;
    const Real t0 = (-h - wz_) / dz_, t1 = (h - wz_) / dz_;
    s->enter = std::max(s->enter, std::min(t0, t1));
    s->leave = std::min(s->leave, std::max(t0, t1));
    return s->enter <= s->leave ? s : std::nullopt;
  }
  [[nodiscard]] Real residual(const Real& t) const {
    const RealVector p = along(w_, t, d_);
    const Real out = sqrt(dot(p, p)) - r_, over = abs(wz_ + t * dz_) - h_;
    return abs(std::max(out, over));
  }
  /// The smallest of the pipe's products that carry its relative accuracy.
  [[nodiscard]] double least_product() const {
    return static_cast<double>(dot(d_, d_) * std::min(Real(1), Real(r_ * r_)));
  }
  [[nodiscard]] double size() const {
    return static_cast<double>(sqrt(dot(w_, w_) + wz_ * wz_) + r_ + h_);
  }

 private:
  RealVector d_, w_;  ///< across the axis
  Real dz_, wz_, r_, h_;
};

/// Numbers lo .. hi against a ray's interval.
struct Range {
  Real lo, hi;
  [[nodiscard]] bool holds(const Real& t) const { return lo <= t && t <= hi; }
  [[nodiscard]] bool inside(const Real& tmin, const Real& tmax) const {
    return tmin <= lo && hi <= tmax;
  }
  [[nodiscard]] bool outside(const Real& tmin, const Real& tmax) const {
    return hi < tmin || tmax < lo;
  }
};

/// The required answer if the sizes of the solid may be off by `band`, and t by the corresponding
/// length on the ray.
class Judgement {
 public:
  enum class Truth { kHit, kMiss, kUncertain };

  template <typename Solid>
  Judgement(const Solid& solid, const BasicRay<double>& ray, double band)
      : tmin_(clip(ray.tmin)), tmax_(clip(ray.tmax)) {
    const auto grown = solid.stretch(band), shrunk = solid.stretch(-band), exact = solid.stretch(0);
    exact_ = exact && (in(exact->enter) || in(exact->leave));
    if (exact_) t_ = in(exact->enter) ? exact->enter : exact->leave;
    if (!grown) return;
    const Real slack = band / ray.d.norm();
    enter_ = {grown->enter - slack, (shrunk ? shrunk->enter : grown->leave) + slack};
    leave_ = {(shrunk ? shrunk->leave : grown->enter) - slack, grown->leave + slack};
    if (enter_.outside(tmin_, tmax_) && leave_.outside(tmin_, tmax_)) return;
    const bool sure = enter_.inside(tmin_, tmax_) || leave_.inside(tmin_, tmax_);
    truth_ = shrunk && sure ? Truth::kHit : Truth::kUncertain;
  }
  [[nodiscard]] Truth truth() const { return truth_; }
  /// The answer in exact arithmetic.
  [[nodiscard]] bool exact() const { return exact_; }
  [[nodiscard]] const Real& exact_t() const { return t_; }
  /// Whether this may be the T of a hit.
  [[nodiscard]] bool accepts(const Real& t) const {
    return (enter_.holds(t) && !enter_.outside(tmin_, tmax_)) ||
           (leave_.holds(t) && !leave_.outside(tmin_, tmax_) && !enter_.inside(tmin_, tmax_));
  }

 private:
  static Real clip(double x) { return std::clamp(x, -1e300, 1e300); }
  [[nodiscard]] bool in(const Real& t) const { return tmin_ <= t && t <= tmax_; }

  Real tmin_, tmax_, t_ = 0;
  Truth truth_ = Truth::kMiss;
  bool exact_ = false;
  Range enter_{1, 0}, leave_{1, 0};
};

}  // namespace cde::testing
