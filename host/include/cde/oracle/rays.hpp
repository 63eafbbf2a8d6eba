// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "cde/oracle/cases.hpp"
#include "cde/oracle/shapes.hpp"

namespace cde::oracle {

/// The exact result of a ray against a target, rounded to binary64 at the very end, and figures for
/// tolerances.
///
/// F is decided on exact rationals (triangle) or on 512 significant bits (sphere, cylinder). These
/// hold every intermediate value of binary32 operands exactly unless exponents differ by more than
/// about 60. Targets are surfaces: a ray that starts inside reports its exit.
struct RayAnswer {
  bool hit = false;
  double t;  ///< smallest parameter with tmin <= t <= tmax, in units of |d|; +inf for a miss
  Vec point = Vec::Zero();  ///< o + t d, 0 for a miss
  double scale = 0;         ///< length: |o - c| and the target's own size; triangle: max |v - o|
  /// How far F is from flipping. To first order, F stays if ray or target is displaced by less than
  /// margin * scale. For arithmetic of unit roundoff u a fair band is a small multiple of u, fixed
  /// in advance.
  double margin = 0;
  /// The same for T to stay at this crossing instead of another. <= margin for a hit.
  double margin_t = 0;
  /// |n.d| / |d| at the crossing; at a rim the smaller value of the two surfaces. A displacement by
  /// e moves T by e / (cosine |d|). 1 for a miss.
  double cosine = 1;
  /// For a triangle the longest edge over the smallest height, infinite without area; 1 for solids.
  /// Algorithms that compute the plane from the edges lose this factor on needles. A test of their
  /// T passes tolerance * aspect.
  double aspect = 1;
};

/// Throws std::invalid_argument for a zero direction, as do the overloads.
[[nodiscard]] RayAnswer cast(const Ray& ray, const Sphere& sphere);
[[nodiscard]] RayAnswer cast(const Ray& ray, const Cylinder& cylinder);
/// det = 0 is a miss; this includes a triangle without area.
[[nodiscard]] RayAnswer cast(const Ray& ray, const Triangle& triangle);
/// Result for a generated case of one of the ray pairs.
[[nodiscard]] RayAnswer cast(const Case& ray_case);

/// Check of F and T of a ray pair.
struct RayDecision {
  bool ok = true;
  bool excused = false;    ///< within the band, F differs or T belongs to another crossing
  bool in_band = false;    ///< margin below the band
  double error_t = 0;      ///< |t - T| |d| cosine / scale: as a displacement, comparable with u
  double error_point = 0;  ///< |point - CP| / (scale / cosine + largest coordinate)
  RayAnswer answer;
  [[nodiscard]] std::string describe() const;
};

/// F must be right if answer.margin > band. If it is a hit with answer.margin_t > band, T and CP
/// must be within `tolerance` in the measures of error_t and error_point. The caller fixes both as
/// multiples of u in advance. Near a tangent, where cosine < sqrt(band), T is only as good as
/// sqrt(tolerance); it is excused.
[[nodiscard]] RayDecision check(const Ray& ray, const RayAnswer& answer, bool f, double t,
                                const Vec& cp, double band, double tolerance);

}  // namespace cde::oracle
