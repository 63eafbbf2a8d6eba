// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "cde/geometry/pair.hpp"
#include "cde/mesh/mesh.hpp"
#include "cde/query/counters.hpp"

/// Spheres and OBBs through a hierarchy: a card with node units beside FCL on the same solids.
namespace cde::cli {

/// One question to a card, all of it modelled: whether a solid meets the mesh, or which triangle is
/// nearest and how near or deep it is.
struct SolidCard {
  std::string_view question;          ///< "touches" or "nearest"
  Counters one;                       ///< a solid by itself, the mean of some
  Counters packet;                    ///< 256
  Counters stream;                    ///< 4,096
  std::optional<double> fcl_seconds;  ///< collide(), or distance(); measured
};

/// Of one shape and size.
struct SolidFigures {
  Shape shape = Shape::kSphere;
  double quads = 0;     ///< radius or half extent, in quads of the terrain
  double touching = 0;  ///< share
  std::vector<SolidCard> cards;
};

/// `quick`: spheres alone, whose card is sooner built. Error kMismatch if a record differs from the
/// reference's way, or FCL finds something else.
[[nodiscard]] std::vector<SolidFigures> measure_solids(const Mesh& terrain, double clock_hz,
                                                       bool quick);
[[nodiscard]] nlohmann::ordered_json solids_json(const std::vector<SolidFigures>& figures,
                                                 double clock_hz);
/// On stdout, for people.
void show_solids(const std::vector<SolidFigures>& figures, double clock_hz);

}  // namespace cde::cli
