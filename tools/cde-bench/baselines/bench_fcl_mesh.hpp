// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "bench/measured.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/mesh/mesh.hpp"

namespace cde::cli {

/// Solids against a mesh by FCL (BVHModel<OBBRSS>, binary64, one thread).
struct FclOnMesh {
  std::vector<double> touches;    ///< 1 or 0: collide() with one contact
  std::vector<double> distances;  ///< 0 or less where they overlap
  double collide_seconds = 0;     ///< of one, processor time: median over all, again and again
  double distance_seconds = 0;
};

/// `words` are of spheres or OBBs, in slot order. In a child process, as an assertion of FCL ends
/// it: nothing if one did, or without FCL in this build.
[[nodiscard]] std::optional<FclOnMesh> measure_fcl_mesh(const Mesh& mesh, Shape shape,
                                                        std::span<const float> words);

/// Meshes against one, each with a model of its own. `contacts`: pairs of triangles that meet.
struct FclMeshes {
  std::vector<double> contacts, distances;
  double touch_seconds = 0;  ///< of one, as above: collide() with one contact, with all of them
  double contacts_seconds = 0;
  double distance_seconds = 0;
};
[[nodiscard]] std::optional<FclMeshes> measure_fcl_meshes(const Mesh& mesh,
                                                          std::span<const Mesh> others);

}  // namespace cde::cli
