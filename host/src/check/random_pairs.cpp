// SPDX-License-Identifier: Apache-2.0
#include "cde/check/random_pairs.hpp"

#include <Eigen/Geometry>

#include "cde/geometry/primitives.hpp"

namespace cde {
namespace {

/// The mean extent of a shape from its middle, over all directions.
float reach(Shape shape) {
  return with_shape<float>(shape, []<class P>() {
    if constexpr (requires { P::kReach; })
      return P::kReach;
    else
      return 0.0f;
  });
}

template <class P>
void append(std::vector<float>& to, const P& primitive) {
  const auto words = to_words(primitive);
  to.insert(to.end(), words.begin(), words.end());
}

/// Draws the parts of random shapes around a point. Each draw is a statement or an element in
/// braces; otherwise the compiler would choose their order.
struct Draws {
  std::mt19937_64& random;
  Eigen::Vector3f at = Eigen::Vector3f::Zero();

  float uniform(float low, float high) {
    return low + (high - low) * static_cast<float>(random() >> 40) * 0x1p-24f;
  }
  Eigen::Vector3f uniform3() {
    const float x = uniform(-1, 1), y = uniform(-1, 1);
    return {x, y, uniform(-1, 1)};
  }
  [[nodiscard]] Eigen::Vector3f point() const { return at; }
  float size() { return uniform(0.5f, 1.5f); }
  Eigen::Vector3f around(const Eigen::Vector3f& c) {
    const float distance = size();
    return c + distance * direction();
  }
  Eigen::Vector3f direction() {
    for (;;) {
      const Eigen::Vector3f v = uniform3();
      const float length = v.norm();
      if (length > 0.1f && length <= 1) return v / length;
    }
  }
  Eigen::Matrix3f rotation() {
    const Eigen::Vector3d z = direction().cast<double>().normalized();
    Eigen::Vector3d x = direction().cast<double>();
    while (x.cross(z).norm() < 0.1) x = direction().cast<double>();
    Eigen::Matrix3d r;
    r.col(1) = z.cross(x).normalized();
    r.col(0) = r.col(1).cross(z);
    r.col(2) = z;
    return r.cast<float>();
  }
  /// Appends a shape around the point and returns its middle.
  Eigen::Vector3f shape(Shape kind, std::vector<float>& to) {
    return with_shape<float>(kind, [&]<class P>() -> Eigen::Vector3f {
      const P drawn = P::random(*this);
      append(to, drawn);
      return drawn.middle();
    });
  }
};

}  // namespace

void RandomPairs::pair(Pair pair, std::vector<float>& a, std::vector<float>& b) {
  const Shape shape_a = primary_shape(pair), shape_b = secondary_shape(pair);
  Draws draws{random_};
  const Eigen::Vector3f center = 10 * draws.uniform3();
  draws.at = center;
  if (shape_a == Shape::kRay) {
    const Eigen::Vector3f middle = draws.shape(shape_b, b);
    const Eigen::Vector3f from = middle + 5 * draws.direction();
    // Aims past the middle of B by up to about twice its size. The factor 4/pi applies to points
    // along the ray.
    const float size = shape_b == Shape::kTriangle ? 0.25f : reach(shape_b);
    const float aside = draws.uniform(0, 2.5f * size);
    const Eigen::Vector3f at = middle + aside * draws.direction();
    append(a, Ray{from, at - from});
    return;
  }
  draws.shape(shape_a, a);
  if (shape_b == Shape::kPlane) {
    Plane plane = Plane::random(draws);
    plane.d += draws.uniform(-2, 2) * reach(shape_a);
    append(b, plane);
    return;
  }
  const float distance = draws.uniform(0, 2 * (reach(shape_a) + reach(shape_b)));
  draws.at = center + distance * draws.direction();
  draws.shape(shape_b, b);
}

}  // namespace cde
