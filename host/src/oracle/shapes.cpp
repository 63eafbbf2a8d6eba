// SPDX-License-Identifier: Apache-2.0
#include "cde/oracle/shapes.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <type_traits>

#include "cde/oracle/build_shape.hpp"
#include "cde/oracle/scene.hpp"

namespace cde::oracle {
namespace {

double largest(std::initializer_list<Vec> points) {
  double found = 0;
  for (const Vec& p : points) found = std::max(found, p.cwiseAbs().maxCoeff());
  return found;
}

double box_support(const Vec& c, const Vec& half, const Frame& rotation, const Vec& n) {
  return n.dot(c) + half.dot((rotation.transpose() * n).cwiseAbs());
}

using Long = Eigen::Matrix<long double, 3, 1>;

long double segment_distance(const Long& p, const Long& a, const Long& b) {
  const Long ab = b - a;
  const long double length = ab.squaredNorm();
  const long double t =
      length > 0 ? std::clamp<long double>((p - a).dot(ab) / length, 0.0L, 1.0L) : 0.0L;
  return (a + t * ab - p).norm();
}

double dimension(Random& random, const Build& build) {
  const double x = random.uniform(0.25, 1.5);
  return build.scale * (build.dyadic ? std::round(16 * x) / 16 : x);
}

Vec half_extents(Random& random, const Build& build) {
  Vec half{dimension(random, build), dimension(random, build), dimension(random, build)};
  const int which = random.below(3);
  for (int k = 0; k < 3; ++k)
    if ((k == which) == build.plate) half[k] *= build.thin;
  return half;
}

Vec whole_extents(Lengths& lengths) {
  const double x = lengths.length(1, 5), y = lengths.length(1, 5), z = lengths.length(1, 5);
  return {x, y, z};
}

Vec any_axis(Random& random) {
  return random.flipped(Vec::Unit(random.below(3)));
}

}  // namespace

// ---- Sphere ----

Vec Sphere::center() const {
  return c;
}
double Sphere::support(const Vec& n) const {
  return n.dot(c) + r * n.norm();
}
double Sphere::distance(const Vec& p) const {
  return std::max(0.0, (p - c).norm() - r);
}
double Sphere::extent() const {
  return r;
}
double Sphere::largest() const {
  return oracle::largest({c});
}
Sphere Sphere::build(Random& random, const Frame&, const Build& build) {
  return {Vec::Zero(), dimension(random, build)};
}
Sphere Sphere::whole(Lengths& lengths) {
  return {Vec::Zero(), lengths.length(1, 5)};
}
Sphere Sphere::body(Random&, const Frame&, const Vec& h) {
  return {Vec::Zero(), h.x()};
}

// ---- AABB ----

Vec Aabb::center() const {
  return (min + max) / 2;
}
double Aabb::support(const Vec& n) const {
  return box_support((min + max) / 2, (max - min) / 2, Frame::Identity(), n);
}
double Aabb::distance(const Vec& p) const {
  return (p - p.cwiseMax(min).cwiseMin(max)).norm();
}
double Aabb::extent() const {
  return (max - min).sum() / 2;
}
double Aabb::largest() const {
  return oracle::largest({min, max});
}
Aabb Aabb::build(Random& random, const Frame&, const Build& build) {
  const Vec half = half_extents(random, build);
  return {-half, half};
}
Aabb Aabb::whole(Lengths& lengths) {
  const Vec half = whole_extents(lengths);
  return {-half, half};
}
Aabb Aabb::body(Random&, const Frame&, const Vec& h) {
  return {-h, h};
}

// ---- OBB ----

Vec Obb::center() const {
  return c;
}
double Obb::support(const Vec& n) const {
  return box_support(c, half, rotation, n);
}
/// Clamps in the box's own coordinates. The columns are orthonormal to 1e-6, so the point is the
/// nearest one up to a relative 1e-12.
double Obb::distance(const Vec& p) const {
  const Vec local = rotation.inverse() * (p - c);
  const Vec clamped = local.cwiseMax(-half).cwiseMin(half);
  return (rotation * (local - clamped)).norm();
}
double Obb::extent() const {
  return half.sum();
}
double Obb::largest() const {
  return oracle::largest({c}) + half.maxCoeff();
}
Obb Obb::build(Random& random, const Frame& frame, const Build& build) {
  return {Vec::Zero(), half_extents(random, build), frame};
}
Obb Obb::whole(Lengths& lengths) {
  const Vec half = whole_extents(lengths);
  Random& random = lengths.random;
  const Frame axes = random.chance(0.5) ? Frame(Frame::Identity()) : random.quarter_turns();
  return {Vec::Zero(), half, axes};
}
Obb Obb::body(Random&, const Frame& frame, const Vec& h) {
  return {Vec::Zero(), h, frame};
}
void Obb::flatten(Random& random, double thin, double) {
  half[random.below(3)] *= thin;
}

// ---- Triangle ----

Vec Triangle::center() const {
  return (v0 + v1 + v2) / 3;
}
double Triangle::support(const Vec& n) const {
  return std::max({n.dot(v0), n.dot(v1), n.dot(v2)});
}
/// The least distance to the three edges and, if p projects inside, the plane. Every candidate is a
/// distance to a point of the triangle. So a degenerate triangle's distance is only overestimated,
/// by rounding.
double Triangle::distance(const Vec& point) const {
  const Long p = point.cast<long double>();
  const Long a = v0.cast<long double>(), b = v1.cast<long double>(), c = v2.cast<long double>();
  long double best =
      std::min({segment_distance(p, a, b), segment_distance(p, b, c), segment_distance(p, c, a)});
  const Long e1 = b - a, e2 = c - a, normal = e1.cross(e2);
  const long double area = normal.squaredNorm();
  if (area > 0) {
    const Long f = p - a;
    const long double u = f.cross(e2).dot(normal) / area, v = e1.cross(f).dot(normal) / area;
    if (u >= 0 && v >= 0 && u + v <= 1) best = std::min(best, (u * e1 + v * e2 - f).norm());
  }
  return static_cast<double>(best);
}
double Triangle::extent() const {
  const Vec c = center();
  return std::max({(v0 - c).lpNorm<1>(), (v1 - c).lpNorm<1>(), (v2 - c).lpNorm<1>()});
}
double Triangle::largest() const {
  return oracle::largest({v0, v1, v2});
}
Triangle Triangle::build(Random& random, const Frame& frame, const Build& build) {
  const double angle = random.uniform(0, 6.28), turn = random.uniform(1.5, 2.8);
  std::array<Vec, 3> v;
  for (int i = 0; i < 3; ++i) {
    const double r = dimension(random, build), phi = angle + i * turn;
    v[i] = Vec(r * std::cos(phi), r * std::sin(phi), 0);
    if (build.dyadic) v[i] = (16 * v[i]).array().round().matrix() / 16;
    v[i].y() *= build.thin;
  }
  if (build.plate) v[2] = v[0] + build.thin * (v[2] - v[0]);  // one short edge, not one low corner
  if (build.no_area) {
    // Remains a segment or a point after rounding.
    const Vec e =
        build.scale * Vec{random.below(5) - 2., random.below(5) - 2., random.below(5) - 2.};
    const double t = 0.25 * (random.below(9) - 2);
    const Vec origin =
        build.scale / 4 * Vec{1. * random.below(5), 1. * random.below(5), 1. * random.below(5)};
    return {origin, origin + e, origin + t * e};
  }
  return {frame * v[0], frame * v[1], frame * v[2]};
}
Triangle Triangle::whole(Lengths& lengths) {
  Triangle t{lengths.point(6), lengths.point(6), lengths.point(6)};
  Random& random = lengths.random;
  if (random.chance(0.6)) {
    const int flat = random.below(3);
    t.v0[flat] = t.v1[flat] = t.v2[flat];
  }
  if (random.chance(0.3)) t.v1[random.below(3)] = t.v0[random.below(3)];
  return t;
}
/// A tile, a wall or a ramp, often half of a rectangle.
Triangle Triangle::body(Random& random, const Frame& frame, const Vec& h) {
  const double aside = random.chance(0.6) ? 0 : grid_length(random);
  const Vec a(-h.x(), -h.y(), 0), b(h.x(), -h.y(), 0), c(-h.x() + aside, h.y(), 0);
  return {frame * a, frame * b, frame * c};
}
/// Removes the area, or makes it thinner than its rounding error.
void Triangle::flatten(Random& random, double, double u) {
  const double along = random.chance(0.7) ? random.below(9) / 4. - 0.5 : random.unit();
  v2 = v0 + along * (v1 - v0);
  if (random.chance(0.2)) v1 = v2 = v0;
  if (random.chance(0.4)) v2 += 4 * u * random.direction();
}

// ---- Cylinder ----

Vec Cylinder::center() const {
  return c;
}
double Cylinder::support(const Vec& n) const {
  return n.dot(c) + half_height * std::abs(n.dot(axis)) +
         radius * axis.cross(n).norm() / axis.norm();
}
double Cylinder::distance(const Vec& p) const {
  const double length = axis.norm();
  const Vec a = axis / length, f = p - c;
  const double axial = std::max(0.0, std::abs(f.dot(a)) - half_height * length);
  const double radial = std::max(0.0, a.cross(f).norm() - radius);
  return std::hypot(axial, radial);
}
double Cylinder::extent() const {
  return half_height + radius;
}
double Cylinder::largest() const {
  return oracle::largest({c});
}
Cylinder Cylinder::build(Random& random, const Frame& frame, const Build& build) {
  const double h = dimension(random, build), r = dimension(random, build);
  return {Vec::Zero(), frame.col(2), h * (build.plate ? build.thin : 1),
          r * (build.plate ? 1 : build.thin)};
}
Cylinder Cylinder::whole(Lengths& lengths) {
  const double h = lengths.length(1, 5), r = lengths.length(1, 5);
  return {Vec::Zero(), any_axis(lengths.random), h, r};
}
Cylinder Cylinder::body(Random&, const Frame& frame, const Vec& h) {
  return {Vec::Zero(), frame.col(2), h.x(), h.y()};
}
void Cylinder::flatten(Random& random, double thin, double) {
  (random.chance(0.7) ? half_height : radius) *= thin;
}

// ---- Plane ----

Vec Plane::center() const {
  return n * (d / n.squaredNorm());
}
double Plane::support(const Vec& to) const {
  const double along = to.dot(n) / n.norm() / to.norm();
  const double across = to.cross(n).norm() / n.norm() / to.norm();
  if (across > 1e-12 || (half_space && along < 0)) return std::numeric_limits<double>::infinity();
  return std::copysign(d / n.norm(), along * d) * to.norm();
}
double Plane::distance(const Vec& p) const {
  const double height = (n.dot(p) - d) / n.norm();
  return half_space ? std::max(0.0, height) : std::abs(height);
}
double Plane::extent() const {
  return std::abs(d);
}
double Plane::largest() const {
  return std::abs(d);
}
Plane Plane::build(Random&, const Frame& frame, const Build&) {
  return {frame.col(2), 0};
}
Plane Plane::whole(Lengths& lengths) {
  return {any_axis(lengths.random), 0};
}

// ---- Any shape ----

namespace {

/// Calls word(x) for all words of a shape in slot order.
template <class S, class Word>
void each_word(S& s, Word word) {
  std::remove_const_t<S>::fields(s, [&](Field, auto& x) {
    using X = std::remove_cvref_t<decltype(x)>;
    if constexpr (std::is_same_v<X, double>) {
      word(x);
    } else {
      for (int row = 0; row < x.rows(); ++row)
        for (int column = 0; column < x.cols(); ++column) word(x(row, column));
    }
  });
}

template <class S>
std::size_t words_of() {
  S s{};
  std::size_t count = 0;
  each_word(s, [&](const double&) { ++count; });
  return count;
}

template <class S>
S from_words(std::span<const double> words) {
  if (words.size() != words_of<S>()) throw std::invalid_argument("wrong number of words");
  S s{};
  std::size_t i = 0;
  each_word(s, [&](double& word) { word = words[i++]; });
  return s;
}

template <class S>
std::vector<double> rounded_words(const S& s, const Format& format) {
  std::vector<double> words;
  each_word(s, [&](double word) { words.push_back(format.round(word)); });
  return words;
}

/// The shape after change(field, reference) of each field.
template <class Change>
Shape changed(const Shape& shape, Change change) {
  return std::visit(
      [&]<class S>(S s) -> Shape {
        S::fields(s, change);
        return s;
      },
      shape);
}

template <class X>
constexpr bool kIsVec = std::is_same_v<X, Vec>;

}  // namespace

std::size_t word_count(ShapeKind kind) {
  if (kind == ShapeKind::kRay) return words_of<Ray>();
  return with_kind(kind, []<class S>() { return words_of<S>(); });
}

Ray ray_from_words(std::span<const double> words) {
  return from_words<Ray>(words);
}
Shape shape_from_words(ShapeKind kind, std::span<const double> words) {
  return with_kind(kind, [words]<class S>() -> Shape { return from_words<S>(words); });
}
std::vector<double> to_words(const Shape& shape, const Format& format) {
  return std::visit([&](const auto& s) { return rounded_words(s, format); }, shape);
}
std::vector<double> to_words(const Ray& ray, const Format& format) {
  return rounded_words(ray, format);
}

Shape moved(const Shape& shape, const Vec& by) {
  double along = 0;  // the plane's normal in this direction
  return changed(shape, [&]<class X>(Field field, X& x) {
    if constexpr (kIsVec<X>) {
      if (field == Field::kPoint || field == Field::kCorner) x += by;
      if (field == Field::kNormal) along = x.dot(by);
    } else if constexpr (std::is_same_v<X, double>) {
      if (field == Field::kLevel) x += along;
    }
  });
}

Shape turned(const Shape& shape, const Frame& by) {
  return changed(shape, [&]<class X>(Field field, X& x) {
    if (field == Field::kCorner) throw std::invalid_argument("an AABB cannot be rotated");
    if constexpr (!std::is_same_v<X, double>)
      if (field != Field::kSize) x = by * x;
  });
}

Shape scaled(const Shape& shape, double by) {
  return changed(shape, [by]<class X>(Field field, X& x) {
    if (field != Field::kAxis && field != Field::kNormal && field != Field::kFrame) x *= by;
  });
}

Vec center(const Shape& shape) {
  return std::visit([](const auto& s) { return s.center(); }, shape);
}

double support(const Shape& shape, const Vec& n) {
  return std::visit([&](const auto& s) { return s.support(n); }, shape);
}

double distance(const Vec& p, const Shape& shape) {
  return std::visit([&](const auto& s) { return s.distance(p); }, shape);
}

double scene_size(const Shape& a, const Shape& b) {
  double apart = (center(b) - center(a)).lpNorm<1>();
  if (std::holds_alternative<Plane>(b)) apart = center(a).lpNorm<1>();
  if (std::holds_alternative<Plane>(a)) apart = center(b).lpNorm<1>();
  const auto extent = [](const Shape& shape) {
    return std::visit([](const auto& s) { return s.extent(); }, shape);
  };
  return apart + extent(a) + extent(b);
}

double largest_coordinate(const Shape& a, const Shape& b) {
  const auto largest = [](const Shape& shape) {
    return std::visit([](const auto& s) { return s.largest(); }, shape);
  };
  return std::max(largest(a), largest(b));
}

}  // namespace cde::oracle
