// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "bench/measured.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/mesh/mesh.hpp"

namespace cde::cli {

/// FCL's results for solids against a mesh (BVHModel<OBBRSS>, binary64, one thread).
struct FclOnMesh {
  std::vector<double> touches;    ///< 1 or 0: collide() with one contact
  std::vector<double> distances;  ///< 0 or less where they overlap
  double collide_seconds = 0;     ///< processor time per solid: median over repeated runs of all
  double distance_seconds = 0;
};

/// `words` are spheres or OBBs, in slot order. Runs in a child process, because an assertion of FCL
/// ends the process. Returns nothing after an assertion, or in a build without FCL.
[[nodiscard]] std::optional<FclOnMesh> measure_fcl_mesh(const Mesh& mesh, Shape shape,
                                                        std::span<const float> words);

/// FCL's results for meshes against one mesh, each with a model of its own. `contacts`: pairs of
/// triangles that touch.
struct FclMeshes {
  std::vector<double> contacts, distances;
  double touch_seconds = 0;  ///< per mesh, as above: collide() with one contact, with all contacts
  double contacts_seconds = 0;
  double distance_seconds = 0;
};
[[nodiscard]] std::optional<FclMeshes> measure_fcl_meshes(const Mesh& mesh,
                                                          std::span<const Mesh> others);

}  // namespace cde::cli
