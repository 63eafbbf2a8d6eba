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

/// Faces that belong to one object, group or node of the file: from `first_face` to the next part.
struct MeshPart {
  std::string name;  ///< as in the file
  std::uint32_t first_face = 0;
};

/// Indexed triangles. Face i is triangle i of the card: the index of a hit record counts faces in
/// this order.
struct Mesh {
  std::vector<Eigen::Vector3f> vertices;  ///< world frame, finite
  std::vector<std::array<std::uint32_t, 3>>
      faces;         ///< corner numbers, each less than vertices.size()
  std::string name;  ///< for messages: file name without folder, or "terrain".
  std::size_t dropped =
      0;  ///< points and lines of the file; they have no area and are not among the faces.
  std::vector<MeshPart> parts = {};  ///< ascending; objects and groups of OBJ, nodes of formats
                                     ///< that assimp reads; empty if the file names none.
  /// What was skipped or reinterpreted, with its place in the file: one line each, without line
  /// end.
  std::vector<std::string> warnings = {};
  /// Existing files that the mesh file names: buffers, materials, textures.
  std::vector<std::filesystem::path> files = {};

  /// The corners of one face. `face` must be less than faces.size().
  [[nodiscard]] Triangle triangle(std::size_t face) const {
    const auto& f = faces[face];
    return {vertices[f[0]], vertices[f[1]], vertices[f[2]]};
  }
};

/// Smallest box around the vertices that a face uses; empty for a mesh without faces.
[[nodiscard]] Eigen::AlignedBox3f bounds(const Mesh& mesh);

/// Limits for reading one mesh file through assimp.
struct MeshLimits {
  std::chrono::seconds time = std::chrono::seconds(30);  ///< of wall clock, and of processor time.
  /// Bytes; 0: 512 MB plus 64 times the file's size, at most 2 GB.
  std::uint64_t memory = 0;

  /// Limits from $CDE_READ_SECONDS and $CDE_READ_MEMORY (MB). Error kUsage, naming the variable, if
  /// its value is not an integer above 0.
  [[nodiscard]] static MeshLimits from_environment();
};

/// Reads OBJ, PLY (ascii, binary of either byte order) and STL (ascii, binary). assimp reads all
/// other formats that it knows (GLB, glTF, OFF, COLLADA, 3DS and more), with node transforms
/// applied. The file extension names the format.
///
/// Faces keep the order of the file. Polygons become triangles in place. Triangles without area are
/// kept. No corner moves, and coordinates are the floats nearest to the text. OBJ and PLY keep the
/// file's vertices. Other formats have no shared vertices; theirs are merged if all 96 bits agree.
///
/// Text may begin with a UTF-8 byte order mark. Lines end in LF, CRLF or CR, even mixed. Bytes
/// after the last facet of a binary STL, and PLY values that its header does not announce, are
/// skipped; Mesh::warnings reports them. An STL is text if its size does not fit a binary one,
/// its first word is "solid", and no byte near its front is 0.
///
/// assimp 5.2 crashes, hangs or allocates gigabytes on some damaged files. It therefore runs in a
/// child process with limits. Only regular files among those that a mesh names are read.
///
/// Error kFile, naming file and line or byte: missing, unreadable, directory, empty, malformed,
/// truncated, corner number out of range, over a limit. Error kBadInput: NaN or infinite vertex
/// (numbered from 0 in the mesh), or no triangles.
[[nodiscard]] Mesh load_mesh(const std::filesystem::path& path,
                             const MeshLimits& limits = MeshLimits::from_environment());

/// The same for a mesh that a file names: it must be a regular file. load_mesh also reads a pipe.
[[nodiscard]] Mesh load_named_mesh(const std::filesystem::path& path,
                                   const MeshLimits& limits = MeshLimits::from_environment());

/// Loads a mesh named on the command line: "terrain", "terrain:QX,QY,SEED" (terrain.hpp), otherwise
/// a path. A file named terrain is reached as ./terrain.
[[nodiscard]] Mesh load_mesh_or_builtin(std::string_view spec);

/// Writes .obj (shortest text that reads back to the same floats), .ply or .stl (binary little
/// endian). A reader never sees a partial file. Errors: kUsage (other extension), kFile (cannot be
/// written), kCapacity (faces do not fit the format's 32-bit count).
void save_mesh(const Mesh& mesh, const std::filesystem::path& path);

/// Error kBadInput, prefixed with `what`, if a vertex is not finite, a corner number is out of
/// range, or there is no face.
void check(const Mesh& mesh, std::string_view what);

/// Describes the triangles of a checked mesh that the card will flag as bad input. Their
/// coordinates are out of range (length_range.hpp) in its number format. The line names their
/// number, the first one, its word and the range. Nothing if there are none. Without line end.
[[nodiscard]] std::optional<std::string> out_of_range(const Mesh& mesh, std::string_view what,
                                                      FpFormat format = {});

/// Describes the triangles of a checked mesh that have no area, computed in binary64: their number
/// and the first one. Nothing if there are none. Without line end.
[[nodiscard]] std::optional<std::string> without_area(const Mesh& mesh, std::string_view what);

}  // namespace cde
