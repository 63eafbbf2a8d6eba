// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/geometry/primitives.hpp"

namespace cde {

/// A-priori error bounds of the Möller-Trumbore pipe in fp32 (unit roundoff u = 2^-24). They bound
/// the distance of the computed quantities from the exact ones of the same ray and triangle. Valid
/// while nothing under- or overflows.
///
/// Each of det, u, v and t det is a sum of products. At most seven roundings affect a term. These
/// are edge or offset (1 in each of two factors, 2), inner product and difference (2), outer
/// product (1), two additions (2).
/// So |computed - exact| <= 7u/(1-7u) times the permanent: the same sum with every term taken
/// absolutely (Higham, Accuracy and Stability, section 3.1). All values are unscaled, as the pipe
/// compares them.
struct MollerBound {
  double det = 0;  ///< of det = P.E1
  double u = 0;    ///< of u det
  double v = 0;    ///< of v det
  double uv = 0;   ///< of (u + v) det, one more rounding
  double tn = 0;   ///< of t det

  /// Bound for t = tn/det, given the exact det and t; infinite where det may be 0.
  [[nodiscard]] double t(double exact_det, double exact_t) const;
  /// Bound for each coordinate of CP = O + t D, given the exact det and t.
  [[nodiscard]] double cp(const Ray& ray, double exact_det, double exact_t) const;
};

/// Bounds for one pair; both must be finite.
[[nodiscard]] MollerBound moller_bound(const Ray& ray, const Triangle& triangle);

}  // namespace cde
