// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "cde/mesh/mesh.hpp"
#include "cde/query/record.hpp"

/// A mesh in parts, each on a card of its own, and what their records come to.
namespace cde::cli {

/// The first face of part `part` of so many, of a mesh with so many faces; of part `parts` their
/// number.
[[nodiscard]] std::uint64_t first_face_of(std::uint64_t faces, unsigned part, unsigned parts);

/// These faces, with the vertices that they use.
[[nodiscard]] Mesh part_of(const Mesh& mesh, std::uint64_t first, std::uint64_t count);

/// Vertices and faces as bytes for another process of this build, one mesh behind the other.
void append_mesh(const Mesh& mesh, std::string& to);
/// The mesh that begins at `at`, which is behind it then.
[[nodiscard]] Mesh mesh_at(const std::string& bytes, std::size_t& at);

/// Records of the same rays from the cards of all parts, in the order of parts, as the records of
/// one card with the whole mesh: the first of those with the smallest (farthest: largest) T, and in
/// modes all and hits one part's behind the other's, packet by packet. `firsts` are the parts'
/// first faces; indices of the records count from there.
[[nodiscard]] std::vector<Record> reduced(Mode mode, std::vector<std::vector<Record>> parts,
                                          const std::vector<std::uint64_t>& firsts);

}  // namespace cde::cli
