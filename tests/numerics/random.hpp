// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>

namespace cde::testing {

/// Random numbers that are the same in every run.
class Random {
 public:
  static constexpr unsigned kSeed = 20070129;
  explicit Random(unsigned seed = kSeed) : bits_(seed) {}

  std::uint32_t word() { return static_cast<std::uint32_t>(bits_()); }
  /// A number in [0, 1).
  double unit() { return static_cast<double>(bits_() >> 11) * 0x1p-53; }
  double between(double lo, double hi) { return lo + (hi - lo) * unit(); }
  double sign() { return (bits_() & 1) != 0 ? 1 : -1; }
  bool chance(double share) { return unit() < share; }
  /// Magnitudes spread evenly over the decades 10^lo to 10^hi.
  double decades(double lo, double hi) { return std::pow(10.0, between(lo, hi)); }
  std::size_t below(std::size_t n) { return bits_() % n; }
  /// An integer in lo..hi.
  int integer(int lo, int hi) {
    return lo + static_cast<int>(below(static_cast<unsigned>(hi - lo + 1)));
  }

  /// A point in the cube from -1 to 1.
  Eigen::Vector3d vector() { return {between(-1, 1), between(-1, 1), between(-1, 1)}; }
  Eigen::Vector3d integers(int most) {
    return {double(integer(-most, most)), double(integer(-most, most)),
            double(integer(-most, most))};
  }
  /// A unit vector.
  Eigen::Vector3d direction() {
    for (;;) {
      const Eigen::Vector3d v(between(-1, 1), between(-1, 1), between(-1, 1));
      if (v.norm() < 1 && v.norm() > 0.1) return v.normalized();
    }
  }
  /// A unit vector perpendicular to the axis.
  Eigen::Vector3d across(const Eigen::Vector3d& axis) {
    return axis.cross(direction()).normalized();
  }

 private:
  std::mt19937_64 bits_;
};

}  // namespace cde::testing
