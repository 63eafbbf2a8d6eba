// SPDX-License-Identifier: Apache-2.0
// Small mesh files that hang an importer or take gigabytes.
#include <fmt/format.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>

#include "cde/mesh/mesh.hpp"
#include "testing.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;

constexpr MeshLimits kShort{.time = std::chrono::seconds(2)};

/// A glTF of one triangle, whose data lie in `buffer`. Each of `depth` nodes has the next one
/// twice.
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

class MeshAttack : public ::testing::Test {
 protected:
  MeshAttack() {
    const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    folder_.write("b.bin", std::string(reinterpret_cast<const char*>(corners), sizeof corners));
  }
  const Folder folder_;
};

TEST_F(MeshAttack, ABufferThatIsAFifoIsRefused) {
  ASSERT_EQ(load_mesh(folder_.write("good.gltf", gltf("b.bin", 0))).faces.size(), 1u);
  ASSERT_EQ(::mkfifo((folder_ / "fifo").c_str(), 0600), 0);
  const fs::path mesh = folder_.write("a.gltf", gltf("fifo", 0));
  expect_error(ErrorCode::kFile, "fifo, which is no regular file",
               [&] { (void)load_mesh(mesh, kShort); });
}

TEST_F(MeshAttack, MemoryFollowsTheSizeOfTheFile) {
  const fs::path doubling = folder_.write("doubling.gltf", gltf("b.bin", 26));
  expect_error(ErrorCode::kFile, "doubling.gltf: takes more than 512 MB to read",
               [&] { (void)load_mesh(doubling); });
  expect_error(ErrorCode::kFile, "doubling.gltf: takes more than 64 MB to read",
               [&] { (void)load_mesh(doubling, {.memory = 64u << 20}); });
  const fs::path off = folder_.write("vertices.off", "OFF\n1000000000 1 0\n0 0 0\n");
  expect_error(ErrorCode::kFile, "vertices.off: ", [&] { (void)load_mesh(off); });
  rusage used{};
  ASSERT_EQ(::getrusage(RUSAGE_CHILDREN, &used), 0);
  EXPECT_LT(used.ru_maxrss, 1 << 20) << "KB";
}

/// One that reads for ever: nodes that double for longer than the limit, within much memory.
TEST_F(MeshAttack, TimeIsLimited) {
  const fs::path mesh = folder_.write("slow.gltf", gltf("b.bin", 40));
  const auto began = std::chrono::steady_clock::now();
  expect_error(ErrorCode::kFile, "slow.gltf: not read within 1 s", [&] {
    (void)load_mesh(mesh, {.time = std::chrono::seconds(1), .memory = std::uint64_t{16} << 30});
  });
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(20));
}

/// Importers of a process that was killed end with it.
TEST_F(MeshAttack, NoImporterOutlivesTheProcess) {
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

TEST(MeshLimits, OfTheEnvironment) {
  ASSERT_EQ(::setenv("CDE_MESH_SECONDS", "5", 1), 0);
  ASSERT_EQ(::setenv("CDE_MESH_MEMORY", "100", 1), 0);
  EXPECT_EQ(MeshLimits::of_environment().time, std::chrono::seconds(5));
  EXPECT_EQ(MeshLimits::of_environment().memory, 100u << 20);
  for (const char* bad : {"0", "-1", "x", "1.5", "99999999999"}) {
    ASSERT_EQ(::setenv("CDE_MESH_MEMORY", bad, 1), 0);
    expect_error(ErrorCode::kUsage, "CDE_MESH_MEMORY is ",
                 [] { (void)MeshLimits::of_environment(); });
  }
  ::unsetenv("CDE_MESH_SECONDS");
  ::unsetenv("CDE_MESH_MEMORY");
}

}  // namespace
}  // namespace cde::testing
