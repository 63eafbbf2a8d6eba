// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include "cde/oracle/format.hpp"
#include "cde/oracle/random.hpp"
#include "cde/oracle/shapes.hpp"

namespace cde::oracle {

/// Proportions of a random shape.
struct Build {
  double scale = 1;  ///< of all dimensions, which are 0.25 to 1.5 times this
  double thin = 1;   ///< factor of one dimension (plate) or of all but one (needle)
  bool plate = false;
  bool dyadic = false;   ///< dimensions are multiples of scale / 16
  bool no_area = false;  ///< a triangle is a segment or a point, also after rounding
};

/// Draws lengths: integers if `whole`, else real numbers.
struct Lengths {
  Random random;
  bool whole = true;

  /// A length from about `least` to `most`.
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

/// A random shape about the origin. The frame's last column is a cylinder's axis or a plane's
/// normal; the first two span a triangle. Throws std::invalid_argument for a ray.
[[nodiscard]] Shape build_shape(Random& random, ShapeKind kind, const Frame& frame,
                                const Build& build);

/// The shape with each word rounded to the format.
[[nodiscard]] Shape rounded(ShapeKind kind, const Shape& shape, const Format& format);

/// A signed distance near the decision, relative to the scene. In binary32 its size is 1e-7 to
/// 1e-3, that is, from the rounding error of a coordinate upwards. Other formats start at the same
/// multiple of their unit roundoff u; below it both sides round to contact, a hit. They start at
/// 1e-11 or more, the accuracy of the signed distance that placed the shapes. Their range spans at
/// least a factor of thirty.
[[nodiscard]] double small_offset(Random& random, const Format& format);

/// Largest distance of a scene from the world's origin: 1e5 in binary32. In other formats the
/// rounding of coordinates distorts shapes equally little.
[[nodiscard]] double farthest(const Format& format);

}  // namespace cde::oracle
