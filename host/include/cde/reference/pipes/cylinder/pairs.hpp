// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/reference/pipes/cylinder/witness.hpp"
#include "cde/reference/pipes/scale.hpp"

/// @file
/// The pairs with a cylinder as secondary: cylinder-cylinder, OBB-cylinder and triangle-cylinder.
/// s_K is the largest g over the normals that the iterations cover. It is at most the signed
/// distance s, so F = 0 is a proof; docs/reference/pairs_cylinder.md has the measured shortfall.
///
/// The hardware runs begin, then step for k = 0, 1, ... until pass() returns kDone, then finish:
/// one pass per cycle.
namespace cde::reference {
namespace cylinder {

/// 3 mul, and 3 sub for the centre.
template <typename S>
[[nodiscard]] Pair<S> begin_secondary(const BasicCylinder<S>& b, const Vector<S>& origin) {
  Pair<S> pair;
  const Vector<S> zero = Vector<S>::Zero();
  pair.origin = origin;
  pair.d = sub<S>(b.c, origin);
  pair.b = b.axis, pair.b_half = b.half_height, pair.b_radius = b.radius;
  pair.b_reach = scale<S>(b.axis, b.half_height);
  pair.axis.fill(zero), pair.reach.fill(zero), pair.half.fill(S(0));
  pair.radius = S(0), pair.face = zero;
  return pair;
}

template <typename S>
[[nodiscard]] Pair<S> begin(const BasicCylinder<S>& a, const BasicCylinder<S>& b) {
  Pair<S> pair = begin_secondary<S>(b, a.c);
  pair.body = Body::kCylinder;
  pair.axis[0] = a.axis, pair.half[0] = a.half_height, pair.radius = a.radius;
  pair.reach[0] = scale<S>(a.axis, a.half_height);
  return pair;
}

template <typename S>
[[nodiscard]] Pair<S> begin(const BasicObb<S>& a, const BasicCylinder<S>& b) {
  Pair<S> pair = begin_secondary<S>(b, a.c);
  pair.body = Body::kBox;
  for (int i = 0; i < 3; ++i) {
    pair.axis[i] = a.rotation.col(i), pair.half[i] = a.half[i];
    pair.reach[i] = scale<S>(pair.axis[i], a.half[i]);
  }
  return pair;
}

template <typename S>
[[nodiscard]] Pair<S> begin(const BasicTriangle<S>& a, const BasicCylinder<S>& b) {
  Pair<S> pair = begin_secondary<S>(b, a.v0);
  pair.body = Body::kTriangle;
  pair.reach = {sub<S>(a.v1, a.v0), sub<S>(a.v2, a.v0), sub<S>(a.v2, a.v1)};
  return pair;
}

/// Pass k; returns false once the pair is done.
template <typename S>
bool step(Pair<S>& pair, Search<S>& search, const Iterations& iterations, int k) {
  const Pass p = pass(pair.body, iterations, k);
  if (p.phase == Phase::kDone) return false;
  if (p.phase == Phase::kTouch || p.phase == Phase::kProject) {
    witness<S>(pair, search, p);
  } else {
    step<S>(pair, search, p, iterations);
  }
  return true;
}

/// F = (s_K <= 0), T = |s_K|, n, and CP halfway between the witness points. 7 mul, 6 add, 1 cmp.
template <typename S>
[[nodiscard]] Outcome<S> finish(const Pair<S>& pair, const Search<S>& s) {
  Outcome<S> out;
  out.f = static_cast<bool>(s.best_g <= S(0));
  out.t = magnitude(s.best_g);
  out.n = s.best_n;
  out.cp = add<S>(pair.origin, add<S>(s.witness, scale<S>(s.best_n, s.best_g * S(0.5))));
  return out;
}

template <typename S, typename A>
[[nodiscard]] Outcome<S> run(const A& a, const BasicCylinder<S>& b, const Iterations& iterations) {
  Pair<S> pair = begin<S>(a, b);
  Search<S> search;
  for (int k = 0; step<S>(pair, search, iterations, k); ++k) {
  }
  return finish<S>(pair, search);
}

}  // namespace cylinder

/// A and B are in the order of the name. n points from A to B. Lengths are in the unit of the
/// operands.
template <typename S>
[[nodiscard]] Outcome<S> cylinder_cylinder(const BasicCylinder<S>& a, const BasicCylinder<S>& b,
                                           const cylinder::Iterations& iterations = {}) {
  return at_size_one<S>(
      a, b, [&](const auto& x, const auto& y) { return cylinder::run<S>(x, y, iterations); });
}
template <typename S>
[[nodiscard]] Outcome<S> obb_cylinder(const BasicObb<S>& a, const BasicCylinder<S>& b,
                                      const cylinder::Iterations& iterations = {}) {
  return at_size_one<S>(
      a, b, [&](const auto& x, const auto& y) { return cylinder::run<S>(x, y, iterations); });
}
template <typename S>
[[nodiscard]] Outcome<S> triangle_cylinder(const BasicTriangle<S>& a, const BasicCylinder<S>& b,
                                           const cylinder::Iterations& iterations = {}) {
  return at_size_one<S>(
      a, b, [&](const auto& x, const auto& y) { return cylinder::run<S>(x, y, iterations); });
}

}  // namespace cde::reference
