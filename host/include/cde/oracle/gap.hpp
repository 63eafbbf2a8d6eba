// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/oracle/shapes.hpp"

namespace cde::oracle {

/// What is known about the signed gap of a pair: lo <= s <= hi, certified.
struct Gap {
  double lo, hi;
  Vec n;                 ///< unit, A to B; g(n) is lo up to the slack
  bool converged;        ///< hi - lo is within the tolerance asked for
  long evaluations = 0;  ///< of the pair of support functions

  [[nodiscard]] double middle() const { return (lo + hi) / 2; }
};

struct GapOptions {
  double tolerance = 1e-8;         ///< wanted hi - lo, relative to scene_size
  long max_evaluations = 1000000;  ///< afterwards the interval is as wide as it is, and still right
};

/// g(n) = -h_B(-n) - h_A(n): the gap of the two projections on n, a lower bound of the signed gap
/// for every unit n. n is normalised first. Relative to A's centre, so it does not depend on where
/// the scene stands.
[[nodiscard]] double gap_along(const Shape& a, const Shape& b, const Vec& n);

/// The signed gap s = max g(n) over all unit n: the distance if positive, else minus the
/// penetration depth. No two planes (throws std::invalid_argument).
///
/// Lower bounds are values of g. Upper bounds need nothing but points y = b - a of the Minkowski
/// difference: every n has g(n) <= n.y, so if the shapes are apart s <= |y|, and over a cap of unit
/// normals of angular radius rho about n0, max g <= |y| cos(max(0, angle(n0, y) - rho)). The sphere
/// of normals is divided into such caps, best first, until no cap can hold anything above the best
/// g + tolerance. Radii of spheres are taken out beforehand and planes and cylinders with the very
/// same axis are closed forms. Rounding is covered by a slack of 64 * 2^-53 * scene_size on either
/// side: a support value is a sum of at most eight rounded terms none of which exceeds scene_size.
[[nodiscard]] Gap signed_gap(const Shape& a, const Shape& b, const GapOptions& options = {});

}  // namespace cde::oracle
