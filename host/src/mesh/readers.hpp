// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sys/types.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>
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
  /// Error kFile after the end.
  void check(const std::filesystem::path& mesh) const;
  std::chrono::seconds limit;
  std::chrono::steady_clock::time_point end;
};

/// `libraries`: the names of mtllib statements.
[[nodiscard]] Mesh read_obj(std::string_view bytes, const std::string& name,
                            std::vector<std::string>& libraries, const Deadline& deadline);
[[nodiscard]] Mesh read_off(std::string_view bytes, const std::string& name,
                            const Deadline& deadline);
[[nodiscard]] Mesh read_ply(std::string_view bytes, const std::string& name,
                            const Deadline& deadline);
[[nodiscard]] Mesh read_stl(std::string_view bytes, const std::string& name,
                            const Deadline& deadline);
[[nodiscard]] Mesh read_by_assimp(const std::filesystem::path& path, const MeshLimits& limits);

/// ".obj" for "a.OBJ".
[[nodiscard]] std::string lower_extension(const std::filesystem::path& path);

/// Checks a glTF 2.0 file (.gltf or .glb): the numbers that locate its data are whole and within
/// their buffers. Returns the number of triangles of all meshes in its scene. A file that is not
/// JSON or is glTF 1.0 is left to the importer. Error kFile names the field.
[[nodiscard]] std::optional<std::uint64_t> gltf_triangles(const std::filesystem::path& path);

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

/// Bytes that reading a mesh may take.
[[nodiscard]] std::uint64_t memory_of(const std::filesystem::path& path, const MeshLimits& limits);

/// Adds the files that a mesh and its material libraries name to mesh.files. Error kFile if that
/// takes too much time or memory.
class NamedFiles {
 public:
  NamedFiles(Mesh& mesh, const MeshFolder& folder, const Deadline& deadline, std::uint64_t memory)
      : mesh_(mesh), folder_(folder), deadline_(deadline), memory_(memory) {}
  /// Adds a file if it exists, is regular and was not added yet. The name is a path as written, or
  /// relative to the folder `beside`. It may have Windows' separators or be a URI (%20). Returns
  /// true for a file outside the folder, which is not added.
  bool add(const std::filesystem::path& beside, const std::string& name);
  /// Adds a material library, which has no shapes, and the textures that it names.
  void add_library(const std::string& name);

 private:
  bool add_one(const std::filesystem::path& file);
  void count(std::size_t bytes);
  [[nodiscard]] std::string library_text(const std::filesystem::path& file);

  Mesh& mesh_;
  const MeshFolder& folder_;
  const Deadline& deadline_;
  std::uint64_t memory_, bytes_ = 0;
  std::unordered_set<std::string> known_;        ///< names in mesh.files
  std::set<std::pair<dev_t, ino_t>> libraries_;  ///< read ones
};

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

/// Appends vertices, and uses a vertex again if all 96 bits agree. The hash is random, so that no
/// file can make many vertices collide. The order of the vertices does not depend on it.
class VertexPool {
 public:
  explicit VertexPool(std::vector<Eigen::Vector3f>& vertices);
  [[nodiscard]] std::uint32_t add(const Eigen::Vector3f& vertex);

 private:
  struct Bits {
    std::uint32_t x, y, z;
    bool operator==(const Bits&) const = default;
  };
  struct Hash {
    std::array<std::uint64_t, 4> keys;
    std::size_t operator()(const Bits& b) const noexcept;
  };
  std::vector<Eigen::Vector3f>& vertices_;
  std::unordered_map<Bits, std::uint32_t, Hash> numbers_;
};

}  // namespace cde::mesh_readers
