// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <random>
#include <span>
#include <string>
#include <vector>

#include "board_configs.hpp"
#include "cde/card/board.hpp"
#include "cde/reference/reference.hpp"
#include "cde/support/error.hpp"

namespace cde::testing {

inline constexpr std::uint32_t kSeed = 20240611;

/// The random generator of a test; prints its seed. std::mt19937 is the same on every platform.
/// Standard distributions are not, so this class makes the numbers itself.
class Random {
 public:
  explicit Random(std::uint32_t seed = kSeed);
  std::uint32_t bits() { return engine_(); }
  std::uint32_t below(std::uint32_t n) {
    return static_cast<std::uint32_t>(std::uint64_t{bits()} * n >> 32);
  }
  float in(float low, float high) {
    return low + (high - low) * (static_cast<float>(bits() >> 8) * 0x1p-24f);
  }
  Eigen::Vector3f in_box(float half) { return {in(-half, half), in(-half, half), in(-half, half)}; }

 private:
  std::mt19937 engine_;
};

struct RayScene {
  std::vector<Ray> rays;
  std::vector<Triangle> triangles;
};

/// Rays of a beam along +z and triangles across it, such that about half of the pairs hit.
RayScene beam(Random& random, std::size_t rays, std::size_t triangles, float scale = 1.0f);

/// Small triangles scattered around the origin: a ray hits few of them.
RayScene cloud(Random& random, std::size_t rays, std::size_t triangles);

/// Every directed case of the pipe. Rays pass through corners and edges and in the plane. Intervals
/// end on the hit or one ulp beside it. Triangles are degenerate, and words hold zeros with both
/// signs, subnormal, huge and special values.
RayScene directed();

/// Pairs of the first record that differs, one per line, in the format of `cde explain
/// --from-test`. The lines name gates, whose bits equal both arithmetic back ends.
std::string explain_lines(const reference::Checker& checker);

/// Runs a cast on the board and compares every record with the reference; returns the records.
std::vector<Record> cast_and_compare(Board& board, const RayScene& scene, const Query& query,
                                     Counters* counters = nullptr);

}  // namespace cde::testing
