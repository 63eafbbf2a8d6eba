// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "cde/accuracy/tally.hpp"

/// @file
/// Rays at triangles with one property varied at a time.
namespace cde::accuracy {

/// The varied property and its range.
struct ProfileAxis {
  std::string_view name, title, x_name;
  double first, last;
};
/// "grazing_angle", "triangle_size", "origin_distance", "aspect".
[[nodiscard]] const std::vector<ProfileAxis>& profile_axes();

struct ProfilePoint {
  double x = 0;
  std::uint64_t met = 0;     ///< rays that hit the triangle exactly, and are not refused
  std::uint64_t missed = 0;  ///< hits that the pipe reports as misses
  ErrorCounts error = {};    ///< |t - T| / T of the other hits
};
struct Profile {
  AccuracyPipe pipe;
  std::string_view along;
  std::vector<ProfilePoint> points;
};

/// A profile for each algorithm and format of the ray-triangle pipes, without the box rule, which
/// does not change T. Each value gets `cases` rays, each aimed at the inside of its triangle. All
/// pipes get the same rays, except for rounding.
[[nodiscard]] std::vector<Profile> profiles(const std::vector<AccuracyPipe>& pipes,
                                            std::uint64_t seed, std::uint64_t cases, bool quiet);

[[nodiscard]] nlohmann::ordered_json profiles_json(const std::vector<Profile>& all);

}  // namespace cde::accuracy
