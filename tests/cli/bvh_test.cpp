// SPDX-License-Identifier: Apache-2.0
// cde cast with a BVH: the same records, messages about the choice, and refusals.
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "../has.hpp"
#include "run_cde.hpp"

namespace cde::testing {
namespace {

class CastBvh : public Cli {
 protected:
  std::string records(std::vector<std::string> words, const std::string& more) {
    words.insert(words.end(), {more, "-o", "-", "-q", "--bits"});
    const Ran ran = cde(words);
    EXPECT_EQ(ran.status, 0) << ran.err;
    return ran.out;
  }
  void refused(std::vector<std::string> words, const std::string& text) {
    words.insert(words.begin(), {"cast", "terrain:10,10,1", "--grid", "8x8"});
    Cli::refused(words, text);
  }
};

TEST_F(CastBvh, Modes_GiveTheBytesOfBruteForce) {
  for (const std::string mode : {"nearest", "farthest", "any", "hits"}) {
    SCOPED_TRACE(mode);
    const std::vector<std::string> words = {
        "cast",   "terrain:40,40,3", "--camera", "200,-300,250,200,200,50",
        "--size", "40x32",           "--mode",   mode};
    const std::string through = records(words, "--bvh");
    EXPECT_EQ(through, records(words, "--no-bvh"));
    EXPECT_GT(through.size(), 10'000u);
  }
}

TEST_F(CastBvh, WorthwhileCasts_UseTheBvh) {
  Ran ran = cde({"cast", "terrain:40,40,3", "--grid", "32x32", "--json", "--check=rays:9"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  auto j = nlohmann::json::parse(ran.out);
  EXPECT_EQ(j["through"], "bvh");
  EXPECT_EQ(j["brute_force_rays"], 9);
  EXPECT_EQ(j["records_matching"], 1024);
  EXPECT_GT(j["nodes"], 1024);
  EXPECT_LT(j["tests"], 1024 * 20);
  EXPECT_TRUE(has(ran.err, "; 9 rays also checked against every triangle"));
  EXPECT_TRUE(has(ran.err, "2 traversal units"));
  // Too few triangles, then too few rays.
  ran = cde({"cast", "terrain:40,40,3", "--grid", "8x8", "--json"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(nlohmann::json::parse(ran.out)["through"], "brute_force");
  ran = cde({"cast", "terrain:20,20,3", "--grid", "64x64", "--json"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  j = nlohmann::json::parse(ran.out);
  EXPECT_EQ(j["through"], "brute_force");
  EXPECT_EQ(j["nodes"], 0);
  ran = cde(
      {"cast", "terrain:40,40,3", "--grid", "16x16", "--json", "--no-check", "--mode", "occluded"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(nlohmann::json::parse(ran.out)["through"], "bvh");
}

/// Another algorithm also uses the BVH. Every record equals the reference traversal, and some rays
/// are also checked against every triangle.
TEST_F(CastBvh, Watertight_EqualsReferenceAndBruteForce) {
  for (const std::string mode : {"nearest", "hits", "occluded"}) {
    SCOPED_TRACE(mode);
    const Ran ran = cde({"cast", "terrain:40,40,3", "--grid", "32x32", "--algorithm", "watertight",
                         "--mode", mode, "--json", "--check=rays:40"});
    ASSERT_EQ(ran.status, 0) << ran.err;
    const auto j = nlohmann::json::parse(ran.out);
    EXPECT_EQ(j["through"], "bvh");
    EXPECT_EQ(j["algorithm"], "watertight");
    EXPECT_EQ(j["brute_force_rays"], 40);
    EXPECT_EQ(j["records_matching"], j["records_compared"]);
    EXPECT_EQ(j["records_compared"], j["records"]);
    EXPECT_GE(j["hits"], 1024);  // at least one hit per ray
    EXPECT_LT(j["tests"], 1024 * 20);
  }
}

TEST_F(CastBvh, ImpossibleRequests_NameTheReason) {
  refused({"--bvh", "--mode", "all"}, "mode all reports every triangle");
  refused({"--bvh", "--no-box"}, "the box rule");
  refused({"--bvh", "--algorithm", "watertight", "--no-box"}, "the box rule");
  refused({"--bvh", "--format", "bf16"}, "bf16 would widen them by percents");
  refused({"--bvh", "--partition", "2"}, "parts of a mesh use brute force");
  refused({"--no-bvh", "--mode", "occluded"}, "--mode occluded cannot be combined with --no-bvh");
  for (const std::string checks : {"rays", "rays:", "rays:x", "rays:-1", "some"})
    refused({"--check=" + checks}, "--check is '" + checks + "'");
}

/// A triangle without a bounding box forces brute force, with a message. With --bvh it is an error.
TEST_F(CastBvh, TriangleWithoutBox_UsesBruteForce) {
  std::string text = "v 0 0 1\nv 1e20 0 1\nv 0 1 1\n";
  for (int i = 0; i < 3000; ++i) text += "f 1 2 3\n";
  write("far.obj", text);
  const std::vector<std::string> words = {"cast", "far.obj", "--grid", "32x32", "--json"};
  Ran ran = cde(words);
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(has(ran.err, "every ray is tested with every triangle"));
  EXPECT_EQ(nlohmann::json::parse(ran.out)["through"], "brute_force");
  ran = cde({"cast", "far.obj", "--ray", "0.1,0.1,0,0,0,1", "--bvh"});
  EXPECT_NE(ran.status, 0);
  EXPECT_TRUE(has(ran.err, "far.obj: cannot build a BVH: "));
  ran = cde({"cast", "far.obj", "--ray", "0.1,0.1,0,0,0,1", "--mode", "occluded"});
  EXPECT_TRUE(has(ran.err, "far.obj: cannot build a BVH: "));
}

TEST_F(CastBvh, MissingBuilder_IsNoErrorOfTheBvh) {
  const Ran ran = cde({"cast", "terrain:3,3,1", "--ray", "0,0,9,0,0,-1"},
                      {"CDE_MODELS=/nowhere", "CDE_SHARE=/nowhere"});
  EXPECT_EQ(ran.status, 2);
  EXPECT_EQ(ran.err,
            "cde: cannot run /nowhere/verilator/model_builder: No such file or directory\n");
}

/// Shadow rays use the same method as the other rays, and the picture is the same.
TEST_F(CastBvh, Shadows_UseTheBvh) {
  for (const std::string method : {"bvh", "no-bvh"}) {
    const Ran ran = cde({"render", "terrain:40,40,3", "--size", "64x48", "--shaded",
                         method + ".png", "--shadows", "--" + method, "--json", "-q"});
    ASSERT_EQ(ran.status, 0) << ran.err;
    const auto j = nlohmann::json::parse(ran.out);
    EXPECT_EQ(j["records_matching"], j["records_compared"]);
    if (method == "bvh") {
      EXPECT_EQ(j["secondaries"], 0);
    }
  }
  EXPECT_EQ(read("bvh.png"), read("no-bvh.png"));
}

TEST_F(CastBvh, OccludedMode_NamesNoTriangle) {
  write("one.obj", "v 0 0 1\nv 1 0 1\nv 0 1 1\nf 1 2 3\n");
  std::vector<std::string> words = {"cast",   "one.obj",  "--ray", "0.2,0.2,0,0,0,1",
                                    "--mode", "occluded", "-o",    "r.jsonl"};
  EXPECT_EQ(cde(words).status, 0);
  EXPECT_TRUE(has(read("r.jsonl"), "\"F\":1"));
  EXPECT_TRUE(has(read("r.jsonl"), "\"index\":null"));
  words.insert(words.end(), {"--fields", "u"});
  EXPECT_EQ(cde(words).status, 2);
}

/// Boxes that all overlap cull nothing: brute force is faster.
TEST_F(CastBvh, OverlappingTriangles_UseBruteForce) {
  std::string text = "v 0 0 1\nv 1 0 1\nv 0 1 1\n";
  for (int i = 0; i < 3000; ++i) text += "f 1 2 3\n";
  write("heap.obj", text);
  const Ran ran = cde({"cast", "heap.obj", "--grid", "32x32", "--json"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(nlohmann::json::parse(ran.out)["through"], "brute_force");
}

// ---- Scenes ----

/// A terrain, and a torus above it that turns and deforms in a band.
std::string flight(const std::string& card) {
  return "frames = 4\n[card]\n" + card + R"(
[[object]]
name = "ground"
mesh = "terrain:40,40,3"
[[object]]
name = "ring"
mesh = ")" +
         CDE_SOURCE_DIR + R"(/meshes/torus.stl"
scale = 30
motion = { kind = "velocity", position = [180, 180, 260], linear = [40, 20, 0], angular = [30, 0, 90] }
[[object]]
name = "ball"
mesh = ")" +
         CDE_SOURCE_DIR + R"(/meshes/icosphere.ply"
scale = 40
deform = { kind = "random", vertices = [3, 90], amplitude = [0, 0, 0.2], seed = 5 }
motion = { kind = "velocity", position = [90, 200, 300], linear = [0, 10, -20] }
[[object]]
name = "rays"
random_rays = { count = 700, seed = 7 }
motion = { kind = "path", points = [[150, 150, 400], [250, 250, 350]], duration = 0.1 }
[[query]]
name = "near"
pair = "ray-triangle"
primaries = "rays"
secondaries = ["ground", "ring", "ball"]
mask = [3, 500]
[[query]]
name = "hits"
pair = "ray-triangle"
primaries = "rays"
secondaries = ["ground", "ring", "ball"]
mode = "hits"
)";
}

class SceneBvh : public Cli {
 protected:
  /// Runs the scene; returns its run.json and the bytes of its records.
  nlohmann::json run(const std::string& name, const std::string& card, std::string& records) {
    write(name + ".toml", flight(card));
    const Ran ran = cde({"run", name + ".toml", "-q"});
    EXPECT_EQ(ran.status, 0) << ran.err;
    const auto j = nlohmann::json::parse(read(name + ".run/run.json"));
    for (const auto& file : j["files"]) records += read(name + ".run/" + file.get<std::string>());
    EXPECT_EQ(j["totals"]["mismatches"], 0);
    return j;
  }
};

/// Transforms on the host and on the card give the bytes of brute force.
TEST_F(SceneBvh, MovingObjects_GiveTheBytesOfBruteForce) {
  std::string brute_force, through, posed;
  const auto off = run("off", "bvh = \"off\"\nlanes = 16\ntransform_site = \"card\"", brute_force);
  const auto on = run("on", "transform_site = \"card\"", through);
  const auto host = run("host", "transform_site = \"host\"", posed);
  EXPECT_GT(brute_force.size(), 100'000u);
  EXPECT_TRUE(brute_force == through);
  EXPECT_TRUE(brute_force == posed);
  EXPECT_EQ(on["plan"]["queries"][0]["through"], "bvh");
  EXPECT_EQ(off["plan"]["queries"][0]["through"], "brute_force");
  EXPECT_LT(on["totals"]["tests"].get<double>(), off["totals"]["tests"].get<double>() / 100);
}

/// A frame with a triangle that has no bounding box uses brute force, and the run reports it.
TEST_F(SceneBvh, FramesWithoutBoxes_UseBruteForce) {
  const auto scene = [](const std::string& card) {
    return "frames = 4\nrate = 1\n[card]\n" + card + R"(
[[object]]
name = "ball"
mesh = ")" +
           CDE_SOURCE_DIR + R"(/meshes/icosphere.ply"
scale = 80
[[object]]
name = "ring"
mesh = ")" +
           CDE_SOURCE_DIR + R"(/meshes/torus.stl"
scale = 1e11
motion = { kind = "velocity", linear = [3.5e11, 0, 0], angular = [0, 0, 90] }
[[object]]
name = "rays"
random_rays = { count = 60, seed = 7 }
[[query]]
name = "hit"
pair = "ray-triangle"
primaries = "rays"
secondaries = ["ball", "ring"]
)";
  };
  write("on.toml", scene("bvh = \"on\"\ntransform_site = \"card\""));
  write("off.toml", scene("bvh = \"off\"\nlanes = 16\ntransform_site = \"card\""));
  const Ran ran = cde({"run", "on.toml"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(has(ran.err,
                  "frame 2, query 'hit': brute force instead of a BVH: "
                  "the triangle in slot"));
  ASSERT_EQ(cde({"run", "off.toml", "-q"}).status, 0);
  const auto on = nlohmann::json::parse(read("on.run/run.json"))["frame_results"];
  const auto off = nlohmann::json::parse(read("off.run/run.json"))["frame_results"];
  for (const unsigned f : {0u, 1u, 2u, 3u}) {
    EXPECT_EQ(on[f]["queries"][0]["brute_force_reason"].is_null(), f < 2) << f;
    EXPECT_TRUE(off[f]["queries"][0]["brute_force_reason"].is_null());
  }
  EXPECT_EQ(read("on.run/hit.csv"), read("off.run/hit.csv"));
}

/// Node counts of a frame are the same in a run that begins with it.
TEST_F(SceneBvh, Frames_DoNotDependOnEarlierFrames) {
  write("s.toml", flight("transform_site = \"card\""));
  ASSERT_EQ(cde({"run", "s.toml", "-q", "--out", "all"}).status, 0);
  ASSERT_EQ(cde({"run", "s.toml", "-q", "--out", "one", "--frames", "2"}).status, 0);
  const auto all = nlohmann::json::parse(read("all/run.json"))["frame_results"][2]["queries"];
  const auto one = nlohmann::json::parse(read("one/run.json"))["frame_results"][0]["queries"];
  for (const unsigned q : {0u, 1u}) {
    for (const char* count : {"nodes", "leaves", "tests", "deepest", "device_cycles"})
      EXPECT_EQ(all[q]["counters"][count], one[q]["counters"][count]) << count;
    EXPECT_GT(all[q]["counters"]["nodes"], 700);
  }
}

/// The host refits the BVH of a terrain that moves. Records equal brute force.
TEST_F(SceneBvh, NodesInDdr_AreRefittedByTheHost) {
  const std::string scene = R"(frames = 3
[[object]]
name = "ground"
mesh = "terrain:140,140,1"
deform = { kind = "wave", vertices = [20, 9000], amplitude = [0, 0, 5], period = 1, wavelength = 40 }
[object.motion]
kind = "path"
points = [[0, 0, 0], [6, 5, 9]]
duration = 0.05
[[object]]
name = "rays"
random_rays = { count = 300, seed = 7, half_angle = 80 }
[object.motion]
kind = "path"
points = [[400, 400, 300], [700, 600, 280]]
duration = 0.05
[[query]]
name = "hit"
pair = "ray-triangle"
primaries = "rays"
secondaries = "ground"
[card]
device = "ecp5-85"
)";
  write("ddr.toml", scene);
  write("chip.toml", scene + "bvh = \"off\"\n");
  for (const char* name : {"ddr", "chip"}) {
    const Ran ran = cde({"run", std::string(name) + ".toml", "-q"});
    ASSERT_EQ(ran.status, 0) << ran.err;
  }
  EXPECT_EQ(read("ddr.run/hit.csv"), read("chip.run/hit.csv"));
  const auto j = nlohmann::json::parse(read("ddr.run/run.json"));
  EXPECT_EQ(j["totals"]["mismatches"], 0);
  for (const auto& frame : j["frame_results"]) {
    const auto& counters = frame["queries"][0]["counters"];
    EXPECT_GT(counters["fetched_nodes"], 20);
    EXPECT_GE(counters["cached_nodes"], counters["fetched_nodes"]);
    EXPECT_GT(counters["nodes"], counters["cached_nodes"]);
  }
}

TEST_F(SceneBvh, Plan_ShowsCyclesOfBoth) {
  write("s.toml", flight(""));
  const Ran text = cde({"plan", "s.toml"});
  ASSERT_EQ(text.status, 0) << text.err;
  std::istringstream words(text.out);  // at any line breaks
  std::string all, word;
  while (words >> word) all += word + " ";
  EXPECT_TRUE(has(all, "through a BVH in about")) << text.out;
  EXPECT_TRUE(has(all, "brute force on 16 lanes takes")) << text.out;
  write("bad.toml", flight("bvh = \"yes\""));
  const Ran bad = cde({"plan", "bad.toml"});
  EXPECT_EQ(bad.status, 2);
  EXPECT_TRUE(has(bad.err, "bad.toml:3:"));
  EXPECT_TRUE(has(bad.err, "bvh"));
}

/// Spheres that fall onto a terrain: the same bytes as brute force, including normals.
TEST_F(SceneBvh, SpherePrimaries_GiveTheBytesOfBruteForce) {
  const auto scene = [](const std::string& card) {
    return "frames = 3\n[card]\n" + card + R"(
[[object]]
name = "ground"
mesh = "terrain:40,40,3"
[[object]]
name = "balls"
random = { shape = "sphere", count = 300, min = [0, 0, 20], max = [400, 400, 260], size = [2, 20], seed = 9 }
motion = { kind = "velocity", linear = [0, 0, -400] }
[[query]]
name = "near"
pair = "triangle-sphere"
primaries = "balls"
secondaries = "ground"
normals = true
mask = [4]
[[query]]
name = "hits"
pair = "triangle-sphere"
primaries = "balls"
secondaries = "ground"
normals = true
mode = "hits"
)";
  };
  std::map<std::string, std::string> records;
  for (const std::string name : {"on", "off"}) {
    const std::string card = "bvh = \"" + name + '"' + (name == "on" ? "" : "\nlanes = 16");
    write(name + ".toml", scene(card));
    const Ran ran = cde({"run", name + ".toml", "-q"});
    ASSERT_EQ(ran.status, 0) << ran.err;
    const auto j = nlohmann::json::parse(read(name + ".run/run.json"));
    EXPECT_EQ(j["totals"]["mismatches"], 0);
    for (const auto& file : j["files"])
      records[name] += read(name + ".run/" + file.get<std::string>());
    for (const auto& frame : j["frame_results"]) {
      for (const auto& query : frame["queries"]) {
        EXPECT_EQ(query["counters"]["nodes"] > 0, name == "on");
        EXPECT_EQ(query["brute_force_reason"], nullptr);
        EXPECT_GT(query["records_compared"], 0);
      }
    }
  }
  EXPECT_EQ(records["on"], records["off"]);
  EXPECT_GT(records["on"].size(), 10'000u);
}

/// Rays and spheres against spheres that move separately: the BVH is rebuilt for each frame.
/// Records are compared with brute force.
TEST_F(SceneBvh, MovingSpheres_RebuildTheBvh) {
  write("cloud.toml", R"(
frames = 3
[[object]]
name = "cloud"
random = { shape = "sphere", count = 3000, seed = 3, min = [-10, -10, -10], max = [10, 10, 10], size = [0.1, 0.3] }
motion = { kind = "random", each = true, seed = 3, min = [-10, -10, -10], max = [10, 10, 10], speed = 4 }
[[object]]
name = "probes"
random = { shape = "sphere", count = 300, seed = 5, min = [-10, -10, -10], max = [10, 10, 10], size = [0.1, 0.6] }
[[object]]
name = "rays"
random_rays = { count = 500, seed = 6 }
[[query]]
name = "near"
pair = "sphere-sphere"
primaries = "probes"
secondaries = "cloud"
normals = true
[[query]]
name = "seen"
pair = "ray-sphere"
primaries = "rays"
secondaries = "cloud"
mask = [4]
)");
  const Ran ran = cde({"run", "cloud.toml", "-q", "--check", "all"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const auto j = nlohmann::json::parse(read("cloud.run/run.json"));
  EXPECT_EQ(j["totals"]["mismatches"], 0);
  for (const auto& query : j["plan"]["queries"]) EXPECT_EQ(query["through"], "bvh");
  for (const auto& frame : j["frame_results"])
    for (const auto& query : frame["queries"]) {
      EXPECT_GT(query["counters"]["nodes"], 0);
      EXPECT_LT(query["counters"]["tests"], 5000);
      EXPECT_GT(query["records_compared"], 290);
    }
}

}  // namespace
}  // namespace cde::testing
