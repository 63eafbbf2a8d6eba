// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "cde/mesh/mesh.hpp"
#include "cde/query/record.hpp"

/// A mesh in parts, each on a card of its own, and the reduction of their records.
namespace cde::cli {

/// The first face of part `part` of `parts`. For part `parts` it is the number of faces.
[[nodiscard]] std::uint64_t first_face_of(std::uint64_t faces, unsigned part, unsigned parts);

/// The mesh of these faces, with the vertices that they use.
[[nodiscard]] Mesh part_of(const Mesh& mesh, std::uint64_t first, std::uint64_t count);

/// Appends vertices and faces as bytes, for another process of this build.
void append_mesh(const Mesh& mesh, std::string& to);
/// Reads the mesh that begins at `at`, and moves `at` to its end.
[[nodiscard]] Mesh mesh_at(const std::string& bytes, std::size_t& at);

/// Reduces the records of the same rays from the cards of all parts, in the order of parts, to the
/// records of one card with the whole mesh. Mode nearest keeps the first record with the smallest
/// T, mode farthest the first with the largest. Modes all and hits append the parts' records,
/// packet by packet. `firsts` are the first faces of the parts; the indices in the records count
/// from there.
[[nodiscard]] std::vector<Record> reduced(Mode mode, std::vector<std::vector<Record>> parts,
                                          const std::vector<std::uint64_t>& firsts);

}  // namespace cde::cli
