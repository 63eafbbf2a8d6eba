// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cde/geometry/primitives.hpp"

namespace cde {

/// Faces of a mesh that belong to one object, group or node of its file: from `first_face` to the
/// next part.
struct MeshPart {
  std::string name;  ///< as the file has it
  std::uint32_t first_face = 0;
};

/// Indexed triangles. Face i is triangle i of the card: the index of a hit record counts faces in
/// this order.
struct Mesh {
  std::vector<Eigen::Vector3f> vertices;  ///< world frame, finite
  std::vector<std::array<std::uint32_t, 3>>
      faces;         ///< corner numbers, each less than vertices.size()
  std::string name;  ///< for messages: the file's name without folder, or "terrain"
  std::size_t dropped =
      0;  ///< points and lines of the file; they have no area and are not among faces
  std::vector<MeshPart> parts = {};  ///< ascending; objects and groups of OBJ, nodes of what assimp
                                     ///< reads; empty if the file names none
  /// What was left out of a file or taken as it is meant, with its place in the file: a line each,
  /// without its end.
  std::vector<std::string> warnings = {};
  std::vector<std::filesystem::path> files = {};  ///< others that the file names and that are
                                                  ///< there: buffers, materials, textures

  /// The corners of one face. `face` must be less than faces.size().
  [[nodiscard]] Triangle triangle(std::size_t face) const {
    const auto& f = faces[face];
    return {vertices[f[0]], vertices[f[1]], vertices[f[2]]};
  }
};

/// Smallest box around the vertices that a face uses; empty for a mesh without faces.
[[nodiscard]] Eigen::AlignedBox3f bounds(const Mesh& mesh);

/// What reading one mesh file through assimp may take at most.
struct MeshLimits {
  std::chrono::seconds time = std::chrono::seconds(30);  ///< of the clock, and of the processor
  /// Bytes; 0: 512 MB and 64 times the file's size, at most 2 GB.
  std::uint64_t memory = 0;

  /// Those of $CDE_MESH_SECONDS and $CDE_MESH_MEMORY (MB). Error kUsage, naming the variable, if
  /// one is no whole number above 0.
  [[nodiscard]] static MeshLimits of_environment();
};

/// Reads OBJ, PLY (ascii, binary of either byte order) and STL (ascii, binary), and through assimp
/// every other format that it knows (GLB, glTF, OFF, COLLADA, 3DS, ...; node transforms applied).
/// The extension names the format.
///
/// Faces keep the file's order; polygons become triangles in place; triangles without area are
/// kept. No corner is moved, and coordinates are the floats nearest to the text of the file. OBJ
/// and PLY keep the file's vertices; formats without shared vertices get them where all 96 bits
/// agree.
///
/// Text may begin with a UTF-8 byte order mark; its lines end in LF, CRLF or CR, mixed too. Bytes
/// behind the last facet of a binary STL, and values of PLY that its header does not announce, are
/// left out, which Mesh::warnings says. An STL whose size is not that of a binary one is text if
/// its first word is "solid" and no byte near its front is 0.
///
/// assimp 5.2 dies, hangs or takes gigabytes on some damaged files, so it runs in a child process
/// with limits. A mesh can name other files; only regular files among them are read.
///
/// Errors: kFile, naming file and line or byte (missing, unreadable, directory, empty, malformed,
/// truncated, corner number out of range, over a limit); kBadInput (NaN or infinite vertex, by its
/// number from 0 in the mesh; no triangles).
[[nodiscard]] Mesh load_mesh(const std::filesystem::path& path,
                             const MeshLimits& limits = MeshLimits::of_environment());

/// What the command line calls a mesh: "terrain", "terrain:QX,QY,SEED" (terrain.hpp), otherwise a
/// path. A file that is called terrain is reached as ./terrain.
[[nodiscard]] Mesh load_mesh_or_builtin(std::string_view spec);

/// Writes .obj (shortest text that reads back to the same floats), .ply or .stl (binary little
/// endian). The file appears whole or not at all. Errors: kUsage (other extension), kFile (cannot
/// be written), kCapacity (faces do not fit the format's 32-bit count).
void save_mesh(const Mesh& mesh, const std::filesystem::path& path);

/// Throws kBadInput, beginning with `what`, if a vertex is not finite, a corner number is out of
/// range, or there is no face.
void check(const Mesh& mesh, std::string_view what);

/// Which triangles of a checked mesh the card will flag as bad input, as coordinates of theirs are
/// out of range (length_range.hpp) in its number format: how many, the first one, its word and the
/// range; nothing if there are none. A line without its end.
[[nodiscard]] std::optional<std::string> out_of_range(const Mesh& mesh, std::string_view what,
                                                      FpFormat format = {});

/// How many triangles of a checked mesh have no area, computed in binary64, and the first one;
/// nothing if there are none. A line without its end.
[[nodiscard]] std::optional<std::string> without_area(const Mesh& mesh, std::string_view what);

}  // namespace cde
