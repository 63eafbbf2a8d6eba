// SPDX-License-Identifier: Apache-2.0
// --device: the clock, the latencies and the size of the cards that modelled times assume.
#include "cde/model/device.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "../has.hpp"

#include "run_cde.hpp"

namespace cde::testing {
namespace {

using nlohmann::json;

class Devices : public Cli {
 protected:
  static std::string scene(const std::string& card) {
    return "[card]\n" + card +
           "[[object]]\nname = \"t\"\nmesh = \"terrain:3,3,1\"\n[[object]]\nname = \"rays\"\n"
           "random_rays = { count = 9 }\n[[query]]\nname = \"q\"\npair = \"ray-triangle\"\n"
           "primaries = \"rays\"\nsecondaries = \"t\"\n";
  }
  using Words = std::vector<std::string>;
  json cast(const Words& more) {
    Words words = {"cast", "terrain:3,3,1", "--grid", "4x4", "--json", "-q"};
    words.insert(words.end(), more.begin(), more.end());
    const Ran ran = cde(words);
    EXPECT_EQ(ran.status, 0) << ran.err;
    return ran.status == 0 ? json::parse(ran.out) : json();
  }
};

TEST_F(Devices, Cast_TakesClockLatenciesAndLanesOfTheDevice) {
  const json usual = cast({}), clock = cast({"--clock", "50"}),
             small = cast({"--device", "ecp5-85"});
  const Device &first = default_device(), &placed = device_named("ecp5-85");
  EXPECT_EQ(usual["device"]["name"], first.name);
  EXPECT_EQ(usual["device"]["kind"], name_of(first.kind));
  EXPECT_EQ(usual["device"]["latencies"]["div"], first.latencies.div);
  EXPECT_EQ(usual["clock_hz"], first.clock_hz());
  EXPECT_EQ(usual["lanes"], first.lanes);
  EXPECT_EQ(clock["clock_hz"], 50e6);
  EXPECT_EQ(clock["device_cycles"], usual["device_cycles"]) << "only the clock differs";
  EXPECT_EQ(small["clock_hz"], placed.clock_hz());
  EXPECT_EQ(small["lanes"], placed.lanes);
  EXPECT_GT(small["device_cycles"], usual["device_cycles"]);
  for (const json* j : {&clock, &small}) EXPECT_EQ((*j)["hits"], usual["hits"]);
}

/// The card that was placed is so called, and no other.
TEST_F(Devices, PlacedCard_IsTheOnePlaced) {
  const Words placed = {"--device", "ecp5-85", "--algorithm", "moller"};
  const json brute_force = cast(placed);
  EXPECT_EQ(brute_force["device"]["kind"], "placed");
  Words more = placed;
  more.insert(more.end(), {"--clock", "70"});
  EXPECT_EQ(cast(more)["device"]["kind"], "projected");
  EXPECT_EQ(cast({"--device", "ecp5-85"})["device"]["kind"], "projected") << "another algorithm";
  more = placed;
  more.emplace_back("--bvh");
  const json bvh = cast(more);
  EXPECT_EQ(bvh["device"]["kind"], "placed");
  EXPECT_EQ(bvh["hits"], brute_force["hits"]);
  EXPECT_EQ(bvh["model"], brute_force["model"]) << "one card does both";
  // 18 triangles, each 18 cycles of the memory.
  EXPECT_GT(brute_force["device_cycles"], 18 * 18);
  const Ran ran = cde({"cast", "terrain:3,3,1", "--grid", "4x4", "--device", "ecp5-85"});
  EXPECT_TRUE(has(ran.err, "ecp5-85 with another card (projected")) << ran.err;
  EXPECT_TRUE(has(ran.err, "memory 16 bits")) << ran.err;
}

TEST_F(Devices, Reproduce_NeedsTheMemoryOfThePaper) {
  refused({"reproduce", "--quick", "--device", "ecp5-85"},
          "needs a device with DDR-400, such as large");
}

/// Operators of one cycle give shorter passes; they are called ideal.
TEST_F(Devices, Ideal_IsNamed) {
  const json ideal = cast({"--device", "ideal", "--lanes", "16"});
  EXPECT_EQ(ideal["device"]["kind"], "ideal");
  EXPECT_LT(ideal["device_cycles"], cast({})["device_cycles"]);
}

TEST_F(Devices, Plan_NamesDeviceAndEvidence) {
  write("s.toml", scene(""));
  const Ran text = cde({"plan", "s.toml"});
  EXPECT_TRUE(has(text.out, "device: " + default_device().text() + ", cycles of add/")) << text.out;
  EXPECT_TRUE(has(text.out, "evidence: "));
  const json j = json::parse(cde({"plan", "s.toml", "--device", "ecp5-85", "--json"}).out);
  EXPECT_EQ(j["device"]["name"], "ecp5-85");
  EXPECT_TRUE(has(j["parameters"].dump(), "LAT_DIV=34"));
  EXPECT_TRUE(has(j["parameters"].dump(), "LANES=1"));
}

TEST_F(Devices, Scene_NamesItsDevice) {
  write("s.toml", scene("device = \"ideal\"\nclock_mhz = 40\nlatency = { add = 5 }\n"));
  const json j = json::parse(cde({"plan", "s.toml", "--json"}).out);
  EXPECT_EQ(j["device"]["name"], "ideal");
  EXPECT_EQ(j["clock_hz"], 40e6);
  EXPECT_EQ(j["device"]["latencies"]["add"], 5);
  EXPECT_EQ(j["device"]["latencies"]["mul"], 1);
  const Ran both = cde({"plan", "s.toml", "--device", "large"});
  EXPECT_EQ(both.status, 2);
  EXPECT_TRUE(has(both.err, "--device is large, and s.toml has clock_mhz or latency; only one"));
  write("bad.toml", scene("device = \"huge\"\n"));
  const Ran bad = cde({"plan", "bad.toml"});
  EXPECT_EQ(bad.status, 2);
  EXPECT_TRUE(has(bad.err, "bad.toml:2:10: card, device: 'huge' is not one of large, ")) << bad.err;
}

TEST_F(Devices, UnknownDevice_IsRefused) {
  refused({"cast", "terrain:3,3,1", "--grid", "4x4", "--device", "huge"},
          "--device is 'huge'; it must be large, ecp5-85 or ideal");
}

}  // namespace
}  // namespace cde::testing
