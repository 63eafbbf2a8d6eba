// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include "cde/oracle/format.hpp"
#include "cde/oracle/random.hpp"
#include "cde/oracle/shapes.hpp"

namespace cde::oracle {

/// How the proportions of a random shape are drawn.
struct Build {
  double scale = 1;  ///< of all dimensions, which are 0.25 to 1.5 of it
  double thin = 1;   ///< factor of one dimension (plate) or of all but one (needle)
  bool plate = false;
  bool dyadic = false;   ///< dimensions are multiples of scale / 16
  bool no_area = false;  ///< a triangle is a segment or a point, still so after rounding
};

/// Draws lengths: whole numbers if `whole`, else real numbers.
struct Lengths {
  Random random;
  bool whole = true;

  /// From about `least` to `most`.
  double length(double least, double most) {
    const double x = random.uniform(least, most);
    return whole ? std::max(1.0, std::round(x)) : x;
  }
  double coordinate(double reach) {
    const double x = random.uniform(-reach, reach);
    return whole ? std::round(x) : x;
  }
  Vec point(double reach) {
    const double x = coordinate(reach), y = coordinate(reach), z = coordinate(reach);
    return {x, y, z};
  }
};

/// About the origin; the frame's last column is a cylinder's axis and a plane's normal, the first
/// two span a triangle. Throws std::invalid_argument for a ray.
[[nodiscard]] Shape build_shape(Random& random, ShapeKind kind, const Frame& frame,
                                const Build& build);

/// Each word rounded to the format.
[[nodiscard]] Shape rounded(ShapeKind kind, const Shape& shape, const Format& format);

/// How far from the decision, in units of the scene, with a sign: 1e-7 to 1e-3 in binary32, that is
/// from the rounding error of a coordinate upwards. Other formats start at as many times their unit
/// roundoff u (below that both sides round to contact, a hit), but not under 1e-11, where the
/// signed gap that placed the shapes ends; and go up to thirtyfold at least.
[[nodiscard]] double small_offset(Random& random, const Format& format);

/// No scene is moved farther from the world's origin than 1e5 in binary32, and others so far that
/// the rounding of coordinates spoils the shapes as little.
[[nodiscard]] double farthest(const Format& format);

}  // namespace cde::oracle
