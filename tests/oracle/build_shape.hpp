#pragma once
#include "random.hpp"
#include "shapes.hpp"

namespace cde::oracle {

using Frame = Eigen::Matrix3d;  ///< columns: the axes of a shape in the world

/// How the proportions of a random shape are drawn.
struct Build {
  double scale = 1;  ///< of all dimensions, which are 0.25 to 1.5 of it
  double thin = 1;   ///< factor of one dimension (plate) or of all but one (needle)
  bool plate = false;
  bool dyadic = false;   ///< dimensions are multiples of scale / 16
  bool no_area = false;  ///< a triangle is a segment or a point, still so after rounding
};

/// About the origin; the frame's last column is a cylinder's axis and a plane's normal, the first
/// two span a triangle. Throws std::invalid_argument for a ray.
[[nodiscard]] Shape build_shape(Random& random, ShapeKind kind, const Frame& frame,
                                const Build& build);

/// Each word rounded to binary32.
[[nodiscard]] Shape rounded(ShapeKind kind, const Shape& shape);

}  // namespace cde::oracle
