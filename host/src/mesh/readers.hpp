// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "cde/mesh/mesh.hpp"
#include "support/descriptor.hpp"

/// One reader per format, private to the library. `name` is the path as messages show it, and
/// `bytes` is the whole file. A reader throws Error(kFile) for a file that it cannot read.
/// load_mesh then checks vertices and face count.
namespace cde::mesh_readers {

/// The time within which a mesh must be read.
struct Deadline {
  explicit Deadline(std::chrono::seconds time)
      : limit(time), end(std::chrono::steady_clock::now() + time) {}
  std::chrono::seconds limit;
  std::chrono::steady_clock::time_point end;
};

/// `libraries`: the names of mtllib statements.
[[nodiscard]] Mesh read_obj(std::string_view bytes, const std::string& name,
                            std::vector<std::string>& libraries, const Deadline& deadline);
[[nodiscard]] Mesh read_ply(std::string_view bytes, const std::string& name,
                            const Deadline& deadline);
[[nodiscard]] Mesh read_stl(std::string_view bytes, const std::string& name);
[[nodiscard]] Mesh read_by_assimp(const std::filesystem::path& path, const MeshLimits& limits);

/// ".obj" for "a.OBJ".
[[nodiscard]] std::string lower_extension(const std::filesystem::path& path);

/// Checks a glTF 2.0 file (.gltf or .glb): the numbers that locate its data are whole and within
/// their buffers. A file that is not JSON is left to the importer. Error kFile names the field.
void check_gltf_ranges(const std::filesystem::path& path);

/// The folder of a mesh, which a mesh may name files of. Folder and mesh are opened once, so the
/// answers hold even if names are replaced meanwhile.
class MeshFolder {
 public:
  explicit MeshFolder(std::filesystem::path mesh);
  [[nodiscard]] const std::filesystem::path& mesh() const { return path_; }
  /// Opens the mesh. Error kFile if it is not regular.
  [[nodiscard]] Descriptor open_mesh() const;
  /// Whether an open file is below the folder of the mesh's name or of the mesh itself, with links
  /// followed.
  [[nodiscard]] bool holds(const Descriptor& file) const;

 private:
  std::filesystem::path path_;
  Descriptor folder_, mesh_;
};

/// A path that leads to an open file, whatever happens to its name.
[[nodiscard]] std::string path_of(const Descriptor& file);

/// Adds a file that the mesh or its material library names, if it exists, is regular and not in
/// mesh.files yet. The name is a path as written, or relative to the folder `beside`. It may have
/// Windows' separators or be a URI (%20). Returns true for a file outside the folder, which is not
/// added.
bool add_named_file(Mesh& mesh, const MeshFolder& folder, const std::filesystem::path& beside,
                    const std::string& name);

/// Number of triangles of the terrain that load_mesh_or_builtin() makes from
/// "terrain[:QX,QY,SEED]". Error kUsage if the text names no terrain.
[[nodiscard]] std::uint64_t builtin_triangles(std::string_view spec);

/// Whether assimp knows this extension (".glb").
[[nodiscard]] bool assimp_knows(const std::string& extension);

/// Appends a polygon as triangles that cover it once. Concave polygons are cut by ear clipping in
/// the plane of largest area; the polygon must not cross itself. A polygon of one or two corners
/// only counts as dropped. Corner numbers must be in range. Returns why nothing was appended, or an
/// empty text: a concave polygon has more than 1024 corners, or the time is over.
[[nodiscard]] std::string append_polygon(Mesh& mesh, std::span<const std::uint32_t> corners,
                                         const Deadline& deadline);

/// Appends vertices, and uses a vertex again if all 96 bits agree.
class VertexPool {
 public:
  explicit VertexPool(std::vector<Eigen::Vector3f>& vertices) : vertices_(vertices) {}
  [[nodiscard]] std::uint32_t add(const Eigen::Vector3f& vertex);

 private:
  struct Bits {
    std::uint32_t x, y, z;
    bool operator==(const Bits&) const = default;
  };
  struct Hash {
    std::size_t operator()(const Bits& b) const noexcept;
  };
  std::vector<Eigen::Vector3f>& vertices_;
  std::unordered_map<Bits, std::uint32_t, Hash> numbers_;
};

}  // namespace cde::mesh_readers
