// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "cde/geometry/pair.hpp"
#include "cde/mesh/mesh.hpp"
#include "cde/model/device.hpp"
#include "cde/query/counters.hpp"

/// Measures spheres and OBBs against a BVH of triangles: a card with traversal units, and FCL on
/// the same solids.
namespace cde::cli {

/// One question to a card: whether a solid touches the mesh, or which triangle is nearest and at
/// which distance or depth. All figures but fcl_seconds are modelled.
struct SolidCard {
  std::string_view question;          ///< "touches" or "nearest"
  Counters one;                       ///< one solid by itself, mean of several
  Counters packet;                    ///< a packet of 256
  Counters stream;                    ///< a stream of 4,096
  std::optional<double> fcl_seconds;  ///< measured: collide() or distance()
};

/// The figures of one shape and size.
struct SolidFigures {
  Shape shape = Shape::kSphere;
  double quads = 0;     ///< radius or half-extent, in quads of the terrain
  double touching = 0;  ///< share of touching solids
  std::vector<SolidCard> cards;
};

/// `quick`: only spheres, whose card is built faster. Error kMismatch if a record differs from the
/// reference's traversal, or from FCL.
[[nodiscard]] std::vector<SolidFigures> measure_solids(const Mesh& terrain, const Device& device,
                                                       bool quick);
[[nodiscard]] nlohmann::ordered_json solids_json(const std::vector<SolidFigures>& figures,
                                                 const Device& device);
/// Prints the figures as text.
void show_solids(const std::vector<SolidFigures>& figures, const Device& device);

}  // namespace cde::cli
