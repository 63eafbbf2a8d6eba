// SPDX-License-Identifier: Apache-2.0
#include <assimp/DefaultIOSystem.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <assimp/Importer.hpp>

#include <fcntl.h>
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/process.hpp"
#include "mesh/readers.hpp"
#include "support/sanitizer.hpp"
#include "support/text.hpp"

#ifdef CDE_COVERAGE
extern "C" void __gcov_dump();  // NOLINT(bugprone-reserved-identifier): libgcov's
#endif

// Every format that has no reader of its own. assimp runs in a child process, because it dies,
// hangs or takes all memory on some damaged files; the mesh comes back through a pipe.
namespace cde::mesh_readers {
namespace {

constexpr char kMeshFollows = 'M';
constexpr char kMessageFollows = 'E';

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
  std::vector<char> names;  // each with a zero behind it
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

/// Keeps the names of the files that an importer opens. assimp takes the URIs of glTF for names;
/// where no file is called so, the one that the URI means is opened.
class NotingFiles : public Assimp::DefaultIOSystem {
 public:
  explicit NotingFiles(std::vector<std::string>& names) : names_(names) {}
  bool Exists(const char* name) const override {
    return DefaultIOSystem::Exists(file_of(name).c_str());
  }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    names_.push_back(file_of(name));
    return DefaultIOSystem::Open(names_.back().c_str(), mode);
  }

 private:
  [[nodiscard]] std::string file_of(const char* name) const {
    const std::string meant = text::percent_decoded(name);
    return !DefaultIOSystem::Exists(name) && DefaultIOSystem::Exists(meant.c_str()) ? meant : name;
  }
  std::vector<std::string>& names_;
};

/// Textures, which are not opened. What is in the file itself has the name "*N".
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
  std::vector<char> all;  // each with a zero behind it
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

/// In the child: what to send to the parent.
std::string import(const std::string& path) {
  try {
    std::vector<std::string> files;
    Assimp::Importer importer;
    importer.SetIOHandler(new NotingFiles(files));  // which is the importer's from now on
    const aiScene* scene = importer.ReadFile(path, aiProcess_Triangulate);
    if (scene == nullptr) return kMessageFollows + std::string(importer.GetErrorString());
    // The flag is what importers say of files without meshes; some make one of the skeleton then.
    if (scene->mNumMeshes == 0 || (scene->mFlags & AI_SCENE_FLAGS_INCOMPLETE) != 0)
      return kMessageFollows + std::string("has no meshes");
    if (scene->mRootNode == nullptr)
      return kMessageFollows + std::string("the scene is incomplete");
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
    return kMessageFollows + std::string("takes more memory than half of this machine's");
  } catch (const std::exception& e) {
    return kMessageFollows + std::string(e.what());
  }
}

void limit_child(std::chrono::seconds deadline) {
  const rlimit none{0, 0};
  ::setrlimit(RLIMIT_CORE, &none);
  const auto seconds =
      static_cast<rlim_t>(std::max<std::chrono::seconds::rep>(deadline.count(), 1));
  const rlimit time{seconds, seconds + 1};
  ::setrlimit(RLIMIT_CPU, &time);
  if (kSanitizer) return;  // its shadow alone takes terabytes of address space
  const auto half = static_cast<rlim_t>(::sysconf(_SC_PHYS_PAGES)) / 2 *
                    static_cast<rlim_t>(::sysconf(_SC_PAGESIZE));
  const rlimit memory{half, half};
  ::setrlimit(RLIMIT_DATA, &memory);
}

/// Ends the child without what the parent has registered for its own end.
[[noreturn]] void leave(int status) {
#ifdef CDE_COVERAGE
  __gcov_dump();
#endif
  ::_exit(status);
}

[[noreturn]] void run_child(int out, const std::string& path, std::chrono::seconds deadline) {
  limit_child(deadline);
  // The C library's last words on a broken heap would only confuse.
  const int null = ::open("/dev/null", O_WRONLY);
  ::dup2(null, 2);
  leave(process::write_all(out, import(path)) ? 0 : 1);
}

}  // namespace

bool assimp_knows(const std::string& extension) {
  return extension.size() > 1 && Assimp::Importer().IsExtensionSupported(extension);
}

Mesh read_by_assimp(const std::filesystem::path& path, std::chrono::seconds deadline) {
  const std::string name = path.string();
  const auto fail = [&](const std::string& why) {
    throw Error(ErrorCode::kFile, fmt::format("{}: {}", printable_name(name), printable_name(why)));
  };
  const process::Result ran = process::isolated([&](int out) { run_child(out, name, deadline); });
  if (ran.status == 128 + SIGXCPU || ran.status == 128 + SIGKILL) {
    fail(fmt::format(
        "not read within {} s of processor time, or out of memory; the file is probably damaged",
        deadline.count()));
  }
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
    fail("the importer's answer is cut short");
  }
  mesh.dropped = dropped[0];
  for (const std::string& file : files)
    add_named_file(mesh, path, std::filesystem::absolute(file).string());
  return mesh;
}

}  // namespace cde::mesh_readers
