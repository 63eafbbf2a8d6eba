// SPDX-License-Identifier: Apache-2.0
// cde inventory: its figures, its cache, and when it distrusts the cache.
#include <sys/stat.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "../has.hpp"
#include "planted.hpp"
#include "run_cde.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

/// A cache of its own, and a Verilator that logs the top modules that it elaborates.
class InventoryCache : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    fs::create_directory(folder_ / "bin");
    write("bin/verilator",
          "#!/bin/bash\n"
          "tops=\" $*\"; tops=${tops#* --top-module }\n"
          "[[ \" $* \" != *--xml-only* ]] || echo \"${tops%% *}\" >>\"$TOPS\"\n"
          "export PATH=${PATH#*:}\nexec verilator \"$@\"\n");
    ::chmod((folder_ / "bin/verilator").c_str(), 0755);
  }

  Ran inventory(std::vector<std::string> words) {
    words.insert(words.begin(), "inventory");
    words.emplace_back("--json");
    return cde(words, {"CDE_CACHE=" + (folder_ / "cache").string(),
                       "PATH=" + (folder_ / "bin").string() + ":" + std::getenv("PATH"),
                       "TOPS=" + (folder_ / "tops").string()});
  }
  Words elaborated() {
    std::stringstream lines(exists("tops") ? read("tops") : "");
    fs::remove(folder_ / "tops");
    Words tops;
    for (std::string top; lines >> top;) tops.push_back(top);
    return tops;
  }
  fs::path entry() {
    fs::path found;
    for (const auto& file : fs::directory_iterator(folder_ / "cache"))
      if (file.path().string().ends_with(".inventory.json")) found = file.path();
    return found;
  }
};

/// Verilator takes a second for pair_pipe, which has all pipes, unless their bodies are hidden.
TEST_F(InventoryCache, SameRtl_IsElaboratedOnce) {
  const Ran first = inventory({"sphere-sphere"});
  ASSERT_EQ(first.status, 0) << first.err;
  const Words tops = {"pair_pipe", "sphere_sphere", "sphere_sphere"};
  EXPECT_EQ(elaborated(), tops)
      << "one run for the pipe, one with operators of one cycle, one with the profile's latencies";
  const Ran again = inventory({"sphere-sphere"});
  EXPECT_EQ(again.out, first.out);
  EXPECT_EQ(again.err, "");
  EXPECT_EQ(elaborated(), Words());

  const fs::path file = entry();
  ASSERT_FALSE(file.empty());
  std::stringstream text;
  text << std::ifstream(file).rdbuf();
  std::string other = text.str();
  other[other.find_last_of("123456789")] ^= 1;  // another figure, still JSON
  std::ofstream(file) << other;
  const Ran damaged = inventory({"sphere-sphere"});
  EXPECT_EQ(damaged.status, 0) << damaged.err;
  EXPECT_EQ(damaged.out, first.out);
  EXPECT_TRUE(has(damaged.err, file.string() + " is not used: it is damaged"));
  EXPECT_EQ(elaborated(), tops);
}

class Inventory : public Cli {};

TEST_F(Inventory, Json_HasThePapersFiguresAndOurs) {
  const Ran ran = cde({"inventory", "ray-triangle", "sphere-sphere", "--json"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const auto j = nlohmann::json::parse(ran.out);
  ASSERT_EQ(j["pipes"].size(), 5u) << "four algorithms and sphere-sphere";
  const auto& moller = j["pipes"][1];
  EXPECT_EQ(moller["algorithm"], "moller");
  EXPECT_EQ(moller["module"], "ray_triangle_moller");
  for (const char* same : {"multipliers", "dividers", "adders", "subtractors", "comparators"})
    EXPECT_EQ(moller["operators"][same], moller["paper"][same]) << same;
  EXPECT_EQ(moller["operators"]["multipliers"], 27);
  EXPECT_EQ(moller["latency_levels"], moller["paper"]["latency_levels"]);
  EXPECT_EQ(moller["latency_levels"], 10);
  EXPECT_EQ(moller["latency_cycles"], 37) << "add 3, mul 3, div 12, cmp 1";
  EXPECT_EQ(moller["input_words"]["primary"], 8);
  EXPECT_EQ(moller["input_words"]["secondary"], 9);
  EXPECT_EQ(moller["output_words"], 5);
  const auto& spheres = j["pipes"][4];
  EXPECT_EQ(spheres["pair"], "sphere-sphere");
  EXPECT_FALSE(spheres.contains("paper"));
  EXPECT_EQ(spheres["operators"]["square_roots"], 1);
  EXPECT_EQ(spheres["output_words"], 8) << "with a normal";
  EXPECT_EQ(spheres["initiation_interval"], 1);
}

TEST_F(Inventory, EveryKindOfPipe_HasLatencyAndInterval) {
  const Ran ran = cde({"inventory", "ray-sphere", "ray-cylinder", "sphere-obb", "obb-plane",
                       "obb-cylinder", "--json"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const auto j = nlohmann::json::parse(ran.out);
  ASSERT_EQ(j["pipes"].size(), 5u);
  for (const auto& pipe : j["pipes"]) {
    EXPECT_GE(pipe["latency_levels"], 10) << pipe["pair"];
    EXPECT_GT(pipe["latency_cycles"], pipe["latency_levels"]) << pipe["pair"];
    EXPECT_EQ(pipe["initiation_interval"] > 1, pipe["pair"] == "obb-cylinder") << pipe["pair"];
  }
}

/// Pairs without candidate axes accept one row per cycle with any interval.
TEST_F(Inventory, SharedCandidateAxes_NeedFewerUnits) {
  const Ran ran = cde({"inventory", "obb-obb", "sphere-sphere", "--sat-interval", "3", "--json"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const auto j = nlohmann::json::parse(ran.out);
  EXPECT_EQ(j["pipes"][0]["pair"], "obb-obb");
  EXPECT_EQ(j["pipes"][0]["initiation_interval"], 3);
  EXPECT_EQ(j["pipes"][0]["operators"]["square_roots"], 4) << "three units for nine edge normals";
  EXPECT_EQ(j["pipes"][0]["latency_levels"], 107 + 3);
  EXPECT_EQ(j["pipes"][1]["initiation_interval"], 1);
}

/// The figures follow the present RTL: once with an additional operator, once without its pipe.
TEST_F(Inventory, ChangedRtl_ChangesTheFigures) {
  Planted rtl(folder_, "rtl/pipes/sphere_sphere.sv", "`DF_ADD(reach, a_r, b_r)",
              "`DF_ADD(reach0, a_r, b_r)\n`DF_MUL(reach, reach0, one)");
  rtl.change("rtl/pipes/pair_pipe.sv", "PAIR == int'(pairs_pkg::PAIR_RAY_TRIANGLE)", "PAIR == 99");
  const Words& environment = rtl.environment();
  const auto j = nlohmann::json::parse(
      cde({"inventory", "sphere-sphere", "ray-triangle", "--json"}, environment).out);
  const auto& spheres = j["pipes"].back();
  EXPECT_EQ(spheres["operators"]["multipliers"], 11);
  EXPECT_EQ(spheres["operators"]["subtractors"], 4);
  EXPECT_EQ(j["pipes"][1]["algorithm"], "moller");
  EXPECT_EQ(j["pipes"][1]["absent"], true);
  EXPECT_EQ(j["pipes"][1]["paper"]["multipliers"], 27);

  rtl.change("rtl/pipes/sphere_sphere.sv", "`DF_VSUB(w, b_c, a_c)", "`DF_VSUB(w, b_c, no_such)");
  const Ran broken = cde({"inventory", "sphere-sphere"}, environment);
  EXPECT_EQ(broken.status, 2);
  EXPECT_TRUE(has(broken.err, "no_such"));
}

TEST_F(Inventory, TextMarkdownAndUsage_AreCorrect) {
  const Ran text = cde({"inventory", "sphere-sphere", "--latencies", "2,4,9,8,1"});
  EXPECT_EQ(text.status, 0) << text.err;
  EXPECT_TRUE(has(text.out, "add 2, mul 4, div 9, sqrt 8, cmp 1"));
  EXPECT_EQ(text.out.find('|'), std::string::npos);
  const Ran markdown = cde({"inventory", "sphere-sphere", "--markdown"});
  EXPECT_TRUE(
      has(markdown.out, "| sphere-sphere |  10 |   1 |    1 |   7 |   4 |   2 |       0 |"));
  const auto refused = [this](const Words& words, const char* message) {
    const Ran ran = cde(words);
    EXPECT_EQ(ran.status, 2);
    EXPECT_TRUE(has(ran.err, message));
  };
  refused({"inventory", "sphere-cube"}, "no pair 'sphere-cube'");
  refused({"inventory", "--latencies", "1,2,3"}, "--latencies is '1,2,3'; it must be");
  refused({"inventory", "--latencies", "0,1,1,1,1"}, "--latencies is '0,1,1,1,1'; it must be");
  refused({"inventory", "--sat-interval", "2"}, "--sat-interval is '2'; it must be 1 or 3");
  refused({"inventory", "--json", "--markdown"}, "--markdown cannot be combined with --json");
}

}  // namespace
}  // namespace cde::testing
