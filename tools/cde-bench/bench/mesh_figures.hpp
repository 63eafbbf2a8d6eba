// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "cde/mesh/mesh.hpp"
#include "cde/model/device.hpp"
#include "cde/query/counters.hpp"

/// Measures a mesh against a mesh, by traversing the BVH of one with the triangles of the other,
/// and FCL.
namespace cde::cli {

/// One question for all triangles of a mesh: modelled, mean over several places.
struct MeshQuestion {
  std::string_view question;    ///< "touches", "contacts" or "nearest"
  double cycles = 0;            ///< cycles from go to done
  double seconds_with_bus = 0;  ///< with upload, records and register accesses
  double nodes = 0, pairs = 0;  ///< nodes read, pairs tested
  std::optional<double>
      fcl_seconds;  ///< measured: collide() with one contact, with all contacts, or distance()
};

struct MeshFigures {
  std::uint64_t triangles = 0;  ///< triangles of the traversing mesh
  double contacts = 0;          ///< mean number of touching pairs
  std::vector<MeshQuestion> questions;
};

/// Error kMismatch if a record differs from the reference's traversal, or from FCL.
[[nodiscard]] MeshFigures measure_meshes(const Mesh& terrain, const Device& device);
[[nodiscard]] nlohmann::ordered_json meshes_json(const MeshFigures& figures, const Device& device);
/// Prints the figures as text.
void show_meshes(const MeshFigures& figures, const Device& device);

}  // namespace cde::cli
