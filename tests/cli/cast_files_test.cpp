// SPDX-License-Identifier: Apache-2.0
// The files of cde cast: pictures and records in all formats, rays from arrays.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "../has.hpp"
#include "run_cde.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

/// Two triangles that share an edge, each in its own object. The corners of the second have the
/// opposite order.
const char* const kTwoObjects =
    "v 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\no left\nf 1 2 3\no right, \"side\"\nf 2 3 4\n";

class CastFiles : public Cli {
 protected:
  Ran cast(Words words) {
    words.insert(words.begin(), "cast");
    return cde(words);
  }
  Ran render(Words words) {
    words.insert(words.begin(), "render");
    return cde(words);
  }
  void refused(Words words, const std::string& text, const char* verb = "cast") {
    words.insert(words.begin(), verb);
    Cli::refused(words, text);
  }
};

struct Npy {
  std::string header, data;
};
Npy npy(const std::string& bytes) {
  EXPECT_EQ(bytes.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
  const std::size_t length =
      static_cast<unsigned char>(bytes.at(8)) | static_cast<unsigned char>(bytes.at(9)) << 8;
  EXPECT_EQ((10 + length) % 64, 0u);
  return {bytes.substr(10, length), bytes.substr(10 + length)};
}
template <class T>
T at(const std::string& data, std::size_t byte) {
  T value{};
  std::memcpy(&value, data.data() + byte, sizeof(T));
  return value;
}

TEST_F(CastFiles, MeshAlone_WritesItsPicture) {
  write("one.obj", kTwoObjects);
  const Ran ran = render({"one.obj"});
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(ran.out, "") << "no picture, because stdout is not a terminal";
  EXPECT_EQ(files(), (Words{"one.obj", "one.render.png"}));
  EXPECT_EQ(read("one.render.png").substr(1, 3), "PNG");
  EXPECT_TRUE(has(ran.err, "one.render.png, 640 x 480"));
  EXPECT_EQ(render({"one.obj", "--size", "8x8", "-q"}).err, "");
}

/// of the same picture as PNG, PFM and NumPy array; hits lie at the height of the triangle.
TEST_F(CastFiles, DepthsNormalsAndIndices_ShowTheMesh) {
  write("one.obj", kTwoObjects);
  const Ran ran = render({"one.obj", "--grid", "4x2", "--image", "d.npy", "--normals", "n.pfm",
                          "--indices", "i.npy", "-q", "--lanes", "16"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const Npy depth = npy(read("d.npy")), index = npy(read("i.npy"));
  EXPECT_TRUE(has(depth.header, "'<f4', 'fortran_order': False, 'shape': (2, 4)"));
  EXPECT_TRUE(has(index.header, "'<u4', 'fortran_order': False, 'shape': (2, 4)"));
  ASSERT_EQ(depth.data.size(), 32u);
  // Pixels are square: a square mesh fills the middle of a picture that is twice as wide as high.
  const std::vector<bool> hit = {false, true, true, false, false, true, true, false};
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(std::isfinite(at<float>(depth.data, 4 * i)), hit[i]) << i;
    EXPECT_EQ(at<std::uint32_t>(index.data, 4 * i) < 2, hit[i]) << i;
  }
  EXPECT_EQ(at<std::uint32_t>(index.data, 4 * 5), 0u) << "bottom left";
  EXPECT_EQ(at<std::uint32_t>(index.data, 4 * 2), 1u) << "top right";
  const std::string pfm = read("n.pfm"), head = "PF\n4 2\n-1.0\n";
  ASSERT_EQ(pfm.substr(0, head.size()), head);
  ASSERT_EQ(pfm.size(), head.size() + 4 * 2 * 12);
  // The bottom row comes first. For any order of corners, a normal points up to the camera.
  for (std::size_t i = 0; i < 8; ++i)
    EXPECT_EQ(at<float>(pfm, head.size() + 12 * i + 8), hit[i] ? 1.0f : 0.0f) << i;
  for (const char* option : {"--image", "--normals", "--indices"}) {
    ASSERT_EQ(render({"one.obj", "--grid", "4x2", option, "p.png", "-q", "--lanes", "16"}).status,
              0);
    EXPECT_EQ(read("p.png").substr(1, 3), "PNG");
  }
}

/// The output of `cde render` is its picture, or records with another suffix.
TEST_F(CastFiles, RenderOutput_IsThePictureOrRecords) {
  write("one.obj", kTwoObjects);
  ASSERT_EQ(render({"one.obj", "--grid", "4x2", "-o", "a.png", "-q"}).status, 0);
  ASSERT_EQ(render({"one.obj", "--grid", "4x2", "--shaded", "b.png", "-q"}).status, 0);
  EXPECT_EQ(read("a.png"), read("b.png"));
  ASSERT_EQ(render({"one.obj", "--grid", "4x2", "-o", "r.csv", "-q"}).status, 0);
  EXPECT_TRUE(read("r.csv").starts_with("ray,F,T,"));
  refused({"one.obj", "-o", "a.png", "--shaded", "b.png"},
          "--output and --shaded both name the picture", "render");
}

TEST_F(CastFiles, UnknownSuffixes_AreRefused) {
  write("one.obj", kTwoObjects);
  const Words grid = {"one.obj", "--grid", "4x2"};
  const auto with = [&](const std::string& option, const std::string& value) {
    Words words = grid;
    words.insert(words.end(), {option, value});
    return words;
  };
  EXPECT_EQ(cast({"one.obj", "--grid", "4x2", "-o", "x.CSV", "-q"}).status, 0);
  EXPECT_TRUE(read("x.CSV").starts_with("ray,F,T,")) << "suffixes ignore case";
  std::filesystem::remove(folder_ / "x.CSV");
  refused(with("--image", "x.jpg"), "--image is 'x.jpg'; its name must end in .png, .pfm or .npy",
          "render");
  refused(with("--shaded", "x.npy"), "--shaded is 'x.npy'; its name must end in .png", "render");
  refused(with("--indices", "x.pfm"), "must end in .png or .npy", "render");
  refused(with("-o", "x.txt"), "must end in .csv, .npy or .jsonl");
  refused(with("--fields", "u"), "--fields needs --output");
  refused(with("--up", "w"), "--up is 'w'; it must be auto, x, y or z");
  refused({"one.obj", "--grid", "4x2", "-o", "x.csv", "--fields", "u,w"}, "no field 'w'");
  refused({"one.obj", "--grid", "4x2", "-o", "x.npy", "--bits"},
          "--bits cannot be combined with --output x.npy");
  refused({"one.obj", "--image", "x.png", "--shadows"}, "--shadows needs --shaded", "render");
  refused({"one.obj", "--shaded", "x.png"}, "no option '--shaded'");
  refused({"one.obj"}, "rays are missing");
}

/// Names in a mesh file must not control the terminal.
TEST_F(CastFiles, ControlCharactersInNames_ArePrintedEscaped) {
  write("evil.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\no \033[31mred\007\nf 1 2 3\n");
  const Ran ran =
      cast({"evil.obj", "--ray", "0.2,0.2,5,0,0,-1", "--fields", "node", "-q", "-o", "-"});
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(has(ran.out, ",\\x1b[31mred\\x07\n")) << ran.out;
}

/// Fields that the host adds to a record, in all three formats.
TEST_F(CastFiles, Fields_AreEqualInAllFormats) {
  write("one.obj", kTwoObjects);
  const Words words = {"one.obj",           "--ray",
                       "0.25,0.5,0,0,0,1",  "--ray",
                       "0.5,0.75,2,0,0,-1", "--ray",
                       "9,9,0,0,0,1",       "-q",
                       "--fields",          "u,v,normal,side,node"};
  const auto to = [&](const std::string& file) {
    Words all = words;
    all.insert(all.end(), {"-o", file});
    const Ran ran = cast(all);
    EXPECT_EQ(ran.status, 0) << ran.err;
    return file == "-" ? ran.out : read(file);
  };
  EXPECT_EQ(to("-"),
            "ray,F,T,CPx,CPy,CPz,index,u,v,nx,ny,nz,side,node\n"
            "0,1,1,0.25,0.5,1,0,0.25,0.5,0,0,1,-1,left\n"
            "1,1,1,0.5,0.75,1,1,0.5,0.25,0,0,-1,-1,\"right, \"\"side\"\"\"\n"
            "2,0,inf,0,0,0,4294967295,nan,nan,nan,nan,nan,0,\n");
  std::istringstream lines(to("r.jsonl"));
  std::vector<nlohmann::json> json;
  for (std::string line; std::getline(lines, line);) json.push_back(nlohmann::json::parse(line));
  ASSERT_EQ(json.size(), 3u);
  EXPECT_EQ(json[0]["u"], 0.25);
  EXPECT_EQ(json[1]["normal"], nlohmann::json::parse("[0,0,-1]"));
  EXPECT_EQ(json[1]["node"], "right, \"side\"");
  EXPECT_TRUE(json[2]["T"].is_null());
  EXPECT_TRUE(json[2]["index"].is_null());
  const Npy array = npy(to("r.npy"));
  EXPECT_TRUE(has(array.header, "('side', '|i1'), ('node', '|S13')"));
  EXPECT_TRUE(has(array.header, "'shape': (3,)"));
  constexpr std::size_t kRow = 4 + 1 + 4 + 12 + 4 + 4 + 4 + 12 + 1 + 13;
  ASSERT_EQ(array.data.size(), 3 * kRow);
  EXPECT_EQ(at<float>(array.data, kRow + 5), 1.0f) << "T of ray 1";
  EXPECT_EQ(at<std::uint32_t>(array.data, kRow + 21), 1u) << "index of ray 1";
  EXPECT_EQ(at<float>(array.data, kRow + 25), 0.5f) << "u of ray 1";
}

/// Scene files without a mesh: formats whose reader finds none, and a file with a skeleton only.
TEST_F(CastFiles, FileWithoutMeshes_IsRefused) {
  write("none.gltf",
        R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"name":"n"}]})");
  write("none.dae",
        "<?xml version=\"1.0\"?><COLLADA "
        "xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\"><asset/>"
        "<library_visual_scenes><visual_scene id=\"s\"><node id=\"n\"/></visual_scene>"
        "</library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>");
  for (const char* name : {"none.gltf", "none.dae"})
    refused({name, "--grid", "4x4"}, fmt::format("cde: {}: has no meshes\n", name));
}

/// Nodes of a file that assimp reads.
TEST_F(CastFiles, AssimpNodes_AreNamed) {
  const Ran ran = cast({std::string(CDE_SOURCE_DIR) + "/meshes/boxes.glb", "--grid", "6x4", "--up",
                        "z", "-o", "-", "--fields", "node", "-q", "--lanes", "16"});
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(has(ran.out, ",14,far\n"));
  EXPECT_TRUE(has(ran.out, ",3,near\n"));
}

/// Each record tells whether its ray starts within a closed mesh. A mesh with a hole has no inside.
TEST_F(CastFiles, ClosedMesh_ReportsRaysInside) {
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
  write("closed.obj", corners + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  write("open.obj", corners + "f 1 3 2\nf 1 2 4\nf 1 4 3\n");
  const Words rays = {"--inside", "--ray", ".1,.1,.1,0,0,1", "--ray", "2,2,2,0,0,1", "-o",
                      "-",        "-q"};
  Words words = {"closed.obj"};
  words.insert(words.end(), rays.begin(), rays.end());
  const Ran ran = cast(words);
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(has(ran.out, ",index,inside\n0,1,")) << ran.out;
  EXPECT_TRUE(has(ran.out, ",3,1\n1,0,inf,0,0,0,4294967295,0\n")) << ran.out;
  words[0] = "open.obj";
  refused(words, "cde: open.obj: is not closed: an edge of triangle");
}

/// The number of hits is unknown before the cast ends.
TEST_F(CastFiles, ArrayOfHits_HasItsLength) {
  write("one.obj", kTwoObjects);
  ASSERT_EQ(cast({"one.obj", "--grid", "4x2", "--mode", "hits", "-o", "h.npy", "-q"}).status, 0);
  const Npy array = npy(read("h.npy"));
  const std::size_t records = array.data.size() / 25;
  EXPECT_GE(records, 4u);
  EXPECT_TRUE(has(array.header, fmt::format("'shape': ({},)", records)));
}

std::string array_of(const std::string& type, const std::string& shape, const std::string& data,
                     const std::string& fortran = "False") {
  const std::string descr = type.starts_with('[') ? type : "'" + type + "'";
  std::string header =
      fmt::format("{{'descr': {}, 'fortran_order': {}, 'shape': {}, }}", descr, fortran, shape);
  header.append(127 - 10 - header.size(), ' ').push_back('\n');
  std::string all("\x93NUMPY\x01\x00", 8);
  all += static_cast<char>(header.size());
  all += '\0';
  return all + header + data;
}

template <class T>
std::string bytes(const std::vector<T>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(T)};
}

TEST_F(CastFiles, RayArrays_KeepTheirAxes) {
  write("one.obj", kTwoObjects);
  write("r4.npy",
        array_of("<f4", "(2, 6)", bytes<float>({.25f, .5f, 0, 0, 0, 1, .5f, .75f, 2, 0, 0, -1})));
  write("r8.npy", array_of("<f8", "(2, 7)",
                           bytes<double>({.25, .5, 0, 0, 0, 1, 0, .5, .75, 2, 0, 0, -1, 1.5})));
  const std::string head = "ray,F,T,CPx,CPy,CPz,index\n0,1,1,0.25,0.5,1,0\n";
  EXPECT_EQ(cast({"one.obj", "--rays", "r4.npy", "-o", "-", "-q"}).out,
            head + "1,1,1,0.5,0.75,1,1\n");
  EXPECT_EQ(cast({"one.obj", "--rays", "r8.npy", "-o", "-", "-q"}).out,
            head + "1,0,inf,0,0,0,4294967295\n")
      << "tmin lies beyond the triangle";
  // Records for an array keep the axes of its rays.
  write("r3.npy", array_of("<f4", "(2, 1, 6)",
                           bytes<float>({.25f, .5f, .5f, .75f, 0, 2, 0, 0, 0, 0, 1, -1}), "True"));
  ASSERT_EQ(cast({"one.obj", "--rays", "r3.npy", "-o", "r.npy", "-q"}).status, 0);
  EXPECT_TRUE(has(npy(read("r.npy")).header, "'shape': (2, 1), "));
  EXPECT_EQ(cast({"one.obj", "--rays", "r3.npy", "-o", "-", "-q"}).out,
            head + "1,1,1,0.5,0.75,1,1\n");
  ASSERT_EQ(
      cast({"one.obj", "--rays", "r3.npy", "--ray", "0,0,0,0,0,1", "-o", "r.npy", "-q"}).status, 0);
  EXPECT_TRUE(has(npy(read("r.npy")).header, "'shape': (3,), "));
  ASSERT_EQ(cast({"one.obj", "--rays", "r3.npy", "--mode", "hits", "-o", "r.npy", "-q"}).status, 0);
  EXPECT_TRUE(has(npy(read("r.npy")).header, "'shape': (2,), "));
  const auto bad = [&](const std::string& file, const std::string& text) {
    write("bad.npy", file);
    refused({"one.obj", "--rays", "bad.npy"}, text);
  };
  bad("0,0,0,0,0,1\n", "bad.npy: is not a NumPy array");
  bad(array_of("<c8", "(1, 6)", std::string(48, '\0')), "its numbers are '<c8'");
  bad(array_of("[('x', '<f4'), ('y', '<f8')]", "(1,)", std::string(12, '\0')),
      "its field 'x' of 1 number is not expected; rays are (..., 6)");
  bad(array_of("<f4", "(1, 5)", std::string(20, '\0')), "its shape is (1, 5)");
  bad(array_of("<f4", "(2, 6)", std::string(24, '\0')), "24 bytes behind its header");
  bad(array_of("<f4", "(9999999999999999999, 6)", std::string(24, '\0')),
      "claims an impossible size");
  bad(array_of("<f4", "(1, 6)", std::string(24, '\0')), "ray 0: ");
  bad(array_of("<f8", "(1, 6)", bytes<double>({1e300, 0, 0, 0, 0, 1})), "ray 0: 1e+300 overflows");
  bad(array_of("<f4", "(1, 6)", "").substr(0, 40), "is truncated in its header");
}

/// A mesh with y up gives the same picture as the mesh with z up.
TEST_F(CastFiles, UpAxis_GivesTheSamePicture) {
  write("z.obj", "v 0 0 0\nv 2 0 0\nv 0 1 0\nv 0 0 3\nf 1 2 4\nf 2 3 4\nf 1 3 2\n");
  write("y.obj", "v 0 0 0\nv 2 0 0\nv 0 0 -1\nv 0 3 0\nf 1 2 4\nf 2 3 4\nf 1 3 2\n");
  write("x.obj", "v 0 0 0\nv 0 0 -2\nv 0 1 0\nv 3 0 0\nf 1 2 4\nf 2 3 4\nf 1 3 2\n");
  std::string first;
  for (const std::string up : {"z", "y", "x"}) {
    for (const Words& view : {Words{"--size", "32x24"}, Words{"--grid", "24x32"}}) {
      Words words = {up + ".obj", "--up", up, "--shaded", "s.png", "--indices", "i.npy", "-q"};
      words.insert(words.end(), view.begin(), view.end());
      ASSERT_EQ(render(words).status, 0);
      const std::string key = view.front();
      if (up == "z") {
        std::filesystem::rename(folder_ / "i.npy", folder_ / ("z" + key + ".npy"));
        std::filesystem::rename(folder_ / "s.png", folder_ / ("z" + key + ".png"));
      } else {
        EXPECT_EQ(read("i.npy"), read("z" + key + ".npy")) << up;
        EXPECT_EQ(read("s.png"), read("z" + key + ".png")) << up;
      }
    }
  }
}

/// Shadows are a second pass: more records, checked like the first pass, and another picture.
TEST_F(CastFiles, Shadows_AreACheckedSecondPass) {
  const auto shaded = [&](bool shadows) {
    Words words = {"terrain:24,24,1", "--size", "48x32", "--shaded", "s.png", "--json", "-q"};
    if (shadows) words.emplace_back("--shadows");
    const Ran ran = render(words);
    EXPECT_EQ(ran.status, 0) << ran.err;
    return nlohmann::json::parse(ran.out);
  };
  const auto plain = shaded(false);
  const std::string before = read("s.png");
  const auto dark = shaded(true);
  EXPECT_NE(read("s.png"), before);
  EXPECT_EQ(plain["records"], 48 * 32);
  EXPECT_EQ(dark["records"], 48 * 32 + plain["hits"].get<int>());
  EXPECT_EQ(dark["records_matching"], dark["records"]);
  EXPECT_EQ(dark["hits"], plain["hits"]) << "hits count pixels only";
}

/// A picture beyond the address space is refused by its size before the cast. No allocation fails
/// first.
TEST_F(CastFiles, TooLargePicture_IsRefusedWithItsSize) {
  const auto limited = [&](const std::string& words) {
    return shell("ulimit -v 4000000 && \"$CDE\" render terrain:3,3,1 -q " + words);
  };
#ifdef CDE_SANITIZED
  GTEST_SKIP() << "a sanitizer's shadow does not fit in 4 GB of address space";
#endif
  ASSERT_EQ(limited("--size 8x8 --shaded sun.png").status, 0);
  fs::remove(folder_ / "sun.png");
  for (const std::string picture : {"--size 16384x16384 --shaded sun.png",
                                    "--grid 16384x16384 --image depth.pfm --indices i.npy"}) {
    const Ran ran = limited(picture);
    EXPECT_EQ(ran.status, 2) << ran.err;
    EXPECT_EQ(ran.err.find("cde: a picture of 16384 x 16384 pixels takes "), 0u) << ran.err;
    EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
    EXPECT_EQ(files(), Words{});
  }
}

/// Another algorithm uses another card and another reference, and finds the same hits.
TEST_F(CastFiles, Algorithms_FindTheSameHits) {
  const auto hits = [&](const std::string& algorithm, const std::string& mode) {
    const Ran ran = cast({"terrain:6,6,1", "--grid", "20x15", "--algorithm", algorithm, "--mode",
                          mode, "--lanes", "16", "--json", "-q"});
    EXPECT_EQ(ran.status, 0) << ran.err;
    const auto json = nlohmann::json::parse(ran.out);
    EXPECT_EQ(json["algorithm"], algorithm);
    EXPECT_EQ(json["records_matching"], json["records"]);
    EXPECT_EQ(json["records_compared"], json["records"]);
    return json["hits"].get<unsigned>();
  };
  for (const char* mode : {"nearest", "any", "hits"}) {
    const unsigned moller = hits("moller", mode);
    EXPECT_GT(moller, 100u);
    EXPECT_EQ(hits("pluecker", mode), moller) << mode;
  }
}

}  // namespace
}  // namespace cde::testing
