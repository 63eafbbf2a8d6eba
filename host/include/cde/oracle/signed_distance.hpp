// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/oracle/shapes.hpp"

namespace cde::oracle {

/// Certified bounds of the signed distance s of a pair: lo <= s <= hi.
struct SignedDistance {
  double lo, hi;
  Vec n;                 ///< unit, A to B; g(n) is lo up to the slack
  bool converged;        ///< hi - lo is within the requested tolerance
  long evaluations = 0;  ///< number of evaluated pairs of support functions

  [[nodiscard]] double middle() const { return (lo + hi) / 2; }
};

struct DistanceOptions {
  double tolerance = 1e-8;         ///< target for hi - lo, relative to scene_size
  long max_evaluations = 1000000;  ///< then the interval is wider, but still valid
};

/// g(n) = -h_B(-n) - h_A(n): the distance between the two projections on n, a lower bound of the
/// signed distance for every unit n. n is normalised first. It is computed relative to A's centre,
/// so it does not depend on the position of the scene.
[[nodiscard]] double distance_along(const Shape& a, const Shape& b, const Vec& n);

/// The signed distance s = max g(n) over all unit n: the distance if positive, else minus the
/// penetration depth. Throws std::invalid_argument for two planes.
///
/// Lower bounds are values of g. Upper bounds need only points y = b - a of the Minkowski
/// difference, because g(n) <= n.y for every n. If the shapes are apart, s <= |y|. Over a cap of
/// unit normals of angular radius rho about n0, max g <= |y| cos(max(0, angle(n0, y) - rho)).
///
/// The sphere of normals is divided into such caps, best first, until no cap can exceed the best g
/// + tolerance. Radii of spheres are removed beforehand. Planes, and cylinders with exactly the
/// same axis, have closed forms. A slack of 64 * 2^-53 * scene_size on either side covers rounding:
/// a support value is a sum of at most eight rounded terms, none above scene_size.
[[nodiscard]] SignedDistance signed_distance(const Shape& a, const Shape& b,
                                             const DistanceOptions& options = {});

}  // namespace cde::oracle
