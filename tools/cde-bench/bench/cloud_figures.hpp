// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "cde/geometry/pair.hpp"
#include "cde/query/counters.hpp"

/// Spheres among spheres and among OBBs, through a hierarchy over these, which is refitted.
namespace cde::cli {

/// Spheres that look for the nearest of others, which fill a cube; all of it modelled but for one
/// figure.
struct CloudFigures {
  Shape shape = Shape::kSphere;    ///< of what is in the tree
  std::uint64_t secondaries = 0;   ///< there
  Counters packet, stream;         ///< of 256 primaries, of 4,096
  std::uint64_t swept_cycles = 0;  ///< of the packet without the tree, on the same card
  unsigned lanes = 0;              ///< of that
  double refit_seconds = 0;        ///< of the host: processor time
  double tree_upload_seconds = 0;  ///< over the bus
};

/// Of spheres and OBBs, 1,000 and 10,000 of each. Error kMismatch if a record differs from the
/// reference's way.
[[nodiscard]] std::vector<CloudFigures> measure_clouds(double clock_hz);
[[nodiscard]] nlohmann::ordered_json clouds_json(const std::vector<CloudFigures>& figures,
                                                 double clock_hz);
/// On stdout, for people.
void show_clouds(const std::vector<CloudFigures>& figures, double clock_hz);

}  // namespace cde::cli
