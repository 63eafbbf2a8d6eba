// SPDX-License-Identifier: Apache-2.0
#include "cde/oracle/build_shape.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "cde/oracle/cases.hpp"

namespace cde::oracle {
namespace {

double dimension(Random& random, const Build& build) {
  const double x = random.uniform(0.25, 1.5);
  return build.scale * (build.dyadic ? std::round(16 * x) / 16 : x);
}

Shape build_triangle(Random& random, const Frame& frame, const Build& build) {
  const double angle = random.uniform(0, 6.28), turn = random.uniform(1.5, 2.8);
  std::array<Vec, 3> v;
  for (int i = 0; i < 3; ++i) {
    const double r = dimension(random, build), phi = angle + i * turn;
    v[i] = Vec(r * std::cos(phi), r * std::sin(phi), 0);
    if (build.dyadic) v[i] = (16 * v[i]).array().round().matrix() / 16;
    v[i].y() *= build.thin;
  }
  if (build.plate) v[2] = v[0] + build.thin * (v[2] - v[0]);  // one short edge, not one low corner
  if (build.no_area) {
    // Still a segment, or a point, after rounding.
    const Vec e =
        build.scale * Vec{random.below(5) - 2., random.below(5) - 2., random.below(5) - 2.};
    const double t = 0.25 * (random.below(9) - 2);
    const Vec origin =
        build.scale / 4 * Vec{1. * random.below(5), 1. * random.below(5), 1. * random.below(5)};
    return Triangle{origin, origin + e, origin + t * e};
  }
  return Triangle{frame * v[0], frame * v[1], frame * v[2]};
}

Vec build_half_extents(Random& random, const Build& build) {
  Vec half{dimension(random, build), dimension(random, build), dimension(random, build)};
  const int which = random.below(3);
  for (int k = 0; k < 3; ++k)
    if ((k == which) == build.plate) half[k] *= build.thin;
  return half;
}

}  // namespace

Shape build_shape(Random& random, ShapeKind kind, const Frame& frame, const Build& build) {
  switch (kind) {
    case ShapeKind::kTriangle:
      return build_triangle(random, frame, build);
    case ShapeKind::kSphere:
      return Sphere{Vec::Zero(), dimension(random, build)};
    case ShapeKind::kPlane:
      return Plane{frame.col(2), 0};
    case ShapeKind::kAabb: {
      const Vec half = build_half_extents(random, build);
      return Aabb{-half, half};
    }
    case ShapeKind::kCylinder: {
      const double h = dimension(random, build), r = dimension(random, build);
      return Cylinder{Vec::Zero(), frame.col(2), h * (build.plate ? build.thin : 1),
                      r * (build.plate ? 1 : build.thin)};
    }
    case ShapeKind::kObb:
      return Obb{Vec::Zero(), build_half_extents(random, build), frame};
    case ShapeKind::kRay:
      break;
  }
  throw std::invalid_argument("a ray is not a convex operand");
}

Shape rounded(ShapeKind kind, const Shape& shape, const Format& format) {
  return shape_from_words(kind, to_words(shape, format));
}

double small_offset(Random& random, const Format& format) {
  const double least = std::max(1e-11, 1e-7 * (format.u() * 0x1p24));
  return random.either_sign(random.decades(least, std::max(1e-3, 30 * least)));
}

double farthest(const Format& format) {
  return 1e5 / (format.u() * 0x1p24);
}

}  // namespace cde::oracle
