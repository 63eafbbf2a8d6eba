// SPDX-License-Identifier: Apache-2.0
#include "cde/mesh/mesh.hpp"

#include <fmt/format.h>
#include <sys/wait.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <map>

#include "cde/mesh/terrain.hpp"
#include "testing.hpp"

namespace cde {
namespace {

using testing::expect_error;
using testing::Folder;
using testing::small_mesh;

using Face = std::array<std::uint32_t, 3>;

double area(const Mesh& mesh) {
  double sum = 0.0;
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    const Triangle t = mesh.triangle(i);
    sum += 0.5 * (t.v1 - t.v0).cast<double>().cross((t.v2 - t.v0).cast<double>()).norm();
  }
  return sum;
}

/// Enclosed volume, positive if faces wind counter-clockwise seen from outside.
double volume(const Mesh& mesh) {
  double sum = 0.0;
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    const Triangle t = mesh.triangle(i);
    sum += t.v0.cast<double>().dot(t.v1.cast<double>().cross(t.v2.cast<double>())) / 6.0;
  }
  return sum;
}

bool is_closed(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& f : mesh.faces) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto a = f[i], b = f[(i + 1) % 3];
      edges[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  }
  for (const auto& [edge, balance] : edges) {
    if (balance != 0) return false;
  }
  return true;
}

/// The bits of the nine coordinates.
std::vector<std::uint32_t> words_of(const Triangle& triangle) {
  std::vector<std::uint32_t> words;
  for (const Eigen::Vector3f* v : {&triangle.v0, &triangle.v1, &triangle.v2})
    for (const float x : *v) words.push_back(std::bit_cast<std::uint32_t>(x));
  return words;
}

void expect_same_triangles(const Mesh& a, const Mesh& b) {
  ASSERT_EQ(a.faces.size(), b.faces.size());
  for (std::size_t i = 0; i < a.faces.size(); ++i)
    ASSERT_EQ(words_of(a.triangle(i)), words_of(b.triangle(i))) << "face " << i;
}

TEST(MeshTest, ObjQuads_BecomeTrianglesInPlace) {
  const Mesh cube = load_mesh(small_mesh("cube.obj"));
  EXPECT_EQ(cube.name, "cube.obj");
  ASSERT_EQ(cube.vertices.size(), 8u);
  ASSERT_EQ(cube.faces.size(), 12u);
  EXPECT_EQ(cube.faces[0], (Face{0, 2, 3}));
  EXPECT_EQ(cube.faces[1], (Face{0, 3, 1}));
  EXPECT_DOUBLE_EQ(area(cube), 24.0);
  EXPECT_DOUBLE_EQ(volume(cube), 8.0);
  EXPECT_TRUE(is_closed(cube));
}

TEST(MeshTest, BinaryPlyIcosphere_IsClosed) {
  const Mesh sphere = load_mesh(small_mesh("icosphere.ply"));
  EXPECT_EQ(sphere.vertices.size(), 642u);
  EXPECT_EQ(sphere.faces.size(), 1280u);
  EXPECT_TRUE(is_closed(sphere));
  EXPECT_NEAR(volume(sphere), 4.18879, 0.05);
}

TEST(MeshTest, BinaryStl_SharesEqualVertices) {
  const Mesh torus = load_mesh(small_mesh("torus.stl"));
  EXPECT_EQ(torus.faces.size(), 1024u);
  EXPECT_EQ(torus.vertices.size(), 512u);
  EXPECT_TRUE(is_closed(torus));
}

TEST(MeshTest, AsciiStl_IsRead) {
  const Mesh tetrahedron = load_mesh(small_mesh("tetrahedron.stl"));
  EXPECT_EQ(tetrahedron.faces.size(), 4u);
  EXPECT_NEAR(volume(tetrahedron), 1.0 / 6.0, 1e-12);
}

TEST(MeshTest, GlbNodes_AreApplied) {
  const Mesh boxes = load_mesh(small_mesh("boxes.glb"));
  ASSERT_EQ(boxes.faces.size(), 24u);
  EXPECT_DOUBLE_EQ(volume(boxes), 8.0 + 64.0);
  // The near box is at about (10, 20, 30). The far box is four away along x, rotated to four along
  // y.
  const auto box = bounds(boxes);
  EXPECT_TRUE(box.min().isApprox(Eigen::Vector3f(8, 19, 28))) << box.min().transpose();
  EXPECT_TRUE(box.max().isApprox(Eigen::Vector3f(12, 26, 32))) << box.max().transpose();
}

TEST(MeshTest, GltfWithEmbeddedBuffer_IsRead) {
  const Folder folder;
  const auto path =
      folder.write("t.gltf", R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
    "nodes":[{"mesh":0,"translation":[1,0,0]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
    "bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36}],
    "buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})");
  const Mesh mesh = load_mesh(path);
  ASSERT_EQ(mesh.faces.size(), 1u);
  EXPECT_EQ(mesh.triangle(0).v1, Eigen::Vector3f(2, 0, 0));
}

TEST(MeshTest, AwkwardFaces_AreKept) {
  const Mesh mesh = load_mesh(small_mesh("awkward.ply"));
  EXPECT_EQ(mesh.dropped, 1u);
  ASSERT_EQ(mesh.faces.size(), 15u);
  EXPECT_EQ(mesh.vertices.size(), 35u);
  EXPECT_EQ(mesh.faces[0], (Face{0, 1, 2}));
  EXPECT_EQ(mesh.faces[1], (Face{0, 1, 2}));
  EXPECT_EQ(mesh.faces[2], (Face{0, 2, 1}));
  EXPECT_EQ(mesh.faces[4], (Face{6, 6, 6}));
  EXPECT_EQ(mesh.triangle(9).v0.x(), 1e-42f);
  EXPECT_TRUE(std::signbit(mesh.triangle(10).v0.x()));
  Mesh pentagon = mesh;
  pentagon.faces.erase(pentagon.faces.begin(), pentagon.faces.begin() + 12);
  EXPECT_EQ(pentagon.faces.size(), 3u);
  EXPECT_DOUBLE_EQ(area(pentagon), 16.0 - 6.0) << "triangles cover the notch, or overlap";
}

TEST(MeshTest, ObjRelativeNumbersSlashesAndContinuation_AreRead) {
  const Folder folder;
  const Mesh mesh =
      load_mesh(folder.write("a.obj",
                             "# x\r\nv 0 0 0 1.0\r\nv +1 0 0\nv 0 0x1p0 \\\n0\nvn 0 0 1\nusemtl "
                             "m\nf -3//1 -2//1 -1//1\nl 1 2\np 1\nf 3/1/1 2 1 # back"));
  ASSERT_EQ(mesh.faces.size(), 2u);
  EXPECT_EQ(mesh.faces[0], (Face{0, 1, 2}));
  EXPECT_EQ(mesh.faces[1], (Face{2, 1, 0}));
  EXPECT_EQ(mesh.dropped, 2u);
}

TEST(MeshTest, ObjMaterials_DoNotReorderFaces) {
  const Folder folder;
  const Mesh mesh = load_mesh(folder.write("a.obj",
                                           "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nusemtl a\nf 1 2 "
                                           "3\nusemtl b\nf 2 3 4\nusemtl a\nf 1 2 4\n"));
  EXPECT_EQ(mesh.faces, (std::vector<Face>{{0, 1, 2}, {1, 2, 3}, {0, 1, 3}}));
}

TEST(MeshTest, ConcavePolygons_AreCoveredOnce) {
  const Folder folder;
  // A comb: ten teeth of area 1 on a back of area 20, in each plane and from either side.
  for (const char* order : {"xyz", "yzx", "zxy", "yxz"}) {
    std::string text, face = "f";
    int count = 0;
    const auto corner = [&](double u, double v) {
      const std::map<char, double> at = {{order[0], u}, {order[1], v}, {order[2], 3.0}};
      text += fmt::format("v {} {} {}\n", at.at('x'), at.at('y'), at.at('z'));
      face += fmt::format(" {}", ++count);
    };
    corner(0, -1);
    corner(20, -1);
    for (int tooth = 9; tooth >= 0; --tooth) {
      corner(2 * tooth + 2, 0);
      corner(2 * tooth + 1, 1);
      corner(2 * tooth + 0.5, 0);
    }
    corner(0, 0);
    const Mesh comb = load_mesh(folder.write("comb.obj", text + face + "\n"));
    EXPECT_EQ(comb.faces.size(), static_cast<std::size_t>(count - 2));
    EXPECT_NEAR(area(comb), 20.0 + 10 * 0.75, 1e-9) << order;
    Eigen::Vector3d turned = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < comb.faces.size(); ++i) {
      const Triangle t = comb.triangle(i);
      turned += 0.5 * (t.v1 - t.v0).cast<double>().cross((t.v2 - t.v0).cast<double>());
    }
    EXPECT_NEAR(turned.norm(), area(comb), 1e-9) << "a triangle is flipped: " << order;
  }
}

TEST(MeshTest, PlyVariants_AreRead) {
  const Folder folder;
  const Mesh ascii =
      load_mesh(folder.write("a.ply",
                             "ply\r\nformat ascii 1.0\r\ncomment c\r\nelement camera 1\r\nproperty "
                             "float f\r\nproperty list int float l\r\nelement vertex 3\r\n"
                             "property double z\r\nproperty uchar red\r\nproperty double "
                             "x\r\nproperty double y\r\nelement face 1\r\nproperty uchar q\r\n"
                             "property list uchar uint vertex_index\r\nend_header\r\n5 2 1.5 "
                             "2.5\r\n9 255 0.1 0\r\n9 255 1 0\r\n\r\n9 255 0 1\r\n7 3 0 1 2"));
  ASSERT_EQ(ascii.faces.size(), 1u);
  EXPECT_EQ(ascii.triangle(0).v0, Eigen::Vector3f(0.1f, 0, 9));
  std::string big =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty float "
      "y\nproperty short z\nelement face 1\n"
      "property list uchar ushort vertex_indices\nend_header\n";
  const auto word = [&](std::uint32_t w, int bytes) {
    for (int i = bytes - 1; i >= 0; --i) big.push_back(static_cast<char>(w >> (8 * i)));
  };
  for (std::uint32_t i = 0; i < 3; ++i) {
    word(i == 1 ? 0x3f800000u : 0u, 4);
    word(i == 2 ? 0x40000000u : 0u, 4);
    word(0xfffeu, 2);
  }
  word(3, 1);
  for (std::uint32_t i = 0; i < 3; ++i) word(i, 2);
  const Mesh mesh = load_mesh(folder.write("b.ply", big));
  EXPECT_EQ(mesh.triangle(0).v1, Eigen::Vector3f(1, 0, -2));
  EXPECT_EQ(mesh.triangle(0).v2, Eigen::Vector3f(0, 2, -2));
}

TEST(MeshTest, SavedMeshes_ReadBackBitIdentically) {
  const Folder folder;
  for (const Mesh& mesh : {load_mesh(small_mesh("awkward.ply")), make_terrain({40, 30, 7})}) {
    for (const char* name : {"m.obj", "m.ply", "m.stl"}) {
      save_mesh(mesh, folder / name);
      expect_same_triangles(mesh, load_mesh(folder / name));
    }
  }
  EXPECT_EQ(folder.files(), 3u) << "a temporary file was left behind";
}

TEST(MeshTest, UnsavableMeshes_AreErrors) {
  const Folder folder;
  const Mesh cube = load_mesh(small_mesh("cube.obj"));
  expect_error(ErrorCode::kUsage, "c.fbx: cannot write this format",
               [&] { save_mesh(cube, folder / "c.fbx"); });
  expect_error(ErrorCode::kFile, "c.obj: cannot create: No such file",
               [&] { save_mesh(cube, folder / "no/c.obj"); });
  std::filesystem::create_directory(folder / "d.obj");
  expect_error(ErrorCode::kFile, "Is a directory", [&] { save_mesh(cube, folder / "d.obj"); });
  expect_error(ErrorCode::kBadInput, "no triangles", [&] { save_mesh(Mesh{}, folder / "e.obj"); });
  EXPECT_EQ(folder.files(), 1u) << "a temporary file was left behind";
}

TEST(MeshTest, BuiltinNames_MakeMeshesOrAreRefused) {
  EXPECT_EQ(load_mesh_or_builtin("terrain:3,4,5").faces.size(), 24u);
  EXPECT_EQ(load_mesh_or_builtin(small_mesh("cube.obj").string()).faces.size(), 12u);
  for (const char* bad : {"terrain:", "terrain:3", "terrain:3,4", "terrain:3,4,5,6",
                          "terrain:-3,4,5", "terrain:3,4,x"}) {
    expect_error(ErrorCode::kUsage, "expected terrain:QX,QY,SEED",
                 [&] { (void)load_mesh_or_builtin(bad); });
  }
  expect_error(ErrorCode::kUsage, "terrain of 0 x 4 quads",
               [] { (void)load_mesh_or_builtin("terrain:0,4,5"); });
  expect_error(ErrorCode::kUsage, "must be 1 to 4096",
               [] { (void)load_mesh_or_builtin("terrain:4,5000,5"); });
  expect_error(ErrorCode::kFile, "terrian: cannot be opened: No such file",
               [] { (void)load_mesh_or_builtin("terrian"); });
}

TEST(MeshTest, ScannedMesh_HasItsSize) {
  const std::string command =
      std::string("\"") + CDE_FETCH_MESH + "\" \"" + CDE_FETCHED + "\" >/dev/null 2>&1";
  const int status = std::system(command.c_str());  // NOLINT(cert-env33-c): a path of this build
  ASSERT_TRUE(WIFEXITED(status));
  if (WEXITSTATUS(status) == 2)
    GTEST_SKIP() << "cannot fetch the scanned mesh (tools/fetch_mesh prints why)";
  ASSERT_EQ(WEXITSTATUS(status), 0);
  const Mesh dragon = load_mesh(std::filesystem::path(CDE_FETCHED) / "dragon-202520.ply");
  EXPECT_EQ(dragon.vertices.size(), 100250u);
  EXPECT_EQ(dragon.faces.size(), 202520u);
  const Eigen::Vector3f size = bounds(dragon).sizes();
  EXPECT_NEAR(size.x(), 0.205f, 0.005f);  // metres
  EXPECT_NEAR(size.y(), 0.145f, 0.005f);
}

}  // namespace
}  // namespace cde
