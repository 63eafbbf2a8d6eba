// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "cde/accuracy/tally.hpp"

/// Rays at triangles of which one thing changes at a time.
namespace cde::accuracy {

/// What changes, and its values.
struct ProfileAxis {
  std::string_view name, title, x_name;
  double first, last;
};
/// "grazing_angle", "triangle_size", "origin_distance", "aspect".
[[nodiscard]] const std::vector<ProfileAxis>& profile_axes();

struct ProfilePoint {
  double x = 0;
  std::uint64_t met = 0;     ///< rays that meet the triangle exactly, and are not refused
  std::uint64_t missed = 0;  ///< of them those that the pipe says miss
  ErrorCounts error = {};    ///< |t - T| / T of the others
};
struct Profile {
  AccuracyPipe pipe;
  std::string_view along;
  std::vector<ProfilePoint> points;
};

/// Of each ray-triangle pipe among them without the box rule, which does not change T: so many rays
/// at each value, the same ones for every pipe but for rounding, each aimed at the inside of its
/// triangle.
[[nodiscard]] std::vector<Profile> profiles(const std::vector<AccuracyPipe>& pipes,
                                            std::uint64_t seed, std::uint64_t cases, bool quiet);

[[nodiscard]] nlohmann::ordered_json profiles_json(const std::vector<Profile>& all);

}  // namespace cde::accuracy
