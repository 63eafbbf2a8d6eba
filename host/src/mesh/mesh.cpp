// SPDX-License-Identifier: Apache-2.0
#include "cde/mesh/mesh.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <optional>
#include <sstream>

#include "cde/mesh/terrain.hpp"
#include "cde/support/counted.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/output_file.hpp"
#include "cde/support/read_limits.hpp"
#include "mesh/readers.hpp"
#include "support/file_io.hpp"
#include "support/text.hpp"

namespace cde {

std::string mesh_readers::lower_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

namespace {

using mesh_readers::lower_extension;

static_assert(std::endian::native == std::endian::little,
              "the binary writers copy words as they lie in memory");

template <typename T>
void append_raw(std::string& out, const T& value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  out.append(raw, sizeof(T));
}

void append_raw(std::string& out, const Eigen::Vector3f& v) {
  for (int i = 0; i < 3; ++i) append_raw(out, v[i]);
}

std::string to_obj(const Mesh& mesh) {
  std::string out;
  auto at = std::back_inserter(out);
  for (const auto& v : mesh.vertices) fmt::format_to(at, "v {} {} {}\n", v.x(), v.y(), v.z());
  for (const auto& f : mesh.faces)
    fmt::format_to(at, "f {} {} {}\n", f[0] + 1ull, f[1] + 1ull, f[2] + 1ull);
  return out;
}

std::string to_ply(const Mesh& mesh) {
  std::string out = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float "
      "y\nproperty float z\n"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      mesh.vertices.size(), mesh.faces.size());
  out.reserve(out.size() + 12 * mesh.vertices.size() + 13 * mesh.faces.size());
  for (const auto& v : mesh.vertices) append_raw(out, v);
  for (const auto& f : mesh.faces) {
    out.push_back(3);
    append_raw(out, f);
  }
  return out;
}

std::string to_stl(const Mesh& mesh) {
  std::string out(80, ' ');
  append_raw(out, static_cast<std::uint32_t>(mesh.faces.size()));
  out.reserve(84 + 50 * mesh.faces.size());
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    const Triangle t = mesh.triangle(i);
    // Eigen keeps a zero vector, which is what STL wants for a facet without area.
    const Eigen::Vector3d normal =
        (t.v1 - t.v0).cast<double>().cross((t.v2 - t.v0).cast<double>()).normalized();
    append_raw(out, Eigen::Vector3f(normal.cast<float>()));
    append_raw(out, t.v0);
    append_raw(out, t.v1);
    append_raw(out, t.v2);
    append_raw(out, std::uint16_t{0});
  }
  return out;
}

TerrainOptions parse_terrain(std::string_view spec, std::string_view arguments) {
  TerrainOptions options;
  std::uint32_t* const fields[] = {&options.quads_x, &options.quads_y, &options.seed};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t comma = arguments.find(',');
    if ((comma == std::string_view::npos) != (i == 2) ||
        !text::parse_int(arguments.substr(0, comma), *fields[i])) {
      throw Error(
          ErrorCode::kUsage,
          fmt::format("{}: expected terrain:QX,QY,SEED, three whole numbers", in_quotes(spec)));
    }
    arguments.remove_prefix(comma == std::string_view::npos ? arguments.size() : comma + 1);
  }
  return options;
}

}  // namespace

Eigen::AlignedBox3f bounds(const Mesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const auto& face : mesh.faces) {
    for (const auto corner : face) box.extend(mesh.vertices[corner]);
  }
  return box;
}

void check(const Mesh& mesh, std::string_view what) {
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const auto& v = mesh.vertices[i];
    if (!std::isfinite(v.x()) || !std::isfinite(v.y()) || !std::isfinite(v.z())) {
      throw Error(ErrorCode::kBadInput,
                  fmt::format("{}: vertex {} is ({}, {}, {}), which is not finite", what, i, v.x(),
                              v.y(), v.z()));
    }
  }
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    for (const auto corner : mesh.faces[i]) {
      if (corner >= mesh.vertices.size()) {
        throw Error(ErrorCode::kBadInput,
                    fmt::format("{}: face {} names vertex {}, but there are {} vertices", what, i,
                                corner, mesh.vertices.size()));
      }
    }
  }
  if (mesh.faces.empty()) throw Error(ErrorCode::kBadInput, fmt::format("{}: no triangles", what));
}

std::optional<std::string> out_of_range(const Mesh& mesh, std::string_view what, FpFormat format) {
  std::size_t far = 0;
  std::optional<std::string> first;
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    const auto& f = mesh.faces[i];
    const auto why =
        defect(Triangle{mesh.vertices[f[0]], mesh.vertices[f[1]], mesh.vertices[f[2]]}, format);
    if (why && far++ == 0) first = fmt::format("triangle {}: {}", i, *why);
  }
  if (!first) return std::nullopt;
  return fmt::format("{}: {} of {} {} bad input, the first {}", what, far,
                     counted(mesh.faces.size(), "triangle"), far == 1 ? "is" : "are", *first);
}

std::optional<std::string> without_area(const Mesh& mesh, std::string_view what) {
  std::size_t count = 0, first = 0;
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    const Triangle t = mesh.triangle(i);
    const Eigen::Vector3d p = (t.v1 - t.v0).cast<double>(), q = (t.v2 - t.v0).cast<double>();
    if (p.cross(q) == Eigen::Vector3d::Zero() && count++ == 0) first = i;
  }
  if (count == 0) return std::nullopt;
  return fmt::format("{}: {} of {} {} no area and {} hit by no ray, the first is {}", what, count,
                     counted(mesh.faces.size(), "triangle"), count == 1 ? "has" : "have",
                     count == 1 ? "is" : "are", first);
}

std::string mesh_readers::path_of(const Descriptor& file) {
  return fmt::format("/proc/self/fd/{}", file.get());
}

mesh_readers::MeshFolder::MeshFolder(std::filesystem::path mesh)
    : path_(std::move(mesh)),
      folder_(::open(path_.has_parent_path() ? path_.parent_path().c_str() : ".",
                     O_PATH | O_DIRECTORY | O_CLOEXEC)),
      mesh_(::openat(folder_.get(), path_.filename().c_str(), O_PATH | O_CLOEXEC)) {}

Descriptor mesh_readers::MeshFolder::open_mesh() const {
  return file_io::open_regular(path_of(mesh_));
}

bool mesh_readers::MeshFolder::holds(const Descriptor& file) const {
  namespace fs = std::filesystem;
  if (folder_.get() < 0 || mesh_.get() < 0) return false;
  std::error_code error;
  const fs::path name = fs::read_symlink(path_of(file), error);
  for (const fs::path& folder : {fs::read_symlink(path_of(folder_), error),
                                 fs::read_symlink(path_of(mesh_), error).parent_path()})
    if (!folder.empty() &&
        std::mismatch(folder.begin(), folder.end(), name.begin(), name.end()).first == folder.end())
      return true;
  return false;
}

void mesh_readers::Deadline::check(const std::filesystem::path& mesh) const {
  if (std::chrono::steady_clock::now() > end) fail_slow(mesh, limit);
}

std::uint64_t mesh_readers::memory_of(const std::filesystem::path& path, const MeshLimits& limits) {
  constexpr std::uint64_t kLeast = 512u << 20, kPerByte = 64, kMost = std::uint64_t{2} << 30;
  if (limits.memory != 0) return limits.memory;
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  return error ? kLeast : std::min(kMost, kLeast + kPerByte * std::min<std::uint64_t>(size, kMost));
}

void mesh_readers::NamedFiles::count(std::size_t bytes) {
  constexpr std::size_t kWithEach = 128;  // bytes of containers
  if ((bytes_ += bytes + kWithEach) > memory_) fail_large(folder_.mesh(), memory_);
}

/// The same as add() for one spelling.
bool mesh_readers::NamedFiles::add_one(const std::filesystem::path& file) {
  deadline_.check(folder_.mesh());
  const Descriptor found(::open(file.c_str(), O_PATH | O_CLOEXEC));
  struct stat info {};
  if (found.get() < 0 || ::fstat(found.get(), &info) != 0 || !S_ISREG(info.st_mode)) return false;
  std::error_code none;
  if (std::filesystem::equivalent(file, folder_.mesh(), none)) return false;
  if (!folder_.holds(found)) return true;
  if (known_.contains(file.native())) return false;
  count(2 * file.native().size());
  known_.insert(file.native());
  mesh_.files.push_back(file);
  return false;
}

bool mesh_readers::NamedFiles::add(const std::filesystem::path& beside, const std::string& name) {
  bool outside = false;
  const std::string decoded = text::percent_decoded(name);
  for (std::string one : {name, decoded}) {
    if (one.find('\0') != std::string::npos) continue;
    outside = add_one(beside / one) || outside;  // or `one`, if absolute
    if (one.find('\\') != std::string::npos) {
      std::replace(one.begin(), one.end(), '\\', '/');
      outside = add_one(beside / one) || outside;
    }
    if (decoded == name) break;
  }
  return outside;
}

/// The text of a material library; empty if it was read before, cannot be read, or is larger than
/// any real one.
std::string mesh_readers::NamedFiles::library_text(const std::filesystem::path& file) {
  constexpr std::uint64_t kMost = 1u << 20;
  try {
    const Descriptor opened = file_io::open_regular(file);
    struct stat info {};
    if (!folder_.holds(opened) || ::fstat(opened.get(), &info) != 0 ||
        !libraries_.emplace(info.st_dev, info.st_ino).second)
      return {};
    return file_io::read_regular(path_of(opened), kMost);
  } catch (const Error&) {
    return {};  // Only the names of textures are missing.
  }
}

void mesh_readers::NamedFiles::add_library(const std::string& name) {
  constexpr std::size_t kLongestLine = 4096;  // of a path in Linux
  constexpr unsigned kMostWords = 32;         // options before a name, and their values
  const std::size_t before = mesh_.files.size();
  if (add(folder_.mesh().parent_path(), name)) {
    mesh_.warnings.push_back(
        fmt::format("{}: mtllib {} is outside the folder of the mesh and is ignored",
                    printable_name(folder_.mesh().string()), in_quotes(name)));
    count(mesh_.warnings.back().size());
  }
  if (mesh_.files.size() == before) return;
  const std::filesystem::path library = mesh_.files[before];  // the name as written comes first
  std::istringstream in(library_text(library));
  for (std::string line; std::getline(in, line);) {
    std::string_view rest = line;
    const std::string_view keyword = text::next_word(rest);
    if (line.size() > kLongestLine ||
        (!keyword.starts_with("map_") && keyword != "bump" && keyword != "disp" &&
         keyword != "decal" && keyword != "refl" && keyword != "norm"))
      continue;
    // Options precede the name, which may contain blanks.
    rest = text::trim(rest);
    for (unsigned i = 0; i < kMostWords && !rest.empty(); ++i, rest = text::trim(rest)) {
      (void)add(library.parent_path(), std::string(rest));
      (void)text::next_word(rest);
    }
  }
}

MeshLimits MeshLimits::from_environment() {
  MeshLimits limits;
  const ReadLimits set = ReadLimits::from_environment();
  if (set.time) limits.time = *set.time;
  if (set.memory) limits.memory = *set.memory;
  return limits;
}

namespace {

Mesh load(const std::filesystem::path& path, const MeshLimits& limits, bool may_be_pipe) {
  const std::string name = printable_name(path.string());
  const std::string extension = lower_extension(path);
  Mesh mesh;
  if (extension == ".obj" || extension == ".off" || extension == ".ply" || extension == ".stl") {
    const std::string bytes = may_be_pipe ? file_io::read(path) : file_io::read_regular(path);
    if (bytes.empty()) throw Error(ErrorCode::kFile, fmt::format("{}: is empty", name));
    std::vector<std::string> libraries;
    const mesh_readers::Deadline deadline(limits.time);
    mesh = extension == ".obj"   ? mesh_readers::read_obj(bytes, name, libraries, deadline)
           : extension == ".off" ? mesh_readers::read_off(bytes, name, deadline)
           : extension == ".ply" ? mesh_readers::read_ply(bytes, name, deadline)
                                 : mesh_readers::read_stl(bytes, name, deadline);
    const mesh_readers::MeshFolder folder(path);
    mesh_readers::NamedFiles files(mesh, folder, deadline, mesh_readers::memory_of(path, limits));
    for (const std::string& library : libraries) files.add_library(library);
  } else {
    if (file_io::size_of_regular(path) == 0)
      throw Error(ErrorCode::kFile, fmt::format("{}: is empty", name));
    if (!mesh_readers::assimp_knows(extension)) {
      throw Error(
          ErrorCode::kFile,
          fmt::format(
              "{}: no mesh format has the extension '{}' (.obj, .off, .ply, .stl, .glb, ...)", name,
              printable_name(extension)));
    }
    mesh = mesh_readers::read_by_assimp(path, limits);
  }
  if (mesh.faces.empty() && mesh.dropped > 0) {
    throw Error(ErrorCode::kBadInput,
                fmt::format("{}: no triangles, only {} points and lines", name, mesh.dropped));
  }
  check(mesh, name);
  mesh.vertices.shrink_to_fit();
  mesh.faces.shrink_to_fit();
  mesh.name = path.filename().string();
  return mesh;
}

std::optional<TerrainOptions> terrain_of(std::string_view spec) {
  constexpr std::string_view kTerrain = "terrain";
  if (spec == kTerrain) return TerrainOptions{};
  if (!spec.starts_with("terrain:")) return std::nullopt;
  return parse_terrain(spec, spec.substr(kTerrain.size() + 1));
}

}  // namespace

Mesh load_mesh(const std::filesystem::path& path, const MeshLimits& limits) {
  return load(path, limits, true);
}

Mesh load_named_mesh(const std::filesystem::path& path, const MeshLimits& limits) {
  return load(path, limits, false);
}

std::uint64_t mesh_readers::builtin_triangles(std::string_view spec) {
  const TerrainOptions options = terrain_of(spec).value();
  return std::uint64_t{2} * options.quads_x * options.quads_y;
}

Mesh load_mesh_or_builtin(std::string_view spec) {
  const auto terrain = terrain_of(spec);
  return terrain ? make_terrain(*terrain) : load_mesh(spec);
}

void save_mesh(const Mesh& mesh, const std::filesystem::path& path) {
  const std::string extension = lower_extension(path);
  check(mesh, printable_name(mesh.name));
  constexpr std::size_t kMost = 0x7fffffff;  // PLY's corner numbers are signed in most readers
  if (mesh.vertices.size() > kMost || mesh.faces.size() > kMost) {
    throw Error(ErrorCode::kCapacity, fmt::format("{}: more than {} vertices or faces",
                                                  printable_name(path.string()), kMost));
  }
  if (extension == ".obj") return write_file(path, to_obj(mesh));
  if (extension == ".ply") return write_file(path, to_ply(mesh));
  if (extension == ".stl") return write_file(path, to_stl(mesh));
  throw Error(ErrorCode::kUsage,
              fmt::format("{}: cannot write this format; expected .obj, .ply or .stl",
                          printable_name(path.string())));
}

}  // namespace cde
