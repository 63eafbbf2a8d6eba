// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>

namespace cde::oracle {

/// splitmix64: gives the same cases on every machine and with every standard library.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t stream, std::uint64_t index)
      : state_(mix(mix(mix(seed) + stream) + index)) {}

  std::uint64_t bits() { return mix(state_ += 0x9e3779b97f4a7c15); }
  /// In [0, 1).
  double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  double uniform(double lo, double hi) { return lo + (hi - lo) * unit(); }
  /// lo <= x < hi with equal weight on every decade; both > 0.
  double decades(double lo, double hi) { return lo * std::pow(hi / lo, unit()); }
  int below(int n) { return static_cast<int>(unit() * n); }
  double sign() { return bits() >> 63 ? 1.0 : -1.0; }
  double either_sign(double x) { return sign() * x; }
  Eigen::Vector3d flipped(const Eigen::Vector3d& v) { return sign() * v; }
  bool chance(double p) { return unit() < p; }
  Eigen::Vector3d direction() {
    for (;;) {
      const double x = uniform(-1, 1), y = uniform(-1, 1), z = uniform(-1, 1);
      const Eigen::Vector3d v(x, y, z);
      const double length = v.norm();
      if (length > 0.1 && length <= 1) return v / length;
    }
  }
  Eigen::Matrix3d rotation() {
    const Eigen::Vector3d z = direction();
    Eigen::Vector3d x = direction();
    while (x.cross(z).norm() < 0.1) x = direction();
    Eigen::Matrix3d r;
    r.col(2) = z;
    r.col(1) = z.cross(x).normalized();
    r.col(0) = r.col(1).cross(z);
    return r;
  }
  /// One of the 24 rotations that map the axes onto themselves.
  Eigen::Matrix3d quarter_turns() {
    const int first = below(3);
    const int second = (first + 1 + below(2)) % 3;
    Eigen::Matrix3d r = Eigen::Matrix3d::Zero();
    r(first, 0) = sign();
    r(second, 1) = sign();
    r.col(2) = r.col(0).cross(r.col(1));
    return r;
  }

 private:
  static std::uint64_t mix(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  }
  std::uint64_t state_;
};

}  // namespace cde::oracle
