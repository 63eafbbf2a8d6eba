// SPDX-License-Identifier: Apache-2.0
// Triangles of glTF files: of the file's scene alone, and none is left out.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>

#include "cde/mesh/mesh.hpp"
#include "glb.hpp"
#include "testing.hpp"

namespace cde {
namespace {

using testing::chunks_of_glb;
using testing::expect_error;
using testing::Folder;

/// Three positions, and six 16-bit corner numbers. Accessors: positions, `corners` numbers, no use.
std::string glb(const std::string& scene, const std::string& meshes, unsigned corners,
                std::uint16_t last) {
  std::string json = fmt::format(
      R"({{"asset":{{"version":"2.0"}},{},"meshes":[{}],"accessors":[)"
      R"({{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},)"
      R"({{"bufferView":1,"componentType":5123,"count":{},"type":"SCALAR"}}],"bufferViews":[)"
      R"({{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":12}}],)"
      R"("buffers":[{{"byteLength":48}}]}})",
      scene, meshes, corners);
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string data(12, '\0');
  for (const float x : {1.f, 0.f, 0.f, 0.f, 1.f, 0.f})
    data += testing::word(std::bit_cast<std::uint32_t>(x));
  for (const std::uint16_t corner : {0, 1, 2, 0, 2}) data += testing::half(corner);
  return chunks_of_glb(json, data + testing::half(last));
}

/// A mesh that two nodes share.
const std::string kTwoNodes =
    R"("scene":0,"scenes":[{"nodes":[0,1]}],"nodes":[{"mesh":0},{"mesh":0,"translation":[9,0,0]}])";

std::string mesh(const std::string& more) {
  return R"({"primitives":[{"attributes":{"POSITION":0},"indices":1)" + more + "}]}";
}

/// The importer leaves out triangles with such corners, without a message.
TEST(Gltf, CornerNumbersOutOfRange_AreRefused) {
  const Folder folder;
  EXPECT_EQ(load_mesh(folder.write("a.glb", glb(kTwoNodes, mesh(""), 6, 1))).faces.size(), 4u);
  expect_error(ErrorCode::kFile, "a.glb: has 1 of 2 triangles with corner numbers out of range",
               [&] { (void)load_mesh(folder.write("a.glb", glb(kTwoNodes, mesh(""), 6, 3))); });
  expect_error(ErrorCode::kFile, "meshes[0] has triangles of 5 corners in all",
               [&] { (void)load_mesh(folder.write("a.glb", glb(kTwoNodes, mesh(""), 5, 1))); });
}

TEST(Gltf, StripsAndFans_AreRead) {
  const Folder folder;
  for (const char* mode : {R"(,"mode":5)", R"(,"mode":6)"}) {
    EXPECT_EQ(load_mesh(folder.write("a.glb", glb(kTwoNodes, mesh(mode), 5, 1))).faces.size(), 6u);
    expect_error(ErrorCode::kFile, "triangles with corner numbers out of range",
                 [&] { (void)load_mesh(folder.write("a.glb", glb(kTwoNodes, mesh(mode), 6, 7))); });
  }
}

/// Other scenes, and meshes of no scene, are not read, and their corners do not matter.
TEST(Gltf, MeshesOutsideTheScene_AreNotRead) {
  const Folder folder;
  const std::string other = R"({"primitives":[{"attributes":{"POSITION":0}}]})";
  const std::string scenes =
      R"("scenes":[{"nodes":[0]},{"nodes":[1]}],"nodes":[{"mesh":0},{"mesh":1}])";
  for (const std::string& file :
       {glb(kTwoNodes, other + "," + mesh(""), 5, 7), glb(scenes, other + "," + mesh(""), 5, 7),
        glb(R"("scene":1,)" + scenes, mesh("") + "," + other, 5, 7)})
    EXPECT_GT(load_mesh(folder.write("a.glb", file)).faces.size(), 0u);
  expect_error(ErrorCode::kFile, "meshes[1] has triangles of 5 corners", [&] {
    (void)load_mesh(
        folder.write("a.glb", glb(R"("scene":1,)" + scenes, other + "," + mesh(""), 5, 7)));
  });
}

}  // namespace
}  // namespace cde
