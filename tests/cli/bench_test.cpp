// SPDX-License-Identifier: Apache-2.0
// cde bench: the figures exist and are plausible; their size depends on the machine.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "../has.hpp"
#include "run_cde.hpp"

namespace cde::testing {
namespace {

class Bench : public Cli {};

TEST_F(Bench, QuickRays_ReportPlausibleFigures) {
  const Ran ran = cde({"bench", "rays", "--quick", "--device", "ideal", "--json"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const auto j = nlohmann::json::parse(ran.out);
  EXPECT_FALSE(j["machine"]["processor"].get<std::string>().empty());
  const auto& rates = j["rays"]["rates"];
  EXPECT_EQ(rates["software"][0]["kind"], "scalar");
  EXPECT_GT(rates["software"][0]["tests_per_second"], 1e6);
  ASSERT_EQ(rates["card"].size(), 2u);
  for (const auto& card : rates["card"]) {
    EXPECT_EQ(card["device_cycles"], rates["card"][0]["device_cycles"])
        << "both arithmetic back ends take the same cycles";
    EXPECT_GT(card["tests_per_second_simulated"], 1e4);
    EXPECT_NEAR(card["cycles_per_row"].get<double>(), 1.0, 0.001);
  }
  for (const auto& scene : j["rays"]["linearity"]) {
    const double rows = scene["triangles"].get<double>() * 16;
    EXPECT_LE(scene["device_cycles"], rows + 200);
    EXPECT_LT(scene["resident_bytes_per_triangle"], 60);
  }
  EXPECT_GT(j["rays"]["two_boards"]["throughput_ratio"], 0);
}

TEST_F(Bench, QuickUnits_ReportPlausibleFigures) {
  const Ran ran = cde({"bench", "fp", "--quick", "--json"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const auto j = nlohmann::json::parse(ran.out);
  const auto units = j["fp"]["units"];
  // As in the JSON of other verbs.
  for (const char* key : {"version", "commit"}) EXPECT_TRUE(j[key].is_string()) << key;
  EXPECT_EQ(j["device"]["name"], "large");
  EXPECT_TRUE(j["machine"]["processors"].is_number());
  EXPECT_TRUE(j["machine"]["system"].is_string());
  ASSERT_EQ(units.size(), 2u);
  EXPECT_EQ(units[0]["operation"], "add");
  EXPECT_EQ(units[1]["operation"], "mul");
  for (const auto& unit : units) {
    EXPECT_EQ(unit["format"], "fp32");
    EXPECT_EQ(unit["lanes"], 64);
    EXPECT_GT(unit["operations_per_second_simulated"], 1e5);
  }
}

TEST_F(Bench, QuickPairs_ReportPlausibleFigures) {
  const Ran ran = cde({"bench", "pairs", "--quick", "--json"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const auto j = nlohmann::json::parse(ran.out)["pairs"];
  ASSERT_EQ(j["pairs"].size(), 1u);
  const auto& spheres = j["pairs"][0];
  EXPECT_EQ(spheres["pair"], "sphere-sphere");
  EXPECT_GT(spheres["tests_per_second_simulated"], 1e4);
  EXPECT_EQ(spheres["cycles_per_row"], 1.0);
  EXPECT_EQ(spheres["modelled_tests_per_second"], 8 * 100e6);
  EXPECT_GT(spheres["hit_share"], 0.3);
  EXPECT_LT(spheres["hit_share"], 0.7);
  if (!j["fcl"].get<bool>()) return;
  const auto& fcl = spheres["fcl"];
  EXPECT_GT(fcl["collide_per_second"], 1e4);
  EXPECT_GT(fcl["distance_per_second"], 1e4);
  EXPECT_EQ(fcl["hits_compared"], j["cases"]);
  EXPECT_GE(fcl["hits_agreeing"], j["cases"].get<int>() - 2) << "fp32 compared with binary64";
}

TEST_F(Bench, QuickBvh_ReportsPlausibleFigures) {
  const Ran ran = cde({"bench", "bvh", "--quick", "--json"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const auto j = nlohmann::json::parse(ran.out)["bvh"];
  ASSERT_EQ(j.size(), 1u);
  EXPECT_EQ(j[0]["triangles"], 12'800);
  ASSERT_EQ(j[0]["card"].size(), 2u);
  for (const auto& card : j[0]["card"]) {
    // Much faster than brute force with 16 lanes: 16 rows of 12,800 triangles.
    EXPECT_LT(card["packet_cycles"], 16 * 12'800 / 20);
    EXPECT_GT(card["rays_per_second_device"], 1e7);
    EXPECT_GT(card["rays_per_second_with_bus"], 5e6);
    EXPECT_LT(card["rays_per_second_with_bus"], card["rays_per_second_device"]);
    EXPECT_LT(card["refit_cycles"], 4 * 12'800);
    EXPECT_GT(card["rays_per_second_simulated"], 1e3);
  }
  ASSERT_EQ(j[0]["solids"].size(), 2u) << "small spheres and large spheres";
  for (const auto& solids : j[0]["solids"]) {
    EXPECT_GT(solids["touching_share"], 0.1);
    EXPECT_LT(solids["touching_share"], 1);
    ASSERT_EQ(solids["by_question"].size(), 2u);
    for (const auto& asked : solids["by_question"]) {
      // Brute force with 4 lanes tests all 12,800 triangles in 3,200 cycles.
      EXPECT_LT(asked["seconds_in_stream"], 1600 * 1e-8);
      EXPECT_LT(asked["seconds_in_packet"], asked["seconds_alone"]);
      EXPECT_LT(asked["triangles_each"], 12'800 / 20);
    }
  }
}

/// Without --opencl-device only a GPU has a row. A named device has one that says what it is.
TEST_F(Bench, OpenClRow_NamesItsDevice) {
  const auto row_of = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"bench", "bvh", "--quick", "--json"});
    const Ran ran = cde(more);
    EXPECT_EQ(ran.status, 0) << ran.err;
    return std::pair(nlohmann::json::parse(ran.out)["bvh"][0]["opencl"], ran.err);
  };
  const auto unnamed = row_of({}).first;
  EXPECT_TRUE(unnamed.is_null() || unnamed["opencl_device"]["kind"] == "GPU") << unnamed;
  const Ran list = cde({"bench", "--list", "--json"});
  if (list.status != 0 && list.err.find("no OpenCL") != std::string::npos) GTEST_SKIP() << list.err;
  ASSERT_EQ(list.status, 0) << list.err;
  const auto device = nlohmann::json::parse(list.out)["opencl_devices"][0];
  const auto [row, text] = row_of({"--opencl-device", "0"});
  EXPECT_EQ(row["opencl_device"], device);
  const std::string name = device["name"], kind = device["kind"];
  EXPECT_TRUE(has(text, kind == "GPU" ? "GPU " + name : kind + " " + name + " through OpenCL"));
  ASSERT_EQ(row["casts"].size(), 2u);
  for (const auto& cast : row["casts"]) {
    EXPECT_EQ(cast["through"], "bvh");
    EXPECT_GT(cast["kernel_seconds"], 0);
    EXPECT_GE(cast["records_matching"], 0.98 * cast["records_compared"].get<double>());
  }
}

TEST_F(Bench, QuickBus_ReportsPlausibleFigures) {
  const Ran ran = cde({"bench", "bus", "--quick", "--json"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const auto j = nlohmann::json::parse(ran.out)["bus"];
  ASSERT_EQ(j["transfers"].size(), 3u) << "one entry per host";
  double above = 2;
  for (const auto& host : j["transfers"]) {
    EXPECT_EQ(host["bus"], "functional");
    double before = 0;
    for (const auto& point : host["modelled"]) {
      const double share = point["to_card_share"];
      EXPECT_GE(share, before) << "larger transfers must not be slower";
      EXPECT_LT(share, 1);
      before = share;
    }
    EXPECT_LT(before, above) << "hosts are sorted from best to worst";
    above = before;
  }
  EXPECT_GT(j["transfers"][0]["modelled"].back()["to_card_share"], 0.9) << "ideal host, 4 MB";
  ASSERT_EQ(j["paper_frame"].size(), 1u);
  const auto& frame = j["paper_frame"][0];
  EXPECT_EQ(frame["tests"], 1014 * 256);
  // 16 lanes at 100 MHz, plus the bus time of p64-2001.
  const auto& s = frame["modelled_seconds"];
  EXPECT_GT(s["compute"], 1014 * 16 * 10e-9);
  EXPECT_LT(s["compute"], 1.05 * 1014 * 16 * 10e-9);
  EXPECT_LT(s["total"], 1e-3);
}

TEST_F(Bench, QuickEffects_ReportPlausibleFigures) {
  const Ran table = cde({"bench", "effects", "--quick", "--markdown"});
  ASSERT_EQ(table.status, 0) << table.err;
  EXPECT_TRUE(has(table.out,
                  "| card | times the planned card | spread | cycles of the pass |\n"
                  "| --- | --- | --- | --- |\n| planned | 1.00 | 1.00 to 1.00 | "));
  EXPECT_EQ(std::count(table.out.begin(), table.out.end(), '|'), 5 * 5) << table.out;
  const Ran ran = cde({"bench", "effects", "--quick", "--json"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const Ran other = cde({"bench", "--quick", "--markdown"});
  EXPECT_EQ(other.status, 2);
  EXPECT_TRUE(has(other.err, "--markdown needs only the section effects"));
  const auto j = nlohmann::json::parse(ran.out)["effects"];
  EXPECT_EQ(j["rays"], 256);
  EXPECT_EQ(j["lanes"], 16);
  const auto& cards = j["cards"];
  ASSERT_EQ(cards.size(), 3u);
  EXPECT_EQ(cards[0]["name"], "planned");
  EXPECT_EQ(cards[0]["slower"], 1.0);
  EXPECT_EQ(cards[1]["name"], "pipe alone");
  EXPECT_EQ(cards[1]["parameters"], cards[0]["parameters"])
      << "the planned card must add nothing to the pipe";
  EXPECT_EQ(cards[2]["effect"], "gates");
  EXPECT_GT(cards[2]["slower"], 1.5);
  EXPECT_GT(cards[2]["slower_in_plans"], 1.5);
  for (const auto& card : cards) {
    EXPECT_GE(card["device_cycles"], j["triangles"].get<int>() * 16);
    EXPECT_EQ(card["device_cycles"], cards[0]["device_cycles"]) << card["name"];
    EXPECT_GE(card["slower"], card["slower_least"]);
    EXPECT_LE(card["slower"], card["slower_most"]);
    EXPECT_GT(card["frame_seconds"], 0);
    EXPECT_GT(card["frame_over_pass_cycles"], 0) << "rays and records must cross the bus";
  }
  ASSERT_EQ(j["promises"].size(), 2u) << "--quick leaves out the card with everything";
  EXPECT_NEAR(j["promises"][0]["figure"].get<double>() * cards[1]["slower"].get<double>(), 1, 1e-9);
  EXPECT_NEAR(j["promises"][1]["figure"].get<double>() - 1,
              cards[0]["frame_over_pass"].get<double>(), 1e-9);
  for (const auto& promise : j["promises"]) {
    EXPECT_LE(promise["figure_least"], promise["figure"]);
    EXPECT_GE(promise["figure_most"], promise["figure"]);
  }
}

TEST_F(Bench, UnknownSection_IsRefused) {
  const Ran ran = cde({"bench", "cars"});
  EXPECT_EQ(ran.status, 2);
  EXPECT_TRUE(has(ran.err, "no section 'cars'"));
}

}  // namespace
}  // namespace cde::testing
