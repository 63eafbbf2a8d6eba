// SPDX-License-Identifier: Apache-2.0
#include "cde/geometry/bounds.hpp"

#include <cmath>
#include <limits>

namespace cde {
namespace {

constexpr double kU = 0x1p-24;

constexpr double gamma(int roundings) {
  return roundings * kU / (1 - roundings * kU);
}

/// |a| x |b| with sums instead of differences.
Eigen::Vector3d permanent_cross(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return {a.y() * b.z() + a.z() * b.y(), a.z() * b.x() + a.x() * b.z(),
          a.x() * b.y() + a.y() * b.x()};
}

}  // namespace

MollerBound moller_bound(const Ray& ray, const Triangle& triangle) {
  const Eigen::Vector3d v0 = triangle.v0.cast<double>();
  const Eigen::Vector3d e1 = (triangle.v1.cast<double>() - v0).cwiseAbs();
  const Eigen::Vector3d e2 = (triangle.v2.cast<double>() - v0).cwiseAbs();
  const Eigen::Vector3d t = (ray.o.cast<double>() - v0).cwiseAbs();
  const Eigen::Vector3d d = ray.d.cast<double>().cwiseAbs();
  const Eigen::Vector3d p = permanent_cross(d, e2), q = permanent_cross(t, e1);
  MollerBound bound;
  bound.det = gamma(7) * p.dot(e1);
  bound.u = gamma(7) * p.dot(t);
  bound.v = gamma(7) * q.dot(d);
  bound.uv = gamma(8) / gamma(7) * (bound.u + bound.v);
  bound.tn = gamma(7) * q.dot(e2);
  return bound;
}

double MollerBound::t(double exact_det, double exact_t) const {
  const double rest = std::abs(exact_det) - det;
  if (!(rest > 0)) return std::numeric_limits<double>::infinity();
  const double quotient = (tn + std::abs(exact_t) * det) / rest;
  return quotient + gamma(1) * (std::abs(exact_t) + quotient);
}

double MollerBound::cp(const Ray& ray, double exact_det, double exact_t) const {
  const double d = ray.d.cast<double>().cwiseAbs().maxCoeff(),
               o = ray.o.cast<double>().cwiseAbs().maxCoeff();
  const double dt = t(exact_det, exact_t);
  return dt * d + gamma(2) * (o + (std::abs(exact_t) + dt) * d);
}

}  // namespace cde
