// SPDX-License-Identifier: Apache-2.0
#include <assimp/DefaultIOStream.h>
#include <assimp/DefaultIOSystem.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <assimp/DefaultLogger.hpp>
#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>

#include <fcntl.h>
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <optional>
#include <set>

#include "cde/support/counted.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/process.hpp"
#include "cde/support/read_limits.hpp"
#include "mesh/readers.hpp"
#include "support/file_io.hpp"
#include "support/sanitizer.hpp"
#include "support/text.hpp"

#ifdef CDE_COVERAGE
extern "C" void __gcov_dump();  // NOLINT(bugprone-reserved-identifier): libgcov's
#endif

// Reads every format that has no reader of its own. assimp runs in a child process, because it
// crashes, hangs or takes all memory on some damaged files. The mesh comes back through a pipe.
namespace cde::mesh_readers {
namespace {

constexpr char kMeshFollows = 'M';
constexpr char kMessageFollows = 'E';
constexpr char kTooLarge = 'B';

Eigen::Matrix4d to_eigen(const aiMatrix4x4& m) {
  Eigen::Matrix4d out;
  for (unsigned row = 0; row < 4; ++row) {
    for (unsigned column = 0; column < 4; ++column) out(row, column) = m[row][column];
  }
  return out;
}

/// Appends the meshes of a node and its children, in the order of the file.
void append_node(Mesh& mesh, VertexPool& pool, const aiScene& scene, const aiNode& node,
                 const Eigen::Matrix4d& parent) {
  const Eigen::Matrix4d world = parent * to_eigen(node.mTransformation);
  if (node.mNumMeshes > 0)
    mesh.parts.push_back({node.mName.C_Str(), static_cast<std::uint32_t>(mesh.faces.size())});
  const bool moved = world != Eigen::Matrix4d::Identity();
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& part = *scene.mMeshes[node.mMeshes[m]];
    std::vector<std::uint32_t> numbers(part.mNumVertices);
    for (unsigned i = 0; i < part.mNumVertices; ++i) {
      const aiVector3D& v = part.mVertices[i];
      Eigen::Vector3f position(v.x, v.y, v.z);
      if (moved) position = (world * Eigen::Vector4d(v.x, v.y, v.z, 1.0)).head<3>().cast<float>();
      numbers[i] = pool.add(position);
    }
    for (unsigned i = 0; i < part.mNumFaces; ++i) {
      const aiFace& face = part.mFaces[i];
      if (face.mNumIndices == 3) {
        mesh.faces.push_back({numbers.at(face.mIndices[0]), numbers.at(face.mIndices[1]),
                              numbers.at(face.mIndices[2])});
      } else {
        ++mesh.dropped;
      }
    }
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i)
    append_node(mesh, pool, scene, *node.mChildren[i], world);
}

template <typename T>
void append_array(std::string& out, const std::vector<T>& items) {
  const std::uint64_t count = items.size();
  out.append(reinterpret_cast<const char*>(&count), sizeof(count));
  out.append(reinterpret_cast<const char*>(items.data()), count * sizeof(T));
}

void append_parts(std::string& out, const std::vector<MeshPart>& parts) {
  std::vector<std::uint32_t> first_faces;
  std::vector<char> names;  // each ends with a zero byte
  for (const MeshPart& part : parts) {
    first_faces.push_back(part.first_face);
    names.insert(names.end(), part.name.begin(), part.name.end());
    names.push_back('\0');
  }
  append_array(out, first_faces);
  append_array(out, names);
}

template <typename T>
bool take_array(std::string_view& in, std::vector<T>& items) {
  std::uint64_t count = 0;
  if (in.size() < sizeof(count)) return false;
  std::memcpy(&count, in.data(), sizeof(count));
  in.remove_prefix(sizeof(count));
  if (count > in.size() / sizeof(T)) return false;
  items.resize(count);
  if (count > 0) std::memcpy(static_cast<void*>(items.data()), in.data(), count * sizeof(T));
  in.remove_prefix(count * sizeof(T));
  return true;
}

bool take_parts(std::string_view& in, std::vector<MeshPart>& parts) {
  std::vector<std::uint32_t> first_faces;
  std::vector<char> names;
  if (!take_array(in, first_faces) || !take_array(in, names)) return false;
  auto name = names.begin();
  for (const std::uint32_t first : first_faces) {
    const auto stop = std::find(name, names.end(), '\0');
    if (stop == names.end()) return false;
    parts.push_back({{name, stop}, first});
    name = stop + 1;
  }
  return name == names.end();
}

/// A file that is read through its descriptor only.
class OpenedFile final : public Assimp::DefaultIOStream {
 public:
  OpenedFile(std::FILE* file, const std::string& path) : DefaultIOStream(file, path) {}
};

/// Keeps the names of the files that an importer opens. Opens regular files only, since a FIFO
/// would block for ever. Opens files in the mesh's folder only: a stranger's mesh must not copy
/// other files of the user into an output. Each file is opened once, checked and read through its
/// descriptor. assimp takes the URIs of glTF for file names. If no file has that name, this class
/// opens the file that the URI means.
class NotingFiles : public Assimp::DefaultIOSystem {
 public:
  NotingFiles(std::vector<std::string>& names, std::string mesh)
      : names_(names), mesh_(std::move(mesh)), folder_(mesh_) {}
  bool Exists(const char* name) const override { return is_there(file_of(name)); }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    names_.push_back(file_of(name));
    const bool is_mesh = names_.back() == mesh_;
    Descriptor file(-1);
    try {
      file = is_mesh ? folder_.open_mesh() : file_io::open_regular(names_.back());
    } catch (const Error&) {
      std::error_code none;
      const bool unreadable = std::filesystem::is_regular_file(names_.back(), none);
      return unreadable || !is_there(names_.back()) ? nullptr : refuse("is not a regular file");
    }
    if (!is_mesh && !folder_.holds(file))
      return refuse("is outside the folder of the mesh; copy it there");
    if (*mode != 'r') return nullptr;
    const std::string path = path_of(file);
    std::FILE* const stream = ::fdopen(file.get(), "rb");
    if (stream == nullptr) return nullptr;
    (void)file.release();
    return new OpenedFile(stream, path);
  }
  /// The file that was refused to an importer, and the reason; empty if there was none.
  [[nodiscard]] const std::string& refused() const { return refused_; }

 private:
  [[nodiscard]] std::string file_of(const char* name) const {
    const std::string meant = text::percent_decoded(name);
    return !is_there(name) && is_there(meant) ? meant : name;
  }
  Assimp::IOStream* refuse(const char* why) {
    refused_ = fmt::format("{}, which {}", names_.back(), why);
    return nullptr;
  }
  /// assimp's own version would open the file.
  static bool is_there(const std::string& name) {
    std::error_code none;
    return std::filesystem::exists(name, none);
  }
  std::vector<std::string>& names_;
  std::string mesh_;
  MeshFolder folder_;
  std::string refused_;
};

/// Notes textures without opening them. An embedded texture has the name "*N".
void note_textures(const aiScene& scene, const std::string& path, std::vector<std::string>& names) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  for (unsigned m = 0; m < scene.mNumMaterials; ++m) {
    for (unsigned type = aiTextureType_NONE; type <= AI_TEXTURE_TYPE_MAX; ++type) {
      const auto kind = static_cast<aiTextureType>(type);
      for (unsigned i = 0; i < scene.mMaterials[m]->GetTextureCount(kind); ++i) {
        aiString name;
        if (scene.mMaterials[m]->GetTexture(kind, i, &name) == aiReturn_SUCCESS)
          names.push_back((folder / name.C_Str()).string());
      }
    }
  }
}

void append_names(std::string& out, const std::vector<std::string>& names) {
  std::vector<char> all;  // each ends with a zero byte
  for (const std::string& name : names) {
    all.insert(all.end(), name.begin(), name.end());
    all.push_back('\0');
  }
  append_array(out, all);
}

bool take_names(std::string_view& in, std::vector<std::string>& names) {
  std::vector<char> all;
  if (!take_array(in, all) || (!all.empty() && all.back() != '\0')) return false;
  for (auto name = all.begin(); name != all.end();) {
    const auto stop = std::find(name, all.end(), '\0');
    names.emplace_back(name, stop);
    name = stop + 1;
  }
  return true;
}

/// Keeps the last warning or error of assimp.
class LastRemark final : public Assimp::LogStream {
 public:
  explicit LastRemark(std::string& text) : text_(text) {}
  void write(const char* message) override {
    text_ = message;  // "Warn,  T0: text\n"
    const std::size_t begin = text_.find(": ");
    if (begin != std::string::npos) text_.erase(0, begin + 2);
    while (text_.ends_with('\n')) text_.pop_back();
  }

 private:
  std::string& text_;
};

/// Why assimp read nothing. assimp does not say why none of its readers accepts a file.
std::string refusal(const Assimp::Importer& importer, const std::string& path) {
  std::string why = importer.GetErrorString();
  if (why.starts_with("No suitable reader"))
    why = fmt::format("cannot be read as {}: damaged, truncated or of another version",
                      printable_name(std::filesystem::path(path).extension().string()));
  return why;
}

/// Triangles of the meshes below a node, each mesh counted once.
std::uint64_t triangles_below(const aiScene& scene, const aiNode& root) {
  std::vector<const aiNode*> left{&root};
  std::set<unsigned> meshes;
  while (!left.empty()) {
    const aiNode& node = *left.back();
    left.pop_back();
    meshes.insert(node.mMeshes, node.mMeshes + node.mNumMeshes);
    left.insert(left.end(), node.mChildren, node.mChildren + node.mNumChildren);
  }
  std::uint64_t triangles = 0;
  for (const unsigned m : meshes)
    for (unsigned i = 0; i < scene.mMeshes[m]->mNumFaces; ++i)
      triangles += scene.mMeshes[m]->mFaces[i].mNumIndices == 3 ? 1 : 0;
  return triangles;
}

/// Runs in the child and returns the bytes for the parent.
std::string import(const std::string& path) {
  try {
    const std::string extension = lower_extension(path);
    std::optional<std::uint64_t> triangles;
    if (extension == ".gltf" || extension == ".glb") triangles = gltf_triangles(path);
    std::vector<std::string> files;
    std::string remark;
    Assimp::DefaultLogger::create("", Assimp::Logger::NORMAL, 0);
    Assimp::DefaultLogger::get()->attachStream(new LastRemark(remark),
                                               Assimp::Logger::Warn | Assimp::Logger::Err);
    Assimp::Importer importer;
    auto* const noting = new NotingFiles(files, path);
    importer.SetIOHandler(noting);  // the importer owns it from now on
    const aiScene* scene = importer.ReadFile(path, aiProcess_Triangulate);
    if (!noting->refused().empty())
      return kMessageFollows + fmt::format("names {}", noting->refused());
    if (scene == nullptr) {
      const std::string why = refusal(importer, path);
      if (why.find("bad_alloc") != std::string::npos) return std::string(1, kTooLarge);
      return kMessageFollows + why;
    }
    // Importers set the flag for files without meshes. Some make a mesh from the skeleton then.
    if (scene->mNumMeshes == 0 || (scene->mFlags & AI_SCENE_FLAGS_INCOMPLETE) != 0)
      return kMessageFollows + std::string("has no meshes") +
             (remark.empty() ? "" : "; assimp says: " + remark);
    if (scene->mRootNode == nullptr)
      return kMessageFollows + std::string("the scene is incomplete");
    if (const std::uint64_t read = triangles_below(*scene, *scene->mRootNode);
        triangles.value_or(read) != read)
      return kMessageFollows + fmt::format("has {} of {} with corner numbers out of range",
                                           *triangles - read, counted(*triangles, "triangle"));
    Mesh mesh;
    VertexPool pool(mesh.vertices);
    append_node(mesh, pool, *scene, *scene->mRootNode, Eigen::Matrix4d::Identity());
    std::string out(1, kMeshFollows);
    append_array(out, mesh.vertices);
    append_array(out, mesh.faces);
    append_array(out, std::vector<std::uint64_t>{mesh.dropped});
    append_parts(out, mesh.parts);
    note_textures(*scene, path, files);
    append_names(out, files);
    return out;
  } catch (const std::bad_alloc&) {
    return std::string(1, kTooLarge);
  } catch (const std::exception& e) {
    return kMessageFollows + std::string(e.what());
  }
}

void limit_child(std::chrono::seconds time, std::uint64_t memory) {
  const rlimit none{0, 0};
  ::setrlimit(RLIMIT_CORE, &none);
  const auto seconds = static_cast<rlim_t>(std::max<std::chrono::seconds::rep>(time.count(), 1));
  const rlimit processor{seconds, seconds + 1};
  ::setrlimit(RLIMIT_CPU, &processor);
  if (kSanitizer) return;  // the sanitizer's shadow alone takes terabytes of address space
  const rlim_t bytes = data_bytes() + memory;
  const rlimit data{bytes, bytes};
  ::setrlimit(RLIMIT_DATA, &data);
}

/// Ends the child without running the parent's exit handlers.
[[noreturn]] void leave(int status) {
#ifdef CDE_COVERAGE
  __gcov_dump();
#endif
  ::_exit(status);
}

std::uint64_t most_resident_bytes() {
  rusage used{};
  ::getrusage(RUSAGE_SELF, &used);
  return static_cast<std::uint64_t>(used.ru_maxrss) * 1024;
}

/// If an importer fails with much of its memory used, a lack of memory may be the reason. Some
/// importers do not check malloc and report a file without meshes.
std::string with_memory(std::string answer, std::uint64_t before, std::uint64_t memory) {
  const std::uint64_t most = most_resident_bytes(), taken = most - std::min(most, before);
  if (answer.front() != kMessageFollows || taken < memory / 2) return answer;
  return answer + fmt::format(" (it used {} of its {} MB; CDE_READ_MEMORY sets another limit)",
                              taken >> 20, memory >> 20);
}

[[noreturn]] void run_child(int out, const std::string& path, std::chrono::seconds time,
                            std::uint64_t memory) {
  const std::uint64_t before = most_resident_bytes();
  limit_child(time, memory);
  // The C library's message about a broken heap would only confuse.
  const int null = ::open("/dev/null", O_WRONLY);
  ::dup2(null, 2);
  leave(process::write_all(out, with_memory(import(path), before, memory)) ? 0 : 1);
}

}  // namespace

bool assimp_knows(const std::string& extension) {
  return extension.size() > 1 && Assimp::Importer().IsExtensionSupported(extension);
}

Mesh read_by_assimp(const std::filesystem::path& path, const MeshLimits& limits) {
  const std::string name = path.string();
  const auto fail = [&](const std::string& why) {
    throw Error(ErrorCode::kFile, fmt::format("{}: {}", printable_name(name), printable_name(why)));
  };
  const std::uint64_t memory = memory_of(path, limits);
  const Deadline deadline(limits.time);
  const process::Result ran = process::run_isolated(
      [&](int out) { run_child(out, name, limits.time, memory); }, limits.time);
  if (ran.timed_out || ran.status == 128 + SIGXCPU) fail_slow(path, limits.time);
  if (ran.status == 128 + SIGKILL || ran.output == std::string(1, kTooLarge))
    fail_large(path, memory);
  if (ran.status != 0) fail("the importer crashed; the file is probably damaged");
  std::string_view rest = ran.output;
  if (rest.empty()) fail("the importer ended without an answer");
  const char kind = rest.front();
  rest.remove_prefix(1);
  if (kind == kMessageFollows) fail(std::string(rest));
  Mesh mesh;
  std::vector<std::uint64_t> dropped;
  std::vector<std::string> files;
  if (!take_array(rest, mesh.vertices) || !take_array(rest, mesh.faces) ||
      !take_array(rest, dropped) || dropped.size() != 1 || !take_parts(rest, mesh.parts) ||
      !take_names(rest, files)) {
    fail("the importer's answer is truncated");
  }
  mesh.dropped = dropped[0];
  const MeshFolder folder(path);
  NamedFiles named(mesh, folder, deadline, memory);
  for (const std::string& file : files)
    (void)named.add(path.parent_path(), std::filesystem::absolute(file).string());
  return mesh;
}

}  // namespace cde::mesh_readers
