// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

#include "cde/geometry/ops.hpp"
#include "cde/reference/pipes/ray_outcome.hpp"
#include "cde/reference/pipes/scale.hpp"

/// @file
/// Textbook versions of pairs, for comparison with the pipes. A pipe has more operators: they are
/// the cost of its guarantees. Both use the same kinds of operators, formats and scaling; each
/// operator rounds once. Textbook versions have no RTL.
namespace cde::accuracy::textbook {

using reference::add;
using reference::at_size_one;
using reference::cross;
using reference::dot;
using reference::in_interval;
using reference::magnitude;
using reference::Mask;
using reference::max_num;
using reference::Outcome;
using reference::point_at;
using reference::ray_outcome;
using reference::scale;
using reference::select;
using reference::square_root;
using reference::sub;
using reference::Vector;

/// The two roots of a t^2 + b t + c = 0 by (-b -+ sqrt(b^2 - 4 a c)) / 2 a.
template <class S>
struct Roots {
  Mask<S> real;
  S near, far;
  Roots(S a, S b, S c) {
    const S discriminant = b * b - S(4) * a * c;
    real = S(0) <= discriminant;
    const S root = square_root(discriminant), twice = S(2) * a;
    near = (-b - root) / twice;
    far = (-b + root) / twice;
  }
};

/// Ray-sphere: the quadratic of |o + t d - c| = r. Source: Glassner (ed.), "An Introduction to Ray
/// Tracing", 1989, chapter 2. 18 mul, 2 div, 1 sqrt, 10 add, 6 sub, 5 cmp.
template <class S, bool AtSizeOne = false>
[[nodiscard]] Outcome<S> ray_sphere(const BasicRay<S>& ray, const BasicSphere<S>& sphere) {
  if constexpr (!AtSizeOne) return at_size_one<S>(ray, sphere, ray_sphere<S, true>);
  const Vector<S> f = sub<S>(ray.o, sphere.c);
  const Roots<S> roots(dot<S>(ray.d, ray.d), S(2) * dot<S>(f, ray.d),
                       dot<S>(f, f) - sphere.r * sphere.r);
  const Mask<S> near_in = in_interval(ray, roots.near), far_in = in_interval(ray, roots.far);
  const S t = select(near_in, roots.near, roots.far);
  return ray_outcome<S>(roots.real && (near_in || far_in), t, point_at(ray, t));
}

/// Ray-cylinder: the quadratic of the distance from the axis, and the planes of the caps. A ray
/// along the axis has no quadratic. In that case, and beyond the caps, only the planes count.
template <class S, bool AtSizeOne = false>
[[nodiscard]] Outcome<S> ray_cylinder(const BasicRay<S>& ray, const BasicCylinder<S>& cylinder) {
  if constexpr (!AtSizeOne) return at_size_one<S>(ray, cylinder, ray_cylinder<S, true>);
  const Vector<S> f = sub<S>(ray.o, cylinder.c);
  const S fa = dot<S>(f, cylinder.axis), da = dot<S>(ray.d, cylinder.axis);
  const Vector<S> fp = sub<S>(f, scale<S>(cylinder.axis, fa)),
                  dp = sub<S>(ray.d, scale<S>(cylinder.axis, da));
  const S rr = cylinder.radius * cylinder.radius;
  const Roots<S> roots(dot<S>(dp, dp), S(2) * dot<S>(fp, dp), dot<S>(fp, fp) - rr);
  Mask<S> meets = false;
  S best(0);
  const auto consider = [&](Mask<S> there, S t) {
    const Mask<S> nearer = there && in_interval(ray, t) && (!meets || t < best);
    meets = meets || nearer;
    best = select(nearer, t, best);
  };
  for (const S t : {roots.near, roots.far})
    consider(roots.real && magnitude(fa + t * da) <= cylinder.half_height, t);
  for (const S side : {cylinder.half_height, -cylinder.half_height}) {
    const S t = (side - fa) / da;
    const Vector<S> off = add<S>(fp, scale<S>(dp, t));
    consider(static_cast<bool>(dot<S>(off, off) <= rr), t);
  }
  return ray_outcome<S>(meets, best, point_at(ray, best));
}

/// A box's centre, half extents and axes.
template <class S>
struct Box {
  Vector<S> c, half;
  std::array<Vector<S>, 3> axis;
  explicit Box(const BasicObb<S>& b)
      : c(b.c), half(b.half), axis{b.rotation.col(0), b.rotation.col(1), b.rotation.col(2)} {}
  explicit Box(const BasicAabb<S>& b)
      : c(scale<S>(add<S>(b.max, b.min), S(0.5))),
        half(scale<S>(sub<S>(b.max, b.min), S(0.5))),
        axis{Vector<S>(S(1), S(0), S(0)), Vector<S>(S(0), S(1), S(0)),
             Vector<S>(S(0), S(0), S(1))} {}

  [[nodiscard]] S reach(const Vector<S>& n) const {
    return (half.x() * magnitude(dot<S>(axis[0], n)) + half.y() * magnitude(dot<S>(axis[1], n))) +
           half.z() * magnitude(dot<S>(axis[2], n));
  }
};

/// Separating axes as usually tested: the shapes are apart if their projections on one axis are.
/// There is no tolerance, and axes are not normalised. Computes F alone.
template <class S>
class Axes {
 public:
  template <class Separation>
  void test(const Vector<S>& n, Separation separation) {
    // Parallel edges have no common axis. Their rounding error is treated as one nevertheless.
    apart_ = apart_ || static_cast<bool>(S(0) < separation(n));
  }
  [[nodiscard]] Outcome<S> outcome() const {
    Outcome<S> o;
    o.f = !apart_;
    return o;
  }

 private:
  bool apart_ = false;
};

/// OBB-OBB: 15 axes (Gottschalk, Lin and Manocha, "OBBTree", SIGGRAPH 1996).
template <class S, bool AtSizeOne = false>
[[nodiscard]] Outcome<S> obb_obb(const BasicObb<S>& a, const BasicObb<S>& b) {
  if constexpr (!AtSizeOne) return at_size_one<S>(a, b, obb_obb<S, true>);
  const Box<S> x(a), y(b);
  const Vector<S> d = sub<S>(y.c, x.c);
  const auto separation = [&](const Vector<S>& n) {
    return magnitude(dot<S>(d, n)) - (x.reach(n) + y.reach(n));
  };
  Axes<S> axes;
  for (const Vector<S>& n : x.axis) axes.test(n, separation);
  for (const Vector<S>& n : y.axis) axes.test(n, separation);
  for (const Vector<S>& m : x.axis)
    for (const Vector<S>& n : y.axis) axes.test(cross<S>(m, n), separation);
  return axes.outcome();
}

/// Triangle-box: 13 axes (Akenine-Moeller, "Fast 3D Triangle-Box Overlap Testing", 2001).
template <class S, class B, bool AtSizeOne = false>
[[nodiscard]] Outcome<S> triangle_box(const BasicTriangle<S>& triangle, const B& box) {
  if constexpr (!AtSizeOne) return at_size_one<S>(triangle, box, triangle_box<S, B, true>);
  const Box<S> y(box);
  const std::array<Vector<S>, 3> v{sub<S>(triangle.v0, y.c), sub<S>(triangle.v1, y.c),
                                   sub<S>(triangle.v2, y.c)};
  const std::array<Vector<S>, 3> e{sub<S>(v[1], v[0]), sub<S>(v[2], v[1]), sub<S>(v[0], v[2])};
  const auto separation = [&](const Vector<S>& n) {
    const S p = dot<S>(v[0], n), q = dot<S>(v[1], n), r = dot<S>(v[2], n);
    const S low = -max_num(max_num(-p, -q), -r), high = max_num(max_num(p, q), r);
    return max_num(low, -high) - y.reach(n);
  };
  Axes<S> axes;
  for (const Vector<S>& n : y.axis) axes.test(n, separation);
  axes.test(cross<S>(e[0], e[1]), separation);
  for (const Vector<S>& m : y.axis)
    for (const Vector<S>& n : e) axes.test(cross<S>(m, n), separation);
  return axes.outcome();
}

}  // namespace cde::accuracy::textbook
