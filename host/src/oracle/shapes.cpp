// SPDX-License-Identifier: Apache-2.0
#include "cde/oracle/shapes.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <stdexcept>

namespace cde::oracle {
namespace {

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

double box_support(const Vec& c, const Vec& half, const Eigen::Matrix3d& rotation, const Vec& n) {
  return n.dot(c) + half.dot((rotation.transpose() * n).cwiseAbs());
}

double plane_support(const Plane& plane, const Vec& n) {
  const double along = n.dot(plane.n) / plane.n.norm() / n.norm();
  const double across = (n.cross(plane.n)).norm() / plane.n.norm() / n.norm();
  if (across > 1e-12 || (plane.half_space && along < 0))
    return std::numeric_limits<double>::infinity();
  return std::copysign(plane.d / plane.n.norm(), along * plane.d) * n.norm();
}

using Long = Eigen::Matrix<long double, 3, 1>;

long double segment_distance(const Long& p, const Long& a, const Long& b) {
  const Long ab = b - a;
  const long double length = ab.squaredNorm();
  const long double t =
      length > 0 ? std::clamp<long double>((p - a).dot(ab) / length, 0.0L, 1.0L) : 0.0L;
  return (a + t * ab - p).norm();
}

/// The least of the three edges and, if p projects inside, the plane. Every candidate is the
/// distance to a point of the triangle, so a degenerate one can only be overestimated by rounding.
double triangle_distance(const Vec& point, const Triangle& triangle) {
  const Long p = point.cast<long double>();
  const Long v0 = triangle.v0.cast<long double>(), v1 = triangle.v1.cast<long double>(),
             v2 = triangle.v2.cast<long double>();
  long double best = std::min(
      {segment_distance(p, v0, v1), segment_distance(p, v1, v2), segment_distance(p, v2, v0)});
  const Long e1 = v1 - v0, e2 = v2 - v0, normal = e1.cross(e2);
  const long double area = normal.squaredNorm();
  if (area > 0) {
    const Long f = p - v0;
    const long double u = f.cross(e2).dot(normal) / area, v = e1.cross(f).dot(normal) / area;
    if (u >= 0 && v >= 0 && u + v <= 1) best = std::min(best, (u * e1 + v * e2 - f).norm());
  }
  return static_cast<double>(best);
}

double cylinder_distance(const Vec& p, const Cylinder& cylinder) {
  const double length = cylinder.axis.norm();
  const Vec axis = cylinder.axis / length, f = p - cylinder.c;
  const double axial = std::max(0.0, std::abs(f.dot(axis)) - cylinder.half_height * length);
  const double radial = std::max(0.0, axis.cross(f).norm() - cylinder.radius);
  return std::hypot(axial, radial);
}

/// Clamped in the box's own coordinates; the columns are orthonormal to 1e-6, which makes this the
/// nearest point up to a relative 1e-12.
double obb_distance(const Vec& p, const Obb& box) {
  const Vec local = box.rotation.inverse() * (p - box.c);
  const Vec clamped = local.cwiseMax(-box.half).cwiseMin(box.half);
  return (box.rotation * (local - clamped)).norm();
}

double plane_distance(const Vec& p, const Plane& plane) {
  const double height = (plane.n.dot(p) - plane.d) / plane.n.norm();
  return plane.half_space ? std::max(0.0, height) : std::abs(height);
}

double extent(const Shape& shape) {
  return std::visit(Overloaded{[](const Sphere& s) { return s.r; },
                               [](const Aabb& s) { return (s.max - s.min).sum() / 2; },
                               [](const Obb& s) { return s.half.sum(); },
                               [](const Triangle& s) {
                                 const Vec c = center(s);
                                 return std::max({(s.v0 - c).lpNorm<1>(), (s.v1 - c).lpNorm<1>(),
                                                  (s.v2 - c).lpNorm<1>()});
                               },
                               [](const Cylinder& s) { return s.half_height + s.radius; },
                               [](const Plane& s) { return std::abs(s.d); }},
                    shape);
}

double largest(std::initializer_list<Vec> points) {
  double found = 0;
  for (const Vec& p : points) found = std::max(found, p.cwiseAbs().maxCoeff());
  return found;
}

double largest_coordinate(const Shape& shape) {
  return std::visit(Overloaded{[](const Sphere& s) { return largest({s.c}); },
                               [](const Aabb& s) {
                                 return largest({s.min, s.max});
                               },
                               [](const Obb& s) { return largest({s.c}) + s.half.maxCoeff(); },
                               [](const Triangle& s) {
                                 return largest({s.v0, s.v1, s.v2});
                               },
                               [](const Cylinder& s) { return largest({s.c}); },
                               [](const Plane& s) { return std::abs(s.d); }},
                    shape);
}

}  // namespace

std::size_t word_count(ShapeKind kind) {
  switch (kind) {
    case ShapeKind::kRay:
      return 8;
    case ShapeKind::kTriangle:
      return 9;
    case ShapeKind::kSphere:
      return 4;
    case ShapeKind::kAabb:
      return 6;
    case ShapeKind::kPlane:
      return 4;
    case ShapeKind::kCylinder:
      return 8;
    case ShapeKind::kObb:
      return 15;
  }
  throw std::invalid_argument("unknown shape kind");
}

Ray ray_from_words(std::span<const double> w) {
  if (w.size() != word_count(ShapeKind::kRay)) throw std::invalid_argument("a ray has 8 words");
  return {{w[0], w[1], w[2]}, {w[3], w[4], w[5]}, w[6], w[7]};
}

Shape shape_from_words(ShapeKind kind, std::span<const double> w) {
  if (w.size() != word_count(kind)) throw std::invalid_argument("wrong number of words");
  const auto vec = [&](std::size_t i) { return Vec(w[i], w[i + 1], w[i + 2]); };
  switch (kind) {
    case ShapeKind::kTriangle:
      return Triangle{vec(0), vec(3), vec(6)};
    case ShapeKind::kSphere:
      return Sphere{vec(0), w[3]};
    case ShapeKind::kAabb:
      return Aabb{vec(0), vec(3)};
    case ShapeKind::kPlane:
      return Plane{vec(0), w[3]};
    case ShapeKind::kCylinder:
      return Cylinder{vec(0), vec(3), w[6], w[7]};
    case ShapeKind::kObb: {
      Obb box{vec(0), vec(3), {}};
      for (int row = 0; row < 3; ++row) box.rotation.row(row) = vec(6 + 3 * row).transpose();
      return box;
    }
    case ShapeKind::kRay:
      break;
  }
  throw std::invalid_argument("a ray has no signed gap");
}

Vec center(const Shape& shape) {
  return std::visit(
      Overloaded{[](const Aabb& s) -> Vec { return (s.min + s.max) / 2; },
                 [](const Triangle& s) -> Vec { return (s.v0 + s.v1 + s.v2) / 3; },
                 [](const Plane& s) -> Vec { return s.n * (s.d / s.n.squaredNorm()); },
                 [](const auto& s) -> Vec { return s.c; }},
      shape);
}

double support(const Shape& shape, const Vec& n) {
  return std::visit(
      Overloaded{[&](const Sphere& s) { return n.dot(s.c) + s.r * n.norm(); },
                 [&](const Aabb& s) {
                   return box_support((s.min + s.max) / 2, (s.max - s.min) / 2,
                                      Eigen::Matrix3d::Identity(), n);
                 },
                 [&](const Obb& s) { return box_support(s.c, s.half, s.rotation, n); },
                 [&](const Triangle& s) {
                   return std::max({n.dot(s.v0), n.dot(s.v1), n.dot(s.v2)});
                 },
                 [&](const Cylinder& s) {
                   return n.dot(s.c) + s.half_height * std::abs(n.dot(s.axis)) +
                          s.radius * s.axis.cross(n).norm() / s.axis.norm();
                 },
                 [&](const Plane& s) { return plane_support(s, n); }},
      shape);
}

double distance(const Vec& p, const Shape& shape) {
  return std::visit(
      Overloaded{[&](const Sphere& s) { return std::max(0.0, (p - s.c).norm() - s.r); },
                 [&](const Aabb& s) { return (p - p.cwiseMax(s.min).cwiseMin(s.max)).norm(); },
                 [&](const Obb& s) { return obb_distance(p, s); },
                 [&](const Triangle& s) { return triangle_distance(p, s); },
                 [&](const Cylinder& s) { return cylinder_distance(p, s); },
                 [&](const Plane& s) { return plane_distance(p, s); }},
      shape);
}

double scene_size(const Shape& a, const Shape& b) {
  double apart = (center(b) - center(a)).lpNorm<1>();
  if (std::holds_alternative<Plane>(b)) apart = center(a).lpNorm<1>();
  if (std::holds_alternative<Plane>(a)) apart = center(b).lpNorm<1>();
  return apart + extent(a) + extent(b);
}

double largest_coordinate(const Shape& a, const Shape& b) {
  return std::max(largest_coordinate(a), largest_coordinate(b));
}

}  // namespace cde::oracle
