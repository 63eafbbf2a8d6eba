#pragma once
#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

/// Geometric primitives as the card takes them: binary32 coordinates in one right-handed world
/// frame, in whatever length unit the scene uses. Every primitive is a plain value; `defect` says
/// whether the card would refuse it.
namespace cde {

/// P(t) = o + t d for tmin <= t <= tmax.
struct Ray {
  Eigen::Vector3f o;  ///< origin, finite
  Eigen::Vector3f d;  ///< direction, finite and not zero; need not be of unit length, so t counts
                      ///< in units of |d|
  float tmin = 0.0f;  ///< start of the interval; may be negative or infinite, never NaN
  float tmax = std::numeric_limits<float>::infinity();  ///< end, likewise; tmin > tmax is legal: an
                                                        ///< empty interval that meets nothing
};

/// Two-sided triangle; front and back hit alike. Any finite corners are legal: a triangle without
/// area is never hit.
struct Triangle {
  Eigen::Vector3f v0;
  Eigen::Vector3f v1;
  Eigen::Vector3f v2;
};

/// Why the card would flag this primitive as bad input ("direction is zero"), or nothing if it is
/// valid.
[[nodiscard]] std::optional<std::string> defect(const Ray& ray);
[[nodiscard]] std::optional<std::string> defect(const Triangle& triangle);

/// Throws Error(kBadInput, "WHAT: reason") if the primitive has a defect.
void check(const Ray& ray, std::string_view what);
void check(const Triangle& triangle, std::string_view what);

}  // namespace cde
