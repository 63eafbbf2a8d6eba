// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <random>
#include <vector>

#include "cde/geometry/pair.hpp"

namespace cde {

/// Random shapes of about unit size. B is placed so that about half of the pairs hit. The pairs
/// depend on the seed alone.
class RandomPairs {
 public:
  explicit RandomPairs(std::uint64_t seed) : random_(seed) {}

  /// Appends the words of a pair.
  void pair(Pair pair, std::vector<float>& a, std::vector<float>& b);

 private:
  std::mt19937_64 random_;
};

}  // namespace cde
