// SPDX-License-Identifier: Apache-2.0
#include "cde/check/random_pairs.hpp"

#include <Eigen/Geometry>

#include "cde/geometry/primitives.hpp"

namespace cde {
namespace {

/// How far a shape of its kind reaches from its middle, in the mean over directions.
float reach(std::string_view shape) {
  if (shape == "triangle") return 0.5f;
  if (shape == "sphere") return 1.0f;
  return 1.3f;
}

template <class P>
void append(std::vector<float>& to, const P& primitive) {
  const auto words = to_words(primitive);
  to.insert(to.end(), words.begin(), words.end());
}

}  // namespace

void RandomPairs::pair(Pair pair, std::vector<float>& a, std::vector<float>& b) {
  const std::string_view both = name(pair);
  const std::string_view shape_a = both.substr(0, both.find('-')),
                         shape_b = both.substr(both.find('-') + 1);
  const Eigen::Vector3f center = 10 * uniform3();
  if (shape_a == "ray") {
    const Eigen::Vector3f middle = shape(shape_b, center, b);
    const Eigen::Vector3f from = middle + 5 * direction();
    // Past the middle of B by up to about twice its size; 4/pi is for what points along the ray.
    const float size = shape_b == "triangle" ? 0.25f : reach(shape_b);
    const float aside = uniform(0, 2.5f * size);
    const Eigen::Vector3f at = middle + aside * direction();
    append(a, Ray{from, at - from});
    return;
  }
  shape(shape_a, center, a);
  if (shape_b == "plane") {
    const Eigen::Vector3f n = direction();
    append(b, Plane{n, n.dot(center) + uniform(-2, 2) * reach(shape_a)});
    return;
  }
  const float distance = uniform(0, 2 * (reach(shape_a) + reach(shape_b)));
  shape(shape_b, center + distance * direction(), b);
}

/// Appends a shape about c and returns its middle.
Eigen::Vector3f RandomPairs::shape(std::string_view kind, const Eigen::Vector3f& c,
                                   std::vector<float>& to) {
  if (kind == "triangle") {
    const Eigen::Vector3f v0 = corner(c), v1 = corner(c), v2 = corner(c);
    append(to, Triangle{v0, v1, v2});
    return (v0 + v1 + v2) / 3;
  }
  if (kind == "sphere") {
    append(to, Sphere{c, size()});
  } else if (kind == "aabb") {
    const Eigen::Vector3f half = size3();
    append(to, Aabb{c - half, c + half});
  } else if (kind == "cylinder") {
    const Eigen::Vector3f axis = direction();
    const float half_height = size();
    append(to, Cylinder{c, axis, half_height, size()});
  } else {
    const Eigen::Vector3f half = size3();
    append(to, Obb{c, half, rotation()});
  }
  return c;
}

// Draws are in statements or braces of their own: elsewhere their order is the compiler's.
float RandomPairs::uniform(float low, float high) {
  return low + (high - low) * static_cast<float>(random_() >> 40) * 0x1p-24f;
}
Eigen::Vector3f RandomPairs::uniform3() {
  const float x = uniform(-1, 1), y = uniform(-1, 1);
  return {x, y, uniform(-1, 1)};
}
float RandomPairs::size() {
  return uniform(0.5f, 1.5f);
}
Eigen::Vector3f RandomPairs::corner(const Eigen::Vector3f& c) {
  const float distance = size();
  return c + distance * direction();
}
Eigen::Vector3f RandomPairs::size3() {
  const float x = size(), y = size();
  return {x, y, size()};
}
Eigen::Vector3f RandomPairs::direction() {
  for (;;) {
    const Eigen::Vector3f v = uniform3();
    const float length = v.norm();
    if (length > 0.1f && length <= 1) return v / length;
  }
}
Eigen::Matrix3f RandomPairs::rotation() {
  const Eigen::Vector3d z = direction().cast<double>().normalized();
  Eigen::Vector3d x = direction().cast<double>();
  while (x.cross(z).norm() < 0.1) x = direction().cast<double>();
  Eigen::Matrix3d r;
  r.col(1) = z.cross(x).normalized();
  r.col(0) = r.col(1).cross(z);
  r.col(2) = z;
  return r.cast<float>();
}

}  // namespace cde
