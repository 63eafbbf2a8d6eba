// SPDX-License-Identifier: Apache-2.0
// Small mesh files that hang an importer or request gigabytes.
#include <fmt/format.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <fstream>
#include <thread>

#include "cde/mesh/mesh.hpp"
#include "glb.hpp"
#include "testing.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;

constexpr MeshLimits kShort{.time = std::chrono::seconds(2)};

/// A glTF file with one triangle whose data lie in `buffer`. Each of `depth` nodes contains the
/// next node twice.
std::string gltf(const std::string& buffer, unsigned depth) {
  std::string nodes;
  for (unsigned i = 0; i < depth; ++i)
    nodes += fmt::format("{{\"children\":[{},{}]}},", i + 1, i + 1);
  return fmt::format(
      R"({{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{}{{"mesh":0}}],)"
      R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],)"
      R"("accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}}],)"
      R"("bufferViews":[{{"buffer":0,"byteLength":36}}],"buffers":[{{"uri":"{}","byteLength":36}}]}})",
      nodes, buffer);
}

/// A ZIP archive of deflated files.
std::string zip(const std::vector<std::pair<std::string, std::string>>& files) {
  std::string out, list;
  for (const auto& [name, text] : files) {
    std::string packed(::compressBound(text.size()), '\0');
    z_stream stream{};
    EXPECT_EQ(::deflateInit2(&stream, 9, Z_DEFLATED, -MAX_WBITS, 9, Z_DEFAULT_STRATEGY), Z_OK);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
    stream.avail_in = static_cast<uInt>(text.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = static_cast<uInt>(packed.size());
    EXPECT_EQ(::deflate(&stream, Z_FINISH), Z_STREAM_END);
    packed.resize(stream.total_out);
    ::deflateEnd(&stream);
    const auto sum =
        ::crc32(0, reinterpret_cast<const Bytef*>(text.data()), static_cast<uInt>(text.size()));
    const std::string both = half(20) + half(0) + half(8) + word(0) +
                             word(static_cast<std::uint32_t>(sum)) +
                             word(static_cast<std::uint32_t>(packed.size())) +
                             word(static_cast<std::uint32_t>(text.size())) +
                             half(static_cast<std::uint16_t>(name.size())) + half(0);
    list += "PK\1\2" + half(20) + both + half(0) + half(0) + half(0) + word(0) +
            word(static_cast<std::uint32_t>(out.size())) + name;
    out += "PK\3\4" + both + name + packed;
  }
  const auto count = half(static_cast<std::uint16_t>(files.size()));
  return out + list + "PK\5\6" + half(0) + half(0) + count + count +
         word(static_cast<std::uint32_t>(list.size())) +
         word(static_cast<std::uint32_t>(out.size())) + half(0);
}

/// A mesh of one triangle, repeated. `x` is the first coordinate of its first corner.
std::string file_of_3mf(unsigned triangles, const std::string& x = "0") {
  const std::string site = "http://schemas.openxmlformats.org/package/2006/";
  std::string model =
      "<model xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"><resources>"
      "<object id=\"1\" type=\"model\"><mesh><vertices><vertex x=\"" +
      x +
      "\" y=\"0\" z=\"5\"/>"
      "<vertex x=\"1\" y=\"0\" z=\"0\"/><vertex x=\"0\" y=\"1\" z=\"0\"/></vertices><triangles>";
  for (unsigned i = 0; i < triangles; ++i) model += "<triangle v1=\"0\" v2=\"1\" v3=\"2\"/>";
  model += "</triangles></mesh></object></resources><build><item objectid=\"1\"/></build></model>";
  return zip({{"_rels/.rels",
               fmt::format("<Relationships xmlns=\"{}relationships\"><Relationship Id=\"r\" "
                           "Target=\"/3D/3dmodel.model\" Type=\"http://schemas.microsoft.com/"
                           "3dmanufacturing/2013/01/3dmodel\"/></Relationships>",
                           site)},
              {"3D/3dmodel.model", model}});
}

std::uint64_t data_bytes() {
  std::ifstream file("/proc/self/statm");
  std::uint64_t pages[6] = {};
  for (std::uint64_t& count : pages) file >> count;
  return pages[5] * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

class HostileMesh : public ::testing::Test {
 protected:
  HostileMesh() {
    const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    folder_.write("b.bin", std::string(reinterpret_cast<const char*>(corners), sizeof corners));
  }
  const Folder folder_;
};

TEST_F(HostileMesh, FifoAsBuffer_IsRefused) {
  ASSERT_EQ(load_mesh(folder_.write("good.gltf", gltf("b.bin", 0))).faces.size(), 1u);
  ASSERT_EQ(::mkfifo((folder_ / "fifo").c_str(), 0600), 0);
  const fs::path mesh = folder_.write("a.gltf", gltf("fifo", 0));
  expect_error(ErrorCode::kFile, "fifo, which is not a regular file",
               [&] { (void)load_mesh(mesh, kShort); });
}

/// The text of a glTF with one part of it exchanged.
std::string with(std::string text, const std::string& part, const std::string& other) {
  const std::size_t at = text.find(part);
  EXPECT_NE(at, std::string::npos) << part;
  return text.replace(at, part.size(), other);
}

TEST_F(HostileMesh, GltfDataOutsideItsBufferIsRefused) {
  const std::string good = gltf("b.bin", 0);
  struct Case {
    const char *part, *other, *message;
  };
  for (const Case& c : {
           Case{"\"componentType\":5126", "\"byteOffset\":-8,\"componentType\":5126",
                "accessors[0] has byteOffset -8; expected a whole number from 0 to 2^53"},
           Case{"\"buffer\":0,", "\"buffer\":0,\"byteOffset\":-8,",
                "bufferViews[0] has byteOffset -8"},
           Case{"\"buffer\":0,", "\"buffer\":0,\"byteOffset\":8,",
                "bufferViews[0] ends at byte 44 of buffers[0], which has 36"},
           Case{"\"buffer\":0,", "\"buffer\":0,\"byteStride\":1.5,",
                "bufferViews[0] has byteStride 1.5"},
           Case{"\"buffer\":0,", "\"buffer\":1,",
                "bufferViews[0] names buffers[1], which the file does not have"},
           Case{"\"bufferView\":0", "\"bufferView\":7",
                "accessors[0] names bufferViews[7], which the file does not have"},
           Case{"\"componentType\":5126", "\"byteOffset\":4,\"componentType\":5126",
                "accessors[0] has 3 elements of 12 bytes from byte 4; bufferViews[0] holds 2"},
           Case{"\"count\":3", "\"count\":18446744073709551615",
                "accessors[0] has count 18446744073709551615"},
           Case{"\"count\":3", "\"counts\":3", "accessors[0] has no count"},
       }) {
    const std::string json = with(good, c.part, c.other);
    expect_error(ErrorCode::kFile, std::string("a.gltf: ") + c.message,
                 [&] { (void)load_mesh(folder_.write("a.gltf", json)); });
    expect_error(ErrorCode::kFile, std::string("a.GLB: ") + c.message, [&] {
      (void)load_mesh(folder_.write("a.GLB", chunks_of_glb(json, std::string(36, '\0'))));
    });
  }
  for (const std::string& json :
       {std::string(), std::string("[]"), std::string("{"), std::string("{\"accessors\":[1]}"),
        std::string(100000, '['), std::string("{\"bufferViews\":[{}]}")})
    for (const char* name : {"b.gltf", "b.glb"})
      expect_error(ErrorCode::kFile, name,
                   [&, text = name[3] == 'l' ? chunks_of_glb(json, "") : json] {
                     (void)load_mesh(folder_.write(name, text));
                   });
}

TEST_F(HostileMesh, GltfThatIsNotReadRight_IsRefused) {
  const std::string good = gltf("b.bin", 0);
  const auto refused = [&](const std::string& json, const std::string& message) {
    expect_error(ErrorCode::kFile, "a.gltf: " + message,
                 [&] { (void)load_mesh(folder_.write("a.gltf", json)); });
  };
  refused(with(good, "5126", "5123"),
          "accessors[0] has positions of componentType 5123 and type \"VEC3\"; expected 5126");
  refused(with(good, "VEC3", "VEC2"), "accessors[0] has positions of componentType 5126 and type");
  refused(with(good, "{", "{\"extensionsRequired\":[\"KHR_texture_transform\",\"EXT_new\"],"),
          "extensionsRequired has \"EXT_new\", which is not read");
  EXPECT_EQ(load_mesh(folder_.write("a.gltf", with(good, "{",
                                                   "{\"extensionsRequired\":["
                                                   "\"KHR_materials_unlit\"],")))
                .faces.size(),
            1u);
}

/// A mesh of a stranger could otherwise copy bytes of any file of the user into an output.
TEST_F(HostileMesh, AFileOutsideTheFolderOfTheMesh_IsRefused) {
  const fs::path inner = folder_ / "inner";
  fs::create_directory(inner);
  fs::create_symlink("../b.bin", inner / "link.bin");
  fs::create_symlink(inner / "a.gltf", folder_ / "link.gltf");
  for (const std::string name : {"../b.bin", "%2e%2e/b.bin", "link.bin"}) {
    folder_.write("inner/a.gltf", gltf(name, 0));
    expect_error(ErrorCode::kFile, "which is outside the folder of the mesh",
                 [&] { (void)load_mesh(inner / "a.gltf"); });
  }
  fs::create_directory(inner / "below");
  fs::copy_file(folder_ / "b.bin", inner / "below/b.bin");
  folder_.write("inner/a.gltf", gltf("below/b.bin", 0));
  EXPECT_EQ(load_mesh(inner / "a.gltf").faces.size(), 1u);
}

/// The buffer alternates between a file in the folder and a link to one outside. No mesh has the
/// outer corners, whenever the link appears.
TEST_F(HostileMesh, BufferReplacedByALink_NeverLeadsOutside) {
  const fs::path inner = folder_ / "inner";
  fs::create_directory(inner);
  const float outer[9] = {7, 7, 7, 8, 7, 7, 7, 8, 7};
  folder_.write("secret.bin", std::string(reinterpret_cast<const char*>(outer), sizeof outer));
  const fs::path mesh = folder_.write("inner/a.gltf", gltf("b.bin", 0));
  std::atomic<bool> stop = false;
  std::thread attacker([&] {
    std::error_code none;
    while (!stop) {
      fs::create_symlink("../secret.bin", inner / "link", none);
      fs::rename(inner / "link", inner / "b.bin", none);
      fs::copy_file(folder_ / "b.bin", inner / "copy", none);
      fs::rename(inner / "copy", inner / "b.bin", none);
    }
  });
  for (int i = 0; i < 100; ++i) {
    try {
      EXPECT_EQ(load_mesh(mesh, kShort).triangle(0).v0, Eigen::Vector3f::Zero());
    } catch (const Error&) {  // the link was there
    }
  }
  stop = true;
  attacker.join();
}

constexpr const char* kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

TEST_F(HostileMesh, LinkToAFileOfTheKernel_IsRefused) {
  for (const std::string name : {"k.stl", "k.obj", "k.ply", "k.glb"}) {
    fs::create_symlink("/proc/self/status", folder_ / name);
    expect_error(ErrorCode::kFile, name + ": is a file of the kernel",
                 [&] { (void)load_mesh(folder_ / name, kShort); });
  }
}

TEST_F(HostileMesh, MaterialLibraryOutsideTheFolder_IsIgnored) {
  fs::create_directory(folder_ / "inner");
  folder_.write("secret.mtl", "map_Kd skin.png\n");
  folder_.write("inner/skin.png", "pixels");
  fs::create_symlink("../secret.mtl", folder_ / "inner/link.mtl");
  for (const std::string& name :
       {std::string("../secret.mtl"), std::string("link.mtl"), (folder_ / "secret.mtl").string(),
        std::string("/proc/self/status")}) {
    const Mesh mesh = load_mesh(
        folder_.write("inner/a.obj", "mtllib " + name + "\n" + std::string(kTriangle)), kShort);
    EXPECT_TRUE(mesh.files.empty()) << name;
    ASSERT_FALSE(mesh.warnings.empty()) << name;
    EXPECT_NE(mesh.warnings[0].find("is outside the folder of the mesh"), std::string::npos)
        << mesh.warnings[0];
  }
}

/// Six gigabytes of zeros on no disk blocks.
TEST_F(HostileMesh, HugeMaterialLibrary_IsNotRead) {
  folder_.write("a.mtl", "");
  fs::resize_file(folder_ / "a.mtl", std::uintmax_t{6} << 30);
  const auto began = std::chrono::steady_clock::now();
  const Mesh mesh =
      load_mesh(folder_.write("a.obj", "mtllib a.mtl\n" + std::string(kTriangle)), kShort);
  EXPECT_EQ(mesh.files.size(), 1u);
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(2));
}

/// A library of a megabyte that names `words` files in each line.
std::string library_of(unsigned words) {
  std::string line = "map_Kd";
  for (unsigned i = 0; i < words; ++i) line += " a";
  std::string text;
  while (text.size() + line.size() + 1 < (1u << 20)) text += line + "\n";
  return text;
}

TEST_F(HostileMesh, LibraryUnderManyNames_IsReadOnce) {
  folder_.write("m.mtl", library_of(2000));
  fs::create_hard_link(folder_ / "m.mtl", folder_ / "other.mtl");
  std::string text = "mtllib other.mtl\n", prefix;
  for (unsigned i = 0; i < 400; ++i) text += "mtllib " + (prefix += "./") + "m.mtl\n";
  const Mesh mesh = load_mesh(folder_.write("a.obj", text + kTriangle), kShort);
  EXPECT_EQ(mesh.files.size(), 401u);
}

TEST_F(HostileMesh, ManyLibraries_EndAtTheTimeLimit) {
  std::string text;
  for (unsigned i = 0; i < 30; ++i)
    text += "mtllib " +
            folder_.write(fmt::format("m{}.mtl", i), library_of(32)).filename().string() + "\n";
  const fs::path mesh = folder_.write("a.obj", text + kTriangle);
  const auto began = std::chrono::steady_clock::now();
  expect_error(ErrorCode::kFile, "not read within 1 s; the file is probably damaged",
               [&] { (void)load_mesh(mesh, {.time = std::chrono::seconds(1)}); });
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(10));
}

TEST_F(HostileMesh, ManyNamesOfALibrary_HaveALimitOfMemory) {
  folder_.write("m.mtl", "");
  std::string text, prefix;
  for (unsigned i = 0; i < 1500; ++i) text += "mtllib " + (prefix += "./") + "m.mtl\n";
  const fs::path mesh = folder_.write("a.obj", text + kTriangle);
  EXPECT_EQ(load_mesh(mesh, {}).files.size(), 1500u);
  expect_error(ErrorCode::kFile, "takes more than 1 MB to read",
               [&] { (void)load_mesh(mesh, {.memory = 1u << 20}); });
}

/// Options of a texture precede its name.
TEST_F(HostileMesh, TextureBehindOptions_IsFound) {
  folder_.write("a b.png", "pixels");
  folder_.write(
      "m.mtl",
      "map_Kd -blendu on -blendv on -boost 1 -mm 0 1 -o 0 0 0 -s 1 1 1 -t 0 0 0 -texres 9 "
      "-clamp on -bm 1 -imfchan r -type sphere a%20b.png\n");
  const Mesh mesh =
      load_mesh(folder_.write("a.obj", "mtllib m.mtl\n" + std::string(kTriangle)), kShort);
  ASSERT_EQ(mesh.files.size(), 2u);
  EXPECT_EQ(mesh.files[1].filename(), "a b.png");
}

/// Faces of 1024 corners along a spiral take cubic time to cut.
TEST_F(HostileMesh, SpiralFaces_EndAtTheTimeLimit) {
  std::string text, face = "f";
  for (int i = 0; i < 1024; ++i) {
    const int step = i < 512 ? i : 1023 - i;
    const double angle = 0.1 * step, radius = 1 + 0.02 * step + (i < 512 ? 0 : 0.3);
    text += fmt::format("v {} {} 0\n", radius * std::cos(angle), radius * std::sin(angle));
    face += fmt::format(" {}", i + 1);
  }
  for (int i = 0; i < 5000; ++i) text += face + "\n";
  const fs::path mesh = folder_.write("spiral.obj", text);
  const auto began = std::chrono::steady_clock::now();
  expect_error(ErrorCode::kFile, "not read within 1 s (CDE_READ_SECONDS sets another limit)",
               [&] { (void)load_mesh(mesh, {.time = std::chrono::seconds(1)}); });
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(20));
}

TEST_F(HostileMesh, MemoryBeyondTheLimit_IsRefused) {
  const fs::path doubling = folder_.write("doubling.gltf", gltf("b.bin", 26));
  expect_error(ErrorCode::kFile, "doubling.gltf: takes more than 512 MB to read",
               [&] { (void)load_mesh(doubling); });
  expect_error(ErrorCode::kFile, "doubling.gltf: takes more than 64 MB to read",
               [&] { (void)load_mesh(doubling, {.memory = 64u << 20}); });
  const fs::path off = folder_.write("vertices.off", "OFF\n1000000000 1 0\n0 0 0\n");
  expect_error(ErrorCode::kFile, "vertices.off:3: the file ends after 1 of 1000000000 vertices",
               [&] { (void)load_mesh(off); });
  rusage used{};
  ASSERT_EQ(::getrusage(RUSAGE_CHILDREN, &used), 0);
  EXPECT_LT(used.ru_maxrss, 1 << 20) << "KB";
}

/// An accessor without data, of 500 bytes, that claims 3.6 GB of zeros.
TEST_F(HostileMesh, GlbClaimingGigabytes_IsRefused) {
  const auto file = [&](unsigned count) {
    std::string json = fmt::format(
        R"({{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],)"
        R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],"accessors":[{{)"
        R"("componentType":5126,"count":{},"type":"VEC3","sparse":{{"count":1,)"
        R"("indices":{{"bufferView":0,"componentType":5125}},"values":{{"bufferView":0}}}}}}],)"
        R"("bufferViews":[{{"buffer":0,"byteLength":36}}],"buffers":[{{"byteLength":36}}]}})",
        count);
    json.resize((json.size() + 3) / 4 * 4, ' ');
    return chunks_of_glb(json, std::string(36, '\0'));
  };
  EXPECT_EQ(load_mesh(folder_.write("good.glb", file(3))).faces.size(), 1u);
  const fs::path large = folder_.write("large.glb", file(300'000'000));
  expect_error(ErrorCode::kFile, "large.glb: takes more than 512 MB to read",
               [&] { (void)load_mesh(large); });
}

/// XML that repeats one line a million times: 80 kB, and half a gigabyte as a tree.
TEST_F(HostileMesh, UnpackedGigabytesOf3mf_AreRefused) {
  EXPECT_EQ(load_mesh(folder_.write("good.3mf", file_of_3mf(2))).faces.size(), 2u);
  const std::string bytes = file_of_3mf(1'000'000);
  ASSERT_LT(bytes.size(), 200'000u);
  const fs::path large = folder_.write("large.3mf", bytes);
  expect_error(ErrorCode::kFile, "of its 100 MB; CDE_READ_MEMORY sets another limit",
               [&] { (void)load_mesh(large, {.memory = 100u << 20}); });
}

/// docs/guides/meshes.md says so.
TEST_F(HostileMesh, WordAsCoordinateOf3mf_ReadsZero) {
  const Mesh mesh = load_mesh(folder_.write("word.3mf", file_of_3mf(1, "one")));
  ASSERT_EQ(mesh.vertices.size(), 3u);
  EXPECT_EQ(mesh.triangle(0).v0, Eigen::Vector3f(0, 0, 5));
}

/// A file that assimp refuses is refused with assimp's reason, or with ours if assimp gives none.
TEST_F(HostileMesh, RefusalByAssimp_HasItsReason) {
  std::string json = R"({"asset":{"version":"2.0"}})";
  json.resize(28, ' ');
  const std::string whole = chunks_of_glb(json, std::string(36, '\0'));
  const fs::path cut = folder_.write("cut.glb", whole.substr(0, whole.size() - 60));
  expect_error(ErrorCode::kFile,
               "cut.glb: cannot be read as .glb: damaged, truncated or of another version",
               [&] { (void)load_mesh(cut); });
  const fs::path unknown = folder_.write("unknown.3mf", zip({{"other.txt", "x"}}));
  expect_error(ErrorCode::kFile,
               "unknown.3mf: has no meshes; assimp says: ", [&] { (void)load_mesh(unknown); });
}

/// The readers of OBJ, PLY and STL run in this process. They allocate no memory for counts in a
/// header.
TEST_F(HostileMesh, CountsInHeaders_AllocateNothing) {
  const auto ply = [](const char* format, const char* vertices) {
    return fmt::format(
        "ply\nformat {} 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
        "property float z\nelement face 4000000000\n"
        "property list uint int vertex_indices\nend_header\n",
        format, vertices);
  };
  const std::string corners(36, '\0'), most(4, '\xff');
  const std::pair<const char*, std::string> files[] = {
      {"ascii.ply", ply("ascii", "4000000000") + "0 0 0\n"},
      {"little.ply", ply("binary_little_endian", "4000000000") + corners},
      {"faces.ply", ply("binary_little_endian", "3") + corners + most + corners},
      {"list.ply", ply("ascii", "1") + "0 0 0\n4294967295 0 0 0\n"},
      {"a.stl", std::string(80, '\0') + most + std::string(50, '\0')},
      {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 4000000000 2 3\n"},
      {"negative.obj", "v 0 0 0\nf -4000000000 1 1\n"},
  };
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_DATA, &before), 0);
  for (const auto& [name, bytes] : files) {
    const fs::path mesh = folder_.write(name, bytes);
    const rlimit little{data_bytes() + (64u << 20), before.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_DATA, &little), 0);
    expect_error(ErrorCode::kFile, fmt::format("{}:", name), [&] { (void)load_mesh(mesh); });
    ASSERT_EQ(::setrlimit(RLIMIT_DATA, &before), 0);
  }
}

/// A file that takes forever: doubling nodes that exceed the time limit before the memory limit.
TEST_F(HostileMesh, SlowFile_EndsAtTheTimeLimit) {
  const fs::path mesh = folder_.write("slow.gltf", gltf("b.bin", 40));
  const auto began = std::chrono::steady_clock::now();
  expect_error(ErrorCode::kFile, "slow.gltf: not read within 1 s", [&] {
    (void)load_mesh(mesh, {.time = std::chrono::seconds(1), .memory = std::uint64_t{16} << 30});
  });
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(20));
}

/// Importers of a killed process end with it.
TEST_F(HostileMesh, KilledProcess_LeavesNoImporter) {
  const fs::path mesh = folder_.write("slow.gltf", gltf("b.bin", 40));
  const pid_t child = ::fork();
  if (child == 0) {
    try {
      (void)load_mesh(mesh, {.time = std::chrono::seconds(60), .memory = std::uint64_t{8} << 30});
    } catch (const Error&) {
    }
    ::_exit(0);
  }
  const std::string children = fmt::format("/proc/{0}/task/{0}/children", child);
  pid_t importer = 0;
  for (int i = 0; i < 1000 && importer == 0; ++i) {
    std::ifstream(children) >> importer;
    ::usleep(10'000);
  }
  ASSERT_NE(importer, 0);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  bool ended = false;
  for (int i = 0; i < 1000 && !ended; ++i) {
    std::ifstream stat(fmt::format("/proc/{}/stat", importer));
    std::string number, name, state;
    ended = !(stat >> number >> name >> state) || state == "Z";
    ::usleep(10'000);
  }
  EXPECT_TRUE(ended);
}

/// The time that loading takes.
template <typename Load>
std::chrono::steady_clock::duration time_of(Load load) {
  const auto begin = std::chrono::steady_clock::now();
  load();
  return std::chrono::steady_clock::now() - begin;
}

/// A binary STL whose vertices all collide under a fixed hash of two multiplications.
std::string colliding_stl(std::uint32_t facets) {
  constexpr std::uint64_t kFactor = 0x9e3779b97f4a7c15u;
  std::uint64_t inverse = kFactor;
  for (int i = 0; i < 6; ++i) inverse *= 2 - kFactor * inverse;
  std::string text(80, ' ');
  text += word(facets);
  std::uint32_t low = 0;
  const auto finite = [](std::uint32_t bits) { return (bits >> 23 & 0xff) != 0xff; };
  for (std::uint32_t i = 0; i < facets; ++i) {
    text += std::string(12, '\0');
    for (int corner = 0; corner < 3;) {
      const std::uint64_t h = std::uint64_t{0x12345678} << 32 | low++, xy = h * inverse;
      const auto x = static_cast<std::uint32_t>(xy >> 32), y = static_cast<std::uint32_t>(xy),
                 z = static_cast<std::uint32_t>(h ^ h >> 29);
      if (!finite(x) || !finite(y) || !finite(z)) continue;
      text += word(x) + word(y) + word(z);
      ++corner;
    }
    text += half(0);
  }
  return text;
}

TEST_F(HostileMesh, CollidingVerticesOfStl_AreReadInLinearTime) {
  const auto file = folder_.write("a.stl", colliding_stl(40'000));
  Mesh mesh;
  EXPECT_LT(time_of([&] { mesh = load_mesh(file); }), std::chrono::seconds(5));
  EXPECT_EQ(mesh.vertices.size(), 120'000u);
  for (std::uint32_t i = 0; i < mesh.faces.size(); ++i)
    EXPECT_EQ(mesh.faces[i], (std::array<std::uint32_t, 3>{3 * i, 3 * i + 1, 3 * i + 2}));
}

TEST_F(HostileMesh, ManyElementsOfPly_AreReadInLinearTime) {
  std::string text = "ply\nformat ascii 1.0\n";
  for (unsigned i = 0; i < 170'000; ++i) text += fmt::format("element e{} 0\n", i);
  text +=
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\n";
  const auto file = folder_.write("a.ply", text + "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  EXPECT_LT(time_of([&] { EXPECT_EQ(load_mesh(file).faces.size(), 1u); }), std::chrono::seconds(5));
  const auto twice = folder_.write("b.ply", text + "element e7 0\nend_header\n");
  expect_error(ErrorCode::kFile, "element 'e7' appears twice", [&] { (void)load_mesh(twice); });
}

TEST_F(HostileMesh, TimeOfOwnReaders_IsLimited) {
  const std::string facet =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
      "endfacet\n";
  for (const auto& [name, text] :
       {std::pair{"a.stl", "solid a\n" + facet + "endsolid a\n"},
        {"b.stl", colliding_stl(2)},
        {"a.ply", "ply\nformat ascii 1.0\nelement vertex 0\nend_header\n"}})
    expect_error(ErrorCode::kFile, fmt::format("{}: not read within 0 s", name), [&] {
      (void)load_mesh(folder_.write(name, text), {.time = std::chrono::seconds(0)});
    });
}

/// Faces that stand before the vertices are kept: 20 million bytes, each an empty face.
TEST_F(HostileMesh, FacesBeforeVertices_TakeLittleMemory) {
  constexpr unsigned kEmpty = 20'000'000;
  const std::string header = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement face {}\n"
      "property list uchar uchar vertex_indices\nelement vertex 3\nproperty float x\n"
      "property float y\nproperty float z\nend_header\n",
      kEmpty + 1);
  std::string vertices(36, '\0');
  vertices.replace(14, 2, "\x80\x3f").replace(30, 2, "\x80\x3f");
  const fs::path file = folder_.write(
      "a.ply", header + std::string("\3\0\1\2", 4) + std::string(kEmpty, '\0') + vertices);
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_DATA, &before), 0);
  const rlimit little{data_bytes() + (400u << 20), before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_DATA, &little), 0);
  Mesh mesh;
  EXPECT_NO_THROW(mesh = load_mesh(file));
  ASSERT_EQ(::setrlimit(RLIMIT_DATA, &before), 0);
  EXPECT_EQ(mesh.faces.size(), 1u);
}

}  // namespace
}  // namespace cde::testing
