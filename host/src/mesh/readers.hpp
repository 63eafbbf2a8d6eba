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

/// One reader per format. Private to the library. `name` is the path as messages show it; `bytes`
/// the whole file. Readers throw Error(kFile) on what they cannot read; load_mesh then checks
/// vertices and face count.
namespace cde::mesh_readers {

/// `libraries`: the names of mtllib statements.
[[nodiscard]] Mesh read_obj(std::string_view bytes, const std::string& name,
                            std::vector<std::string>& libraries);
[[nodiscard]] Mesh read_ply(std::string_view bytes, const std::string& name);
[[nodiscard]] Mesh read_stl(std::string_view bytes, const std::string& name);
[[nodiscard]] Mesh read_by_assimp(const std::filesystem::path& path, const MeshLimits& limits);

/// ".obj" of "a.OBJ".
[[nodiscard]] std::string lower_extension(const std::filesystem::path& path);

/// Checks that the numbers of a glTF 2.0 file (.gltf or .glb) that say where its data lie are whole
/// and within their buffers. A file that is no JSON is left to the importer. Error kFile names the
/// field.
void check_gltf_ranges(const std::filesystem::path& path);

/// Adds a file that the mesh `mesh_file` names, if it is there and not in mesh.files yet: a path of
/// its own, or relative to the mesh's folder, also with Windows' separators, or as a URI (%20).
void add_named_file(Mesh& mesh, const std::filesystem::path& mesh_file, const std::string& name);

/// Triangles of the terrain that load_mesh_or_builtin() makes of "terrain[:QX,QY,SEED]". Error
/// kUsage if it makes none.
[[nodiscard]] std::uint64_t builtin_triangles(std::string_view spec);

/// Whether assimp knows this extension (".glb").
[[nodiscard]] bool assimp_knows(const std::string& extension);

/// Appends a polygon as triangles that cover it once, concave ones too (ear clipping in the plane
/// of largest area; the polygon must not cross itself). One or two corners only count as dropped.
/// Corner numbers must be in range. Returns false for a concave polygon of more than 1024 corners.
[[nodiscard]] bool append_polygon(Mesh& mesh, std::span<const std::uint32_t> corners);

/// Appends vertices, using one again where all 96 bits agree.
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
