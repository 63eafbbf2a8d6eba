// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>
#include <ostream>
#include <random>
#include <sstream>

#include "cde/io/rays_csv.hpp"
#include "cde/mesh/mesh.hpp"
#include "testing.hpp"

// Damaged, hostile and missing files: each gives an error that names the file, or a mesh that keeps
// its contract.
namespace cde {
namespace {

using testing::bytes_of;
using testing::expect_error;
using testing::Folder;
using testing::small_mesh;

constexpr const char* kMeshes[] = {"cube.obj",  "icosphere.ply",   "awkward.ply",
                                   "torus.stl", "tetrahedron.stl", "boxes.glb"};
constexpr MeshLimits kShort{.time = std::chrono::seconds(2)};

/// Loads a file; true for a mesh that keeps its contract, false for an Error that names the file.
bool load_survives(const std::filesystem::path& path) {
  try {
    const Mesh mesh = load_mesh(path, kShort);
    check(mesh, "loaded");
    return true;
  } catch (const Error& e) {
    EXPECT_TRUE(e.code() == ErrorCode::kFile || e.code() == ErrorCode::kBadInput) << e.what();
    EXPECT_TRUE(std::string(e.what()).starts_with(path.string())) << e.what();
    return false;
  }
}

class EveryMesh : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Files, EveryMesh, ::testing::ValuesIn(kMeshes), [](const auto& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
});

TEST_P(EveryMesh, RandomDamage_IsAnErrorOrAValidMesh) {
  const Folder folder;
  const std::string whole = bytes_of(small_mesh(GetParam()));
  const bool is_assimp = std::string(GetParam()).ends_with(".glb");
  const int rounds = is_assimp ? 150 : 600;
  constexpr std::uint32_t kSeed = 20261121;
  std::mt19937 random(kSeed);
  int survived = 0;
  for (int round = 0; round < rounds; ++round) {
    std::string bytes = whole;
    const std::size_t changes = 1 + random() % 8;
    for (std::size_t i = 0; i < changes; ++i) {
      // Half of the damage goes to the first bytes, which hold the counts.
      const std::size_t reach =
          random() % 2 != 0 ? bytes.size() : std::min<std::size_t>(bytes.size(), 300);
      bytes[random() % reach] = static_cast<char>(random());
    }
    if (random() % 4 == 0) bytes.resize(random() % bytes.size());
    if (random() % 8 == 0)
      bytes.insert(random() % (bytes.size() + 1), bytes.substr(0, random() % 64));
    survived += load_survives(folder.write(GetParam(), bytes)) ? 1 : 0;
  }
  std::printf("seed %u: %d of %d damaged files loaded\n", kSeed, survived, rounds);
  EXPECT_LT(survived, rounds);
}

TEST_P(EveryMesh, Truncation_IsAnErrorOrAValidMesh) {
  const Folder folder;
  const std::string whole = bytes_of(small_mesh(GetParam()));
  const bool is_assimp = std::string(GetParam()).ends_with(".glb");
  const std::size_t step = is_assimp ? 23 : std::max<std::size_t>(1, whole.size() / 200);
  const std::size_t complete = std::string(GetParam()) == "tetrahedron.stl"
                                   ? whole.find("endsolid") + 8
                               : std::string(GetParam()) == "awkward.ply" ? whole.size() - 1
                                                                          : whole.size();
  for (std::size_t size = 0; size < whole.size(); size += step) {
    const bool loaded = load_survives(folder.write(GetParam(), whole.substr(0, size)));
    // OBJ has no count and may end after any face. Other formats detect missing data, except the
    // line end of the last row and the name after endsolid.
    if (!std::string(GetParam()).ends_with(".obj") && size < complete) {
      EXPECT_FALSE(loaded) << "cut at " << size << " of " << whole.size();
    }
  }
}

TEST(HostileFiles, MissingFileFolderOrGarbage_IsAnError) {
  const Folder folder;
  std::mt19937 random(7);
  std::string garbage(5000, '\0');
  for (char& c : garbage) c = static_cast<char>(random());
  for (const std::string extension : {".obj", ".ply", ".stl", ".glb", ".gltf", ".off", ".dae"}) {
    expect_error(ErrorCode::kFile, "none" + extension + ": cannot be opened: No such file",
                 [&] { (void)load_mesh(folder / ("none" + extension)); });
    std::filesystem::create_directory(folder / ("d" + extension));
    expect_error(ErrorCode::kFile, "d" + extension + ": is a directory",
                 [&] { (void)load_mesh(folder / ("d" + extension)); });
    expect_error(ErrorCode::kFile, "e" + extension + ": is empty",
                 [&] { (void)load_mesh(folder.write("e" + extension, "")); });
    EXPECT_FALSE(load_survives(folder.write("g" + extension, garbage))) << extension;
  }
  expect_error(ErrorCode::kFile, "no mesh format has the extension '.txt'",
               [&] { (void)load_mesh(folder.write("a.txt", "x")); });
  expect_error(ErrorCode::kFile, "no mesh format has the extension ''",
               [&] { (void)load_mesh(folder.write("a", "x")); });
  expect_error(ErrorCode::kFile, "/dev/zero: is not a regular file",
               [] { (void)read_rays_csv("/dev/zero"); });
}

struct BadText {
  const char* name;
  const char* file;
  const char* bytes;
  ErrorCode code;
  const char* message;

  friend void PrintTo(const BadText& b, std::ostream* out) { *out << b.name; }
};

const std::string kPly =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
    "z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n";

class BadMesh : public ::testing::TestWithParam<BadText> {};
INSTANTIATE_TEST_SUITE_P(
    Files, BadMesh,
    ::testing::Values(
        BadText{"obj_nan", "a.obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n", ErrorCode::kBadInput,
                "a.obj: vertex 1 is (1, nan, 0)"},
        BadText{"obj_inf", "a.obj", "v 0 0 -inf\nf 1 1 1\n", ErrorCode::kBadInput,
                "a.obj: vertex 0 is (0, 0, -inf)"},
        BadText{"obj_overflow", "a.obj", "v 0 0 1e39\n", ErrorCode::kFile,
                "a.obj:1: '1e39' overflows"},
        BadText{"obj_short_vertex", "a.obj", "\nv 0 0\n", ErrorCode::kFile,
                "a.obj:2: a vertex needs three"},
        BadText{"obj_word", "a.obj", "v 0 0 x1\n", ErrorCode::kFile,
                "a.obj:1: 'x1' is not a number"},
        BadText{"obj_high", "a.obj", "v 0 0 0\nf 1 1 2\n", ErrorCode::kFile,
                "a.obj:2: vertex number 2 is out of range: 1"},
        BadText{"obj_zero", "a.obj", "v 0 0 0\nf 1 1 0\n", ErrorCode::kFile,
                "a.obj:2: vertex number 0 is out of range"},
        BadText{"obj_low", "a.obj", "v 0 0 0\nf 1 1 -2\n", ErrorCode::kFile,
                "a.obj:2: vertex number -2 is out of range"},
        BadText{"obj_huge", "a.obj", "v 0 0 0\nf 1 1 99999999999999999999\n", ErrorCode::kFile,
                "is not a vertex number"},
        BadText{"obj_least", "a.obj", "v 0 0 0\nf 1 1 -9223372036854775808\n", ErrorCode::kFile,
                "is out of range"},
        BadText{"obj_no_face", "a.obj", "v 0 0 0\n", ErrorCode::kBadInput, "a.obj: no triangles"},
        BadText{"obj_only_lines", "a.obj", "v 0 0 0\nl 1 1\np 1\n", ErrorCode::kBadInput,
                "no triangles, only 2 points and lines"},
        BadText{"obj_surface", "a.obj", "surf 0 1 0 1 1\n", ErrorCode::kFile, "free-form"},
        BadText{"obj_unknown", "a.obj", "hello\n", ErrorCode::kFile,
                "a.obj:1: unknown statement 'hello'"},
        BadText{"off_header", "a.off", "# none\nOF\n", ErrorCode::kFile, "a.off:2: 'OF' begins"},
        BadText{"off_binary", "a.off", "OFF BINARY\n", ErrorCode::kFile, "binary OFF is not read"},
        BadText{"off_dimensions", "a.off", "4OFF\n1 1 0\n", ErrorCode::kFile, "'4OFF' begins"},
        BadText{"off_count", "a.off", "OFF\n3 x 0\n", ErrorCode::kFile,
                "a.off:2: 'x' is not a number of vertices or faces"},
        BadText{"off_one_count", "a.off", "OFF\n3\n", ErrorCode::kFile, "no number of faces"},
        BadText{"off_short", "a.off", "OFF 3 1 0\n0 0 0\n1 0 0\n", ErrorCode::kFile,
                "a.off:3: the file ends after 2 of 3 vertices"},
        BadText{"off_no_face", "a.off", "OFF 1 2 0\n0 0 0\n3 0 0 0\n", ErrorCode::kFile,
                "the file ends after 1 of 2 faces"},
        BadText{"off_high", "a.off", "OFF 3 1\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", ErrorCode::kFile,
                "a.off:5: vertex number 3 is out of range: there are 3 vertices"},
        BadText{"off_negative", "a.off", "OFF 3 1\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n",
                ErrorCode::kFile, "'-1' is not a vertex number"},
        BadText{"off_corners", "a.off", "OFF 3 1\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n", ErrorCode::kFile,
                "a.off:5: a face has 2 of 3 corners"},
        BadText{"off_none", "a.off", "OFF 3 1\n0 0 0\n1 0 0\n0 1 0\n0\n", ErrorCode::kFile,
                "a.off:5: a face needs corners"},
        BadText{"off_behind", "a.off", "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n",
                ErrorCode::kFile, "a.off:6: '3 0 1 2' behind the last of 1 faces"},
        BadText{"off_word", "a.off", "OFF 1 1 0\n0 0 b\n3 0 0 0\n", ErrorCode::kFile,
                "a.off:2: 'b' is not a number"},
        BadText{"off_infinite", "a.off", "OFF 1 1 0\n0 0 1e40\n3 0 0 0\n", ErrorCode::kFile,
                "a.off:2: '1e40' overflows a float"},
        BadText{"ply_negative", "a.ply", "0 0 0\n1 0 0\n0 1 0\n3 0 1 -2\n", ErrorCode::kFile,
                "vertex number -2 is out of range"},
        BadText{"ply_high", "a.ply", "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", ErrorCode::kFile,
                "a.ply:13: face 0: vertex number 3 is out of range"},
        BadText{"ply_list_negative", "a.ply", "0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n", ErrorCode::kFile,
                "a list of -3 entries"},
        BadText{"ply_short_row", "a.ply", "0 0 0\n1 0\n0 1 0\n3 0 1 2\n", ErrorCode::kFile,
                "a.ply:11: vertex row 1 has too few values"},
        BadText{"ply_nan", "a.ply", "0 0 0\n1 0 0\n0 nan 0\n3 0 1 2\n", ErrorCode::kBadInput,
                "a.ply: vertex 2 is (0, nan, 0)"},
        BadText{"stl_count", "a.stl",
                "0123456789012345678901234567890123456789012345678901234567890123456789012345678"
                "\x7f\x7f\x7f\x7f\x7f",
                ErrorCode::kFile,
                "binary STL of 2139062143 facets takes 106953107234 bytes, the file has 84"},
        BadText{"stl_short", "a.stl", "abc", ErrorCode::kFile, "3 bytes are too few"},
        BadText{"stl_empty_solid", "a.stl", "solid a\nendsolid a\n", ErrorCode::kBadInput,
                "no triangles"},
        BadText{"stl_word", "a.stl", "solid a\n facet normal 0 0 0\nouter loop\nvertex 1 2 b\n",
                ErrorCode::kFile, "a.stl:4: 'b' is not a number"}),
    [](const auto& info) { return std::string(info.param.name); });

TEST_P(BadMesh, BadText_IsAnError) {
  const Folder folder;
  const BadText& bad = GetParam();
  const std::string bytes =
      std::string(bad.file).ends_with(".ply") ? kPly + bad.bytes : std::string(bad.bytes);
  expect_error(bad.code, bad.message, [&] { (void)load_mesh(folder.write(bad.file, bytes)); });
}

TEST(HostileFiles, BadPlyHeaders_AreErrors) {
  const Folder folder;
  const auto load = [&](const std::string& text) { (void)load_mesh(folder.write("h.ply", text)); };
  const std::string vertex = "property float x\nproperty float y\nproperty float z\n";
  const std::string binary = "ply\nformat binary_little_endian 1.0\n";
  expect_error(ErrorCode::kFile, "4294967295 vertex rows are announced, but only 4 bytes follow",
               [&] { load(binary + "element vertex 4294967295\n" + vertex + "end_header\nabcd"); });
  expect_error(ErrorCode::kFile, "18446744073709551615 vertices exceed the 32-bit limit", [&] {
    load(binary + "element vertex 18446744073709551615\n" + vertex + "end_header\n");
  });
  expect_error(ErrorCode::kFile, "h.ply:3: '-1' is not a count",
               [&] { load(binary + "element vertex -1\n" + vertex + "end_header\n"); });
  expect_error(ErrorCode::kFile, "element 'vertex' has no properties",
               [&] { load(binary + "element vertex 999999999\nend_header\n"); });
  expect_error(ErrorCode::kFile, "element 'vertex' appears twice",
               [&] { load(binary + "element vertex 1\nelement vertex 1\n"); });
  expect_error(ErrorCode::kFile, "needs x, y and z",
               [&] { load(binary + "element vertex 1\nproperty float x\nend_header\n"); });
  expect_error(ErrorCode::kFile, "'quad' is not a type",
               [&] { load(binary + "element vertex 1\nproperty quad x\nend_header\n"); });
  expect_error(ErrorCode::kFile, "has no 'end_header'", [&] { load(binary); });
  expect_error(ErrorCode::kFile, "begins with the line 'ply'", [&] { load("plyx\n"); });
  expect_error(ErrorCode::kFile, "unknown format 'pdp'", [&] { load("ply\nformat pdp 1.0\n"); });
  // A list with the largest 32-bit count, and no data.
  expect_error(ErrorCode::kFile, "truncated", [&] {
    load(binary + "element vertex 0\n" + vertex +
         "element face 1\nproperty list uint int x\nproperty list uchar int "
         "vertex_indices\nend_header\n\xff\xff\xff\xff\x03");
  });
}

TEST(HostileFiles, DamagedRays_AreErrorsOrValidRays) {
  constexpr std::uint32_t kSeed = 11;
  std::mt19937 random(kSeed);
  const std::string wholes[] = {
      "ox,oy,oz,dx,dy,dz,tmin,tmax\n0,0,0,0,0,1\n# c\n1e3,-2.5,0x1.8p3,1,0,0,0,inf\r\n 1 , 2 , 3 , "
      "4 , 5 , 6 , -inf , 8 ",
      "\"\";ox;\"oy\";oz;dx;dy;dz\n0;0,5;\"1\";2;0;0;-1\r1;2;3;4;5;6;7\n",
      " ox oy oz dx dy dz\n0 1 2 3 4 5 6\n1 7 8 9 10 11 \"12\"\n\t1\t2\n"};
  int read = 0;
  for (int round = 0; round < 20000; ++round) {
    std::string bytes = wholes[round % 3];
    for (std::size_t i = 0; i < 1 + random() % 4; ++i)
      bytes[random() % bytes.size()] =
          random() % 2 == 0 ? "\",; \t|#\n"[random() % 8] : static_cast<char>(random());
    std::istringstream in(bytes);
    try {
      for (const Ray& ray : read_rays_csv(in, "r")) EXPECT_FALSE(defect(ray).has_value());
      ++read;
    } catch (const Error& e) {
      EXPECT_TRUE(std::string(e.what()).starts_with("r:")) << e.what();
    }
  }
  std::printf("seed %u: %d of 20000 damaged texts read\n", kSeed, read);
  EXPECT_GT(read, 100);
  EXPECT_LT(read, 19900);
}

}  // namespace
}  // namespace cde
