// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <string_view>
#include <vector>

#include "cde/geometry/pair.hpp"

namespace cde {

/// Random shapes of about unit size, B placed at random so that about half of the pairs hit. What
/// they are depends on the seed alone.
class RandomPairs {
 public:
  explicit RandomPairs(std::uint64_t seed) : random_(seed) {}

  /// Appends the words of a pair.
  void pair(Pair pair, std::vector<float>& a, std::vector<float>& b);

 private:
  Eigen::Vector3f shape(std::string_view kind, const Eigen::Vector3f& c, std::vector<float>& to);
  float uniform(float low, float high);
  Eigen::Vector3f uniform3();
  float size();
  Eigen::Vector3f corner(const Eigen::Vector3f& c);
  Eigen::Vector3f size3();
  Eigen::Vector3f direction();
  Eigen::Matrix3f rotation();

  std::mt19937_64 random_;
};

}  // namespace cde
