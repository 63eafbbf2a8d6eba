// SPDX-License-Identifier: Apache-2.0
// cde cast, cde plan and cde run on cards with other number formats than fp32.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "../has.hpp"
#include "cde/model/device.hpp"
#include "run_cde.hpp"

namespace cde::testing {
namespace {

using Words = std::vector<std::string>;

/// Rays from inside a moving sphere.
std::string scene(const std::string& card, const std::string& ball) {
  return "frames = 3\n[card]\nlanes = 4\ntransform_site = \"host\"\n" + card +
         "\n[[object]]\nname = \"ball\"\n" + ball + R"(
[object.motion]
kind = "velocity"
linear = [1.7, 0, 0.3]
angular = [0, 1, 0]
[[object]]
name = "rays"
random_rays = { count = 70, seed = 7 }
)" + hit_query("ball");
}
const std::string kBall =
    "mesh = \"" + std::string(CDE_SOURCE_DIR) + "/meshes/icosphere.ply\"\nscale = 3\n";

class FormatCli : public Cli {};

TEST_F(FormatCli, Cast_UsesTheFormat) {
  write("one.obj", kOneTriangle);
  const Words cast = {"cast",  "one.obj",           "--format",
                      "fp16",  "--lanes",           "4",
                      "--ray", "0.25,0.25,0,0,0,2", "--ray=0.3,0.3,0,0,0,3"};
  Words csv = cast;
  csv.insert(csv.end(), {"-o", "-"});
  const Ran ran = cde(csv);
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(ran.out,
            "ray,F,T,CPx,CPy,CPz,index\n0,1,0.5,0.25,0.25,1,0\n"
            "1,1,0.33325195,0.30004883,0.30004883,1,0\n");
  EXPECT_TRUE(has(ran.err, "4 lanes, host arithmetic, fp16, watertight, box rule"));
  EXPECT_TRUE(has(ran.err, "2 of 2 records match the reference"));
  Words json = cast;
  json.insert(json.end(), {"--json", "--mode", "all", "-q"});
  const Ran summary = cde(json);
  ASSERT_EQ(summary.status, 0) << summary.err;
  const auto j = nlohmann::json::parse(summary.out);
  EXPECT_EQ(j["format"], "fp16");
  EXPECT_EQ(j["records_matching"], 2);
  EXPECT_EQ(j["hits"], 2);
}

TEST_F(FormatCli, Cast_RefusesUnsupportedFormats) {
  write("one.obj", kOneTriangle);
  write("far.obj", "v 0 0 1\nv 200 0 1\nv 0 1 1\nf 1 2 3\n");
  const auto cast = [](const std::string& mesh, const std::string& format, const std::string& ray) {
    return Words{"cast", mesh, "--format", format, "--lanes", "4", "--ray", ray, "-o", "-"};
  };
  refused(cast("far.obj", "fp16", "0,0,0,0,0,1"),
          "far.obj: 1 of 1 triangle is bad input, the first triangle 0: v1.x is 200, must be at "
          "most 2^7 in size in fp16");
  refused(cast("one.obj", "fp16", "0,0,300,0,0,1"), "ray 0: origin.z is 300, must be at most 2^7");
  refused(cast("one.obj", "fp16", "0,0,0,0,0,1,0,70000"),
          "ray 0: tmax is 70000, above the largest number, 65504 in fp16");
  refused(cast("one.obj", "fp64", "0,0,0,0,0,1"), "fp16, bf16, tf32, fp24 or fp32");
}

TEST_F(FormatCli, Scene_IsRunAndPlannedInTheFormat) {
  write("ball.toml", scene("format = \"fp16\"", kBall));
  const Ran ran = cde({"run", "ball.toml", "--json"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(has(ran.err, "210 of 210 records compared with the reference, 0 differ"));
  const auto j = nlohmann::json::parse(ran.out);
  EXPECT_EQ(j["format"], "fp16");
  for (const auto& frame : j["frame_results"]) EXPECT_EQ(frame["queries"][0]["hits"], 70);
  const Ran plan = cde({"plan", "ball.toml"});
  ASSERT_EQ(plan.status, 0) << plan.err;
  EXPECT_TRUE(has(plan.out, "EXP=5 MAN=10"));
  EXPECT_TRUE(has(plan.out, "number format"));
}

TEST_F(FormatCli, SceneWithACertifiedFilter_HasTheSameRecords) {
  const auto spheres = [](const char* card) {
    return std::string("frames = 2\n[card]\nlanes = 8\n") + card +
           "\n[[object]]\nname = \"balls\"\nrandom = { shape = \"sphere\", count = 60, min = [-4, "
           "-4, "
           "-4], max = [4, 4, 4], size = [0.2, 0.9] }\n[[query]]\nname = \"pairs\"\npair = "
           "\"sphere-sphere\"\nprimaries = \"balls\"\nsecondaries = \"balls\"\nmode = \"hits\"\n";
  };
  write("wide.toml", spheres(""));
  write("narrow.toml", spheres("filter = \"fp16\""));
  const Ran wide = cde({"run", "wide.toml", "--json"});
  ASSERT_EQ(wide.status, 0) << wide.err;
  const Ran narrow = cde({"run", "narrow.toml", "--json"});
  ASSERT_EQ(narrow.status, 0) << narrow.err;
  EXPECT_TRUE(has(narrow.err, "fp16 lanes were uncertain about "));
  EXPECT_TRUE(has(narrow.err, " of 7080 pairs, "));
  EXPECT_FALSE(has(wide.err, "filter"));
  const auto a = nlohmann::json::parse(wide.out), b = nlohmann::json::parse(narrow.out);
  ASSERT_EQ(a["frame_results"].size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto &all = a["frame_results"][i]["queries"][0],
               &some = b["frame_results"][i]["queries"][0];
    EXPECT_GT(all["hits"], 0);
    EXPECT_EQ(some["hits"], all["hits"]);
    EXPECT_EQ(some["mismatches"], 0);
    EXPECT_EQ(all["counters"]["uncertain_pairs"], 0);
    EXPECT_GE(some["counters"]["uncertain_pairs"], some["hits"]);
    EXPECT_LT(some["counters"]["uncertain_pairs"].get<int>(),
              some["counters"]["tests"].get<int>() / 2);
  }
}

TEST_F(FormatCli, AccuracyOfAScene_ReportsEveryFormat) {
  write("ball.toml", scene("", kBall));
  const Ran ran = cde({"accuracy", "--scene", "ball.toml", "--frames", "1..2", "--formats",
                       "bf16,fp16,fp64", "--device", "ecp5-85", "--json", "-q"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const auto j = nlohmann::json::parse(ran.out);
  EXPECT_EQ(j["schema"], "cde.accuracy.scene.1");
  ASSERT_EQ(j["scene_rows"].size(), 6u);
  for (const auto& row : j["scene_rows"]) {
    EXPECT_EQ(row["records"], 70);
    EXPECT_EQ(row["rows"], 18 * 1280);
    EXPECT_DOUBLE_EQ(row["modelled_row_seconds"], 18 * 1280 / device_named("ecp5-85").clock_hz());
    const double error = row["relative_t_error"]["largest"];
    if (row["format"] == "fp64") {
      EXPECT_EQ(error, 0);
      EXPECT_EQ(row["false_hits"], 0);
      EXPECT_EQ(row["other_secondaries"], 0);
    }
    if (row["format"] == "fp16") {
      EXPECT_GT(error, 1e-5);
      EXPECT_LT(error, 1e-2);
    }
  }
  const Ran table = cde({"accuracy", "--scene", "ball.toml", "--frames", "0", "--formats", "tf32"});
  EXPECT_EQ(table.status, 0) << table.err;
  EXPECT_TRUE(has(table.out, "4 lanes of large (projected, 100 MHz) in every"));
  refused({"accuracy", "--scene", "ball.toml", "--frames", "7"}, "--frames is '7'");
  refused({"accuracy", "--device", "ideal"}, "--scene");
  refused({"accuracy", "--scene", "ball.toml", "--mesh", "terrain"}, "--mesh");
}

TEST_F(FormatCli, Scene_RefusesUnsupportedFormats) {
  write("wide.toml", scene("format = \"fp64\"", kBall));
  refused({"run", "wide.toml"}, "a card cannot use fp64: the words of its buses");
  write("none.toml", scene("format = \"fp15\"", kBall));
  refused({"plan", "none.toml"}, "none.toml:5");
  write("far.toml", scene("format = \"fp16\"",
                          "triangle = [{ v0 = [0, 0, 1], v1 = [200, 0, 1], v2 = [0, 1, 1] }]"));
  refused({"run", "far.toml"}, "triangle 0: v1.x is 200, must be at most 2^7 in size in fp16");
  write("large.toml", scene("format = \"fp16\"", "mesh = \"terrain\""));
  refused({"plan", "large.toml"}, "must be at most 2^7 in size in fp16");
}

}  // namespace
}  // namespace cde::testing
