// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "cde/geometry/pair.hpp"
#include "cde/model/device.hpp"
#include "cde/query/counters.hpp"

/// Measures spheres against a BVH of spheres or OBBs, which is refitted.
namespace cde::cli {

/// Spheres find the nearest shape in a cube. All figures but refit_seconds are modelled.
struct CloudFigures {
  Shape shape = Shape::kSphere;          ///< in the BVH
  std::uint64_t secondaries = 0;         ///< in the BVH
  Counters packet, stream;               ///< 256 and 4,096 primaries
  std::uint64_t brute_force_cycles = 0;  ///< of the packet by brute force, same card
  unsigned lanes = 0;                    ///< of that pass
  double refit_seconds = 0;              ///< processor time of the host
  double bvh_upload_seconds = 0;         ///< over the bus
};

/// Measures 1,000 and 10,000 spheres and OBBs. Error kMismatch if a record differs from the
/// reference's traversal.
[[nodiscard]] std::vector<CloudFigures> measure_clouds(const Device& device);
[[nodiscard]] nlohmann::ordered_json clouds_json(const std::vector<CloudFigures>& figures,
                                                 const Device& device);
/// Prints the figures as text.
void show_clouds(const std::vector<CloudFigures>& figures, const Device& device);

}  // namespace cde::cli
