// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "cde/mesh/mesh.hpp"

namespace cde {

/// A landscape of ridges and branching valleys as a regular grid of quads, two triangles each.
struct TerrainOptions {
  std::uint32_t quads_x = 291;  ///< 1 to 4096, to the east (+x)
  std::uint32_t quads_y =
      446;                 ///< 1 to 4096, to the north (+y); 291 x 446 quads are 259,572 triangles
  std::uint32_t seed = 1;  ///< another seed, another landscape
};

/// Frame: metres, z up, corner (0, 0) at the origin, 10 m a quad; heights from 0 to 360 m. Faces
/// wind counter-clockwise seen from above, row by row from the south, west to east. Built from an
/// integer hash and the operations
/// + - * / sqrt in binary64 only, so that every compiler makes the same bits (not true of libm or
/// of the standard distributions). Error kUsage if a size is out of range.
[[nodiscard]] Mesh make_terrain(const TerrainOptions& options = {});

}  // namespace cde
