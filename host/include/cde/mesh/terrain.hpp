// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "cde/mesh/mesh.hpp"

namespace cde {

/// A landscape of ridges and branching valleys as a regular grid of quads, two triangles each.
struct TerrainOptions {
  std::uint32_t quads_x = 291;  ///< columns of quads, 1 to 4096, to the east (+x)
  std::uint32_t quads_y =
      446;  ///< rows of quads, 1 to 4096, to the north (+y); 291 x 446 quads are 259,572 triangles
  std::uint32_t seed = 1;  ///< another seed, another landscape
};

/// Frame: metres, z up, corner (0, 0) at the origin, 10 m per quad; heights from 0 to 360 m. Faces
/// wind counter-clockwise as seen from above. They are ordered row by row from the south, west to
/// east. Every compiler makes the same bits: the heights use only an integer hash and the binary64
/// operations + - * / sqrt. libm and the standard distributions would not. Error kUsage if a size
/// is out of range.
[[nodiscard]] Mesh make_terrain(const TerrainOptions& options = {});

}  // namespace cde
