// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>

#include "cde/bvh/node.hpp"
#include "cde/reference/pipes/root_bounds.hpp"

/// A ray and the boxes of a node in fp32, with the margin M = 256 u R + 16 u W. The node in whole
/// numbers (cde/reference/integer_node.hpp) is compared with it.
namespace cde::testing {

/// A ray as nodes in fp32 use it.
struct FloatRay {
  FloatRay(const Eigen::Vector3f& o, const Eigen::Vector3f& d,
           const reference::RootBounds<float>& root) {
    const float margin = reference::reach<float>({o, o}, root) * 0x1p-16f + root.margin;
    for (int k = 0; k < 3; ++k) {
      above[k] = o[k] + margin;
      below[k] = o[k] - margin;
      inverse[k] = 1 / std::copysign(std::max(std::abs(d[k]), 0x1p-80f), d[k]);
    }
  }
  Eigen::Vector3f above, below, inverse;  // o + M, o - M, 1 / d
};

/// Interval of T in which a ray is in a child's box.
struct FloatInterval {
  float near, far;
};
inline FloatInterval float_interval(const FloatRay& ray, const bvh::Node& node, unsigned child) {
  FloatInterval all{-HUGE_VALF, HUGE_VALF};
  for (int k = 0; k < 3; ++k) {
    const float origin = node.origin()[k], unit = std::ldexp(ray.inverse[k], node.exponent(k));
    const bool down = std::signbit(ray.inverse[k]);
    const float lower = node.lower(child, k), upper = node.upper(child, k);
    const float near = (origin - (down ? ray.below[k] : ray.above[k])) * ray.inverse[k] +
                       (down ? upper : lower) * unit,
                far = (origin - (down ? ray.above[k] : ray.below[k])) * ray.inverse[k] +
                      (down ? lower : upper) * unit;
    all.near = std::max(all.near, near);
    all.far = std::min(all.far, far);
  }
  return all;
}

}  // namespace cde::testing
