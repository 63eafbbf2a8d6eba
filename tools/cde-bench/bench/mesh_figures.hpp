// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "cde/mesh/mesh.hpp"
#include "cde/query/counters.hpp"

/// A mesh against a mesh: the triangles of one through the hierarchy of the other, beside FCL.
namespace cde::cli {

/// One question of all triangles of a mesh, the mean of several places, all of it modelled.
struct MeshQuestion {
  std::string_view question;    ///< "touches", "contacts" or "nearest"
  double cycles = 0;            ///< from go to done
  double seconds_with_bus = 0;  ///< with loading, records and register accesses
  double nodes = 0, pairs = 0;  ///< read, tested
  std::optional<double>
      fcl_seconds;  ///< collide() with one contact, with all, distance(); measured
};

struct MeshFigures {
  std::uint64_t triangles = 0;  ///< of the mesh that goes through
  double contacts = 0;          ///< pairs that meet, the mean
  std::vector<MeshQuestion> questions;
};

/// Error kMismatch if a record differs from the reference's way, or FCL finds something else.
[[nodiscard]] MeshFigures measure_meshes(const Mesh& terrain, double clock_hz);
[[nodiscard]] nlohmann::ordered_json meshes_json(const MeshFigures& figures, double clock_hz);
/// On stdout, for people.
void show_meshes(const MeshFigures& figures, double clock_hz);

}  // namespace cde::cli
