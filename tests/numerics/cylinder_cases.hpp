// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "cde/oracle/oracle.hpp"
#include "cde/reference/pipes/cylinder/pairs.hpp"

/// Operands of the cylinder pairs that oracle::generate does not make. Each is a function of the
/// pair and the index; the seed is kCylinderSeed.
namespace cde::testing {

inline constexpr std::uint64_t kCylinderSeed = 20070129;

/// A primary about the origin: extents of 0.2 to 2, any orientation.
[[nodiscard]] oracle::Shape random_primary(oracle::Pair pair, std::uint64_t seed);

/// Near contact with the best normal 1e-4 to 3.4 degrees off a cap's axis. A cap meets a cap, a
/// face or a vertex, mostly nearly parallel, with crossing rims and edges. A search that samples
/// the sphere of normals uniformly stalls here.
[[nodiscard]] oracle::Case near_cap(oracle::Pair pair, std::uint64_t index);

/// Everyday scenes: an axis-aligned box, triangle or cylinder and an upright cylinder, apart,
/// touching or overlapping. Index % 9 is the family: grid or real numbers, tilted by 1e-7 to 1e-2
/// radian, rotated together, moved into contact.
[[nodiscard]] oracle::Case upright(oracle::Pair pair, std::uint64_t index);

/// The same shapes with a corner of A on B's rim, up to rounding. Between cylinders the corner is a
/// point of A's rim. The signed distance is 0 unless they overlap elsewhere. Index % 4 is the
/// family: on a grid of 1, with a rim point off the axes, rotated together, real and rotated.
[[nodiscard]] oracle::Case on_a_rim(oracle::Pair pair, std::uint64_t index);

/// The signed distance of a pipe's answer, negative when the bodies overlap.
template <typename S>
[[nodiscard]] double signed_distance_of(const reference::Outcome<S>& outcome) {
  const double t = static_cast<double>(outcome.t);
  return outcome.f ? -t : t;
}

}  // namespace cde::testing
