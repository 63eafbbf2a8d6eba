// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "cde/oracle/cases.hpp"
#include "cde/oracle/shapes.hpp"

namespace cde::oracle {

/// The exact answer of a ray against a target, rounded to binary64 at the very end, and what a
/// tolerance needs to know about it.
///
/// F is decided on exact rationals (triangle) or on 512 significant bits (sphere, cylinder), which
/// hold every intermediate value of binary32 operands exactly unless their exponents are more than
/// about 60 apart. Targets are surfaces: a ray that starts inside reports its exit.
struct RayAnswer {
  bool hit = false;
  double t;  ///< smallest parameter with tmin <= t <= tmax, in units of |d|; +inf for a miss
  Vec point = Vec::Zero();  ///< o + t d, 0 for a miss
  double scale = 0;         ///< length: |o - c| and the target's own size; triangle: max |v - o|
  /// How far F is from flipping: a displacement of the ray or the target by less than
  /// margin * scale leaves it, to first order. With an arithmetic of unit roundoff u a fair band is
  /// a small multiple of u, fixed beforehand.
  double margin = 0;
  /// The same for T being the parameter of this crossing and not of another one. <= margin if hit.
  double margin_t = 0;
  /// |n.d| / |d| at the crossing (at a rim: the lesser of the two surfaces): a displacement by e
  /// moves T by e / (cosine |d|). 1 for a miss.
  double cosine = 1;
  /// Triangle: longest edge over least height, infinite without area; 1 for the solids. Algorithms
  /// that compute the plane from its edges lose this factor on needles: a test of their T passes
  /// tolerance * aspect.
  double aspect = 1;
};

/// Throws std::invalid_argument for a direction of zero, as do the others.
[[nodiscard]] RayAnswer cast(const Ray& ray, const Sphere& sphere);
[[nodiscard]] RayAnswer cast(const Ray& ray, const Cylinder& cylinder);
/// det = 0, so also a triangle without area, is a miss.
[[nodiscard]] RayAnswer cast(const Ray& ray, const Triangle& triangle);
/// Of a generated case of one of the three pairs.
[[nodiscard]] RayAnswer cast(const Case& ray_case);

/// Judgement on F and T of a ray pair.
struct RayVerdict {
  bool ok = true;
  bool excused = false;  ///< F differs inside the band, or T is that of another crossing inside it
  bool in_band = false;  ///< margin below the band
  double error_t = 0;    ///< |t - T| |d| cosine / scale: in displacements, comparable with u
  double error_point = 0;  ///< |point - CP| / (scale / cosine + largest coordinate)
  RayAnswer answer;
  [[nodiscard]] std::string describe() const;
};

/// F must be right if answer.margin > band; if hit and answer.margin_t > band, T and CP must be
/// within `tolerance` in the measures of error_t and error_point. Both are multiples of u that the
/// caller fixes beforehand. Near a tangent, where cosine < sqrt(band), T is only as good as
/// sqrt(tolerance): it is excused.
[[nodiscard]] RayVerdict check(const Ray& ray, const RayAnswer& answer, bool f, double t,
                               const Vec& cp, double band, double tolerance);

}  // namespace cde::oracle
