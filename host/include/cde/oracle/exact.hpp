// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/multiprecision/cpp_int.hpp>

#include "cde/geometry/primitives.hpp"

/// Ray-triangle in exact rational arithmetic. This oracle shares only the geometry with the pipe.
/// It solves O + t D = V0 + u E1 + v E2 by Cramer's rule on the 3x3 determinants.
struct ExactHit {
  using Rational = boost::multiprecision::cpp_rational;
  Rational det, u, v, t;  ///< det is the pipe's, (D x E2).E1. u, v and t are not scaled by it; they
                          ///< are unset if it is 0

  template <class S>
  ExactHit(const cde::BasicRay<S>& ray, const cde::BasicTriangle<S>& triangle) {
    Rational e1[3], e2[3], d[3], s[3];
    for (int k = 0; k < 3; ++k) {
      const Rational v0(triangle.v0[k]);
      e1[k] = Rational(triangle.v1[k]) - v0;
      e2[k] = Rational(triangle.v2[k]) - v0;
      d[k] = Rational(ray.d[k]);
      s[k] = Rational(ray.o[k]) - v0;
    }
    det = determinant(e1, d, e2);  // E1.(D x E2)
    if (det == 0) return;
    u = determinant(s, d, e2) / det;
    v = determinant(e1, d, s) / det;  // s in the column of e2
    Rational minus_s[3] = {-s[0], -s[1], -s[2]};
    t = determinant(e1, minus_s, e2) / det;  // -s in the column of d
  }
  [[nodiscard]] bool inside() const { return det != 0 && u >= 0 && v >= 0 && u + v <= 1; }
  [[nodiscard]] bool hit(const cde::Ray& ray) const {
    return inside() && t >= Rational(ray.tmin) && (std::isinf(ray.tmax) || t <= Rational(ray.tmax));
  }

 private:
  static Rational determinant(const Rational (&a)[3], const Rational (&b)[3],
                              const Rational (&c)[3]) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
};
