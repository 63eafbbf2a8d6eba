// SPDX-License-Identifier: Apache-2.0
#include "cde/support/read_limits.hpp"

#include <sys/stat.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "cde/mesh/mesh.hpp"
#include "cde/scene/plan.hpp"
#include "scenes.hpp"

namespace cde::testing {
namespace {

TEST(ReadLimits, EnvironmentVariables_SetTheLimits) {
  ASSERT_EQ(::setenv("CDE_READ_SECONDS", "5", 1), 0);
  ASSERT_EQ(::setenv("CDE_READ_MEMORY", "100", 1), 0);
  EXPECT_EQ(MeshLimits::from_environment().time, std::chrono::seconds(5));
  EXPECT_EQ(MeshLimits::from_environment().memory, 100u << 20);
  EXPECT_EQ(ReadLimits::time_for("any"), std::chrono::seconds(5));
  EXPECT_EQ(ReadLimits::memory_for("any"), 100u << 20);
  for (const char* bad : {"0", "-1", "x", "1.5", "99999999999"}) {
    ASSERT_EQ(::setenv("CDE_READ_MEMORY", bad, 1), 0);
    expect_error(ErrorCode::kUsage, "CDE_READ_MEMORY is ",
                 [] { (void)MeshLimits::from_environment(); });
  }
  ::unsetenv("CDE_READ_SECONDS");
  ::unsetenv("CDE_READ_MEMORY");
}

TEST(ReadLimits, FollowTheFilesSize) {
  const Folder folder;
  const auto file = folder.write("a", std::string(3 << 20, 'a'));
  EXPECT_EQ(ReadLimits::memory_for(file), (std::uint64_t{2} << 30) + 64u * (3 << 20));
  EXPECT_EQ(ReadLimits::time_for(file), std::chrono::seconds(60));
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_GT(ReadLimits::memory_for(folder / "pipe"), std::uint64_t{1} << 50);
  EXPECT_GT(ReadLimits::time_for(folder / "pipe"), std::chrono::hours(1000));
}

TEST(ReadLimits, MoreMemory_IsAnErrorThatNamesTheFile) {
  ASSERT_EQ(::setenv("CDE_READ_MEMORY", "100", 1), 0);
  const auto take = [](std::size_t megabytes) {
    return within_memory_for("a.toml", [=] { return std::vector<char>(megabytes << 20).size(); });
  };
  EXPECT_EQ(take(50), 50u << 20);
  if (data_bytes() < std::uint64_t{1} << 36)  // not under a sanitizer
    expect_error(ErrorCode::kFile, "a.toml: takes more than 100 MB to read; ",
                 [&] { (void)take(150); });
  ::unsetenv("CDE_READ_MEMORY");
  EXPECT_EQ(std::vector<char>(150u << 20).size(), 150u << 20) << "the limit has ended";
}

/// Rays of a CSV file count like other shapes of a scene: with them, the boxes are too many.
TEST(SceneLimits, RaysOfCsv_Count) {
  const Folder folder;
  folder.write("r.csv", "0,0,0,0,0,1\n0,0,0,0,0,1\n0,0,0,0,0,1\n");
  const std::uint64_t most = (std::uint64_t{2} << 30) / (5 * 4 * words(Shape::kObb));
  const std::string text =
      "[[object]]\nname = \"a\"\nrays_csv = \"r.csv\"\n[[object]]\nname = \"b\"\nrandom = { "
      "shape = \"obb\", min = [0, 0, 0], max = [1, 1, 1], count = " +
      std::to_string(most) + " }\n" + kBall +
      "[[query]]\nname = \"q\"\npair = \"ray-sphere\"\nprimaries = \"a\"\n"
      "secondaries = \"ball\"\n";
  expect_error(ErrorCode::kCapacity,
               "count: ", [&] { (void)parse_scene(text, (folder / "s.toml").string()); });
}

/// Objects in a row that name one file read it once. Files in turn are read again, and all together
/// have a limit of time, 1 s here.
TEST(SceneLimits, MeshOfObjectsInARow_IsReadOnce) {
  const Folder folder;
  folder.write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  std::string text = kRays + kBall + kHit;
  for (unsigned i = 0; i < 3; ++i)
    text += "[[object]]\nname = \"m" + std::to_string(i) +
            "\"\nmesh = \"m.obj\"\nscale = " + std::to_string(i + 1) + "\n";
  const Scene scene = parse_scene(text, (folder / "s.toml").string());
  for (unsigned i = 0; i < 3; ++i)
    EXPECT_EQ(std::get<std::vector<Triangle>>(scene.objects.at(2 + i).shapes).at(0).v1.x(),
              i + 1.f);
  std::string slow = "v 0 0 0\n";
  for (unsigned i = 0; i < 1000; ++i) {
    const double angle = 6.283185307179586 * i / 1000, r = i % 2 == 0 ? 1 : 0.5;
    slow += "v " + std::to_string(r * std::cos(angle)) + " " + std::to_string(r * std::sin(angle)) +
            " 0\n";
  }
  std::string face = "f";
  for (unsigned i = 0; i < 1000; ++i) face += " " + std::to_string(2 + i);
  for (unsigned i = 0; i < 20; ++i) slow += face + "\n";
  folder.write("a.obj", slow);
  folder.write("b.obj", slow);
  const auto parse = [&](const char* odd) {
    std::string many = kRays + kBall + kHit;
    for (unsigned i = 0; i < 400; ++i)
      many += "[[object]]\nname = \"m" + std::to_string(i) + "\"\nmesh = \"" +
              (i % 2 == 0 ? "a" : odd) + ".obj\"\n";
    (void)parse_scene(many, (folder / "s.toml").string());
  };
  ASSERT_EQ(::setenv("CDE_READ_SECONDS", "1", 1), 0);
  EXPECT_NO_THROW(parse("a"));
  expect_error(ErrorCode::kFile, "not read within 1 s", [&] { parse("b"); });
  ::unsetenv("CDE_READ_SECONDS");
}

/// Many objects in one query.
TEST(SceneLimits, ManyObjectsOfAQuery_AreReadInLinearTime) {
  std::string text, names;
  for (unsigned i = 0; i < 40'000; ++i) {
    const std::string name = "o" + std::to_string(i);
    text += "[[object]]\nname = \"" + name + "\"\nsphere = { center = [0, 0, 0], radius = 1 }\n";
    names += "\"" + name + "\", ";
  }
  text += "[[query]]\nname = \"q\"\npair = \"sphere-sphere\"\nprimaries = [" + names +
          "]\nsecondaries = [" + names + "]\n";
  const auto began = std::chrono::steady_clock::now();
  (void)plan(parse_scene(text, "s.toml"));
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(8));
}

/// A closed mesh is checked once, however many queries ask what is inside.
TEST(SceneLimits, ClosedMesh_IsCheckedOnce) {
  const Folder folder;
  constexpr unsigned kRing = 20'000;
  std::string mesh = "v 0 0 1\nv 0 0 -1\n";
  for (unsigned i = 0; i < kRing; ++i) {
    const double angle = 6.283185307179586 * i / kRing;
    mesh += "v " + std::to_string(std::cos(angle)) + " " + std::to_string(std::sin(angle)) + " 0\n";
  }
  for (unsigned i = 0; i < kRing; ++i) {
    const unsigned a = 3 + i, b = 3 + (i + 1) % kRing;
    mesh += "f 1 " + std::to_string(a) + " " + std::to_string(b) + "\nf 2 " + std::to_string(b) +
            " " + std::to_string(a) + "\n";
  }
  folder.write("m.obj", mesh);
  std::string text = kBall + "[[object]]\nname = \"m\"\nmesh = \"m.obj\"\n";
  for (unsigned i = 0; i < 500; ++i)
    text += "[[query]]\nname = \"q" + std::to_string(i) +
            "\"\npair = \"sphere-triangle\"\nprimaries = \"ball\"\nsecondaries = \"m\"\n"
            "inside = true\n";
  const auto began = std::chrono::steady_clock::now();
  EXPECT_EQ(parse_scene(text, (folder / "s.toml").string()).queries.size(), 500u);
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(8));
}

}  // namespace
}  // namespace cde::testing
