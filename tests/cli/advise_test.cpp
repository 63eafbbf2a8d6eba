// SPDX-License-Identifier: Apache-2.0
// cde advise: its choices, the reasons for refusals, and the table that it reads.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "../has.hpp"
#include "cost_rows.hpp"
#include "run_cde.hpp"

namespace cde::testing {
namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

class Advise : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    write("costs.json", some_costs().dump());
    const Ran ran =
        cde({"accuracy", "--pair", "ray-triangle,sphere-sphere", "--formats", "fp16,bf16",
             "--cases", "400", "-q", "--json", "--short", "-o", "kept.json"});
    ASSERT_EQ(ran.status, 0) << ran.err;
  }
  Ran advise(Words words) {
    words.insert(words.begin(), {"advise", "--from", "kept.json"});
    return cde(words, {"CDE_COSTS=costs.json"});
  }
  static std::string first_line(const Ran& ran) { return ran.out.substr(0, ran.out.find('\n')); }
};

TEST_F(Advise, Demands_GetTheCheapestConfiguration) {
  const Ran ran = advise({"--no-leaks", "--max-error", "0.1", "--time", "10ms"});
  ASSERT_EQ(ran.status, 0) << ran.out << ran.err;
  EXPECT_TRUE(first_line(ran).starts_with("ray-triangle watertight ")) << ran.out;
  for (const char* text : {"  leaks      0 of ", "  area       estimated: ", "  time       ",
                           "cde accuracy --pair ray-triangle --algorithms watertight",
                           "| cde query ray-triangle --algorithm watertight"})
    EXPECT_TRUE(has(ran.out, text));
  // Without the limit on leaks cheaper configurations qualify, among them the whole measured lane.
  const Ran leaky = advise({"--max-error", "0.1", "--time", "10ms"});
  EXPECT_EQ(leaky.status, 0);
  EXPECT_NE(first_line(leaky), first_line(ran));
  EXPECT_EQ(advise({"--max-error", "0.1", "--time", "10ms"}).out, leaky.out);
  // More tests in the same time need more lanes.
  const Ran slow = advise({"--pair", "sphere-sphere", "--time", "10ms"}),
            fast = advise({"--pair", "sphere-sphere", "--time", "3ms"});
  EXPECT_TRUE(has(slow.out, "on 1 lane,"));
  EXPECT_TRUE(has(fast.out, "on 4 lanes,"));
}

TEST_F(Advise, Json_HasAllConfigurationsInTheSameOrder) {
  const Words demands = {"--no-leaks", "--max-error", "0.1", "--time", "10ms"};
  Words with = demands;
  with.push_back("--json");
  const Ran text = advise(demands), json = advise(with);
  ASSERT_EQ(json.status, 0) << json.err;
  const auto j = nlohmann::json::parse(json.out);
  EXPECT_EQ(j["schema"], "cde.advise.2");
  ASSERT_EQ(j["advised"].size(), 16U);
  EXPECT_TRUE(first_line(text).starts_with(j["advised"][0]["pipe"].get<std::string>() + " on "));
  bool meets = true;
  for (const auto& c : j["advised"]) {
    EXPECT_EQ(c["meets"].get<bool>(), c["lacks"].empty());
    EXPECT_TRUE(meets || !c["meets"].get<bool>())
        << "sorted after a configuration that does not meet the demands";
    meets = c["meets"];
    EXPECT_TRUE(!meets || (c["leaks"]["count"] == 0 && c["error_over_size"] <= 0.1)) << c.dump(1);
  }
  EXPECT_FALSE(meets);
}

TEST_F(Advise, UnmetDemands_NameTheObstacle) {
  const Ran ran = advise({"--max-error", "1e-5", "--no-leaks", "--time", "1ms"});
  EXPECT_EQ(ran.status, 1) << ran.out;
  EXPECT_TRUE(
      first_line(ran).starts_with("none of 16 configurations of ray-triangle meets the "
                                  "demands on ecp5-85; nearest:"))
      << ran.out;
  EXPECT_TRUE(has(ran.out, " of S (p99.9); at most 1e-5 demanded"));
  const Ran sure = advise({"--pair", "sphere-sphere", "--max-wrong", "10", "--sure"});
  EXPECT_EQ(sure.status, 1) << sure.out;
  EXPECT_TRUE(has(sure.out, "per million; at most 10 demanded for sure"));
  EXPECT_TRUE(has(sure.out, "to show this takes 384,143 cases without a wrong decision"));
  const Ran unsure = advise({"--pair", "sphere-sphere", "--max-wrong", "10"});
  EXPECT_EQ(unsure.status, 0) << unsure.out;
  // The table has no measurements for this device.
  const Ran other = advise({"--target", "hx8k", "--time", "1s"});
  EXPECT_EQ(other.status, 1);
  EXPECT_TRUE(has(other.out, "it is unknown whether a lane fits into hx8k: no row of "));
  EXPECT_EQ(advise({"--target", "hx8k"}).status, 1) << "for any demand";
  const Ran assumed = advise({"--target", "assumed:100MHz", "--time", "1ms", "--max-error", "0.1"});
  EXPECT_EQ(assumed.status, 0) << assumed.out;
  EXPECT_TRUE(has(assumed.out, "on 16 lanes"));
  EXPECT_TRUE(has(assumed.out, "area is unknown"));
}

TEST_F(Advise, InvalidDemands_AreRefused) {
  const auto refused = [&](const Words& words, const std::string& text) {
    const Ran ran = advise(words);
    EXPECT_EQ(ran.status, 2) << text << ran.out;
    EXPECT_TRUE(has(ran.err, text));
    EXPECT_EQ(ran.out, "");
  };
  const std::string digits(120'000, '1');
  refused({"--time", digits + "ns"}, "it must be 1 ps to 1e9 s");
  refused({"--time", digits}, "it must be a number and ns, us, ms or s");
  for (const char* time : {"1e1234s", "e3s", ".5s", "1es", "1 s", "1ss"})
    refused({"--time", time}, "it must be a number and ns, us, ms or s");
  refused({"--time", "1"}, "--time is '1'; it must be a number and ns, us, ms or s");
  for (const char* time : {"0ms", "1e400s", "1e-320s", "1e308s"})
    refused({"--time", time}, fmt::format("--time is '{}'; it must be 1 ps to 1e9 s", time));
  refused({"--max-error", "-1"}, "--max-error is '-1'");
  refused({"--pair", "obb-ob"}, "no pair 'obb-ob'; did you mean obb-obb?");
  refused({"--pair", "obb-obb"}, "kept.json has no configuration of obb-obb");
  refused({"--pair", "sphere-sphere", "--no-leaks"},
          "--no-leaks cannot be combined with --pair sphere-sphere");
  refused({"--sure"}, "--sure needs --max-wrong");
  refused({"--target", "xc7"}, "--target is 'xc7'; it must be ecp5-85, hx8k or assumed:");
  for (const auto& [from, text] : {std::pair{".", ".: is a folder, not a file"},
                                   {"/dev/zero", "/dev/zero: is a device, not a file"}}) {
    const Ran ran = cde({"advise", "--from", from});
    EXPECT_EQ(ran.status, 2) << ran.err;
    EXPECT_TRUE(has(ran.err, text));
  }
  write("kept.json", "{}");
  refused({}, "kept.json: not an accuracy file of schema cde.accuracy.3");
}

/// A pipe of unknown area is not the cheapest choice on a device that is too small for the others.
TEST_F(Advise, UnknownArea_IsNotAdvised) {
  const Ran ran = cde({"advise", "--pair", "obb-obb", "--max-error", "1e-2"});
  EXPECT_EQ(ran.status, 1) << ran.out;
  EXPECT_TRUE(has(ran.out, "% of the usable logic"));
  EXPECT_TRUE(has(ran.out, "; one lane, "));
}

/// The printed commands repeat the figures: with these families alone, and costs for this target.
TEST_F(Advise, PrintedCommands_RepeatTheFigures) {
  const Ran sweep = cde({"accuracy", "--pair", "ray-sphere", "--formats", "bf16", "--families",
                         "anywhere", "--cases", "300", "-q", "--json", "-o", "some.json"});
  ASSERT_EQ(sweep.status, 0) << sweep.err;
  const Ran ran =
      cde({"advise", "--from", "some.json", "--pair", "ray-sphere", "--target", "assumed:50MHz"});
  ASSERT_EQ(ran.status, 0) << ran.out;
  EXPECT_TRUE(has(ran.out,
                  "  cde accuracy --pair ray-sphere --formats bf16 --families anywhere "
                  "--target assumed:50MHz --cases 300 --seed 1 --by-family\n"));
}

/// With several pairs, each command has the families of its own pair. Without judged cases, no
/// result is called good.
TEST_F(Advise, SeveralPairs_KeepTheirOwnFamilies) {
  const Ran sweep =
      cde({"accuracy", "--pair", "sphere-sphere,ray-triangle", "--algorithms", "moller", "--box",
           "off", "--formats", "fp16", "--families", "near-contact,mesh-edges", "--cases", "40",
           "-q", "--json", "-o", "two.json"});
  ASSERT_EQ(sweep.status, 0) << sweep.err;
  const Ran solids = cde({"advise", "--from", "two.json", "--pair", "sphere-sphere", "--json"});
  const auto solid = json::parse(solids.out).at("advised").at(0);
  EXPECT_EQ(solid.at("command"),
            "cde accuracy --pair sphere-sphere --formats fp16 --families near-contact --cases 40 "
            "--seed 1 --by-family");
  const Ran rays = cde({"advise", "--from", "two.json", "--max-wrong", "10", "--json"});
  EXPECT_EQ(rays.status, 1) << rays.out;
  const auto ray = json::parse(rays.out).at("advised").at(0);
  EXPECT_TRUE(ray.at("error_over_size").is_null() && ray.at("wrong_per_million").is_null()) << ray;
  EXPECT_TRUE(has(ray.at("lacks").dump(), "no decision was judged")) << ray;
}

/// Contradicting counts are reported with their configuration.
TEST_F(Advise, ContradictingCounts_AreRefused) {
  const json kept = json::parse(read("kept.json"));
  const auto refused = [&](const char* pointer, const json& value, const std::string& text) {
    json other = kept;
    other[json::json_pointer(pointer)] = value;
    write("other.json", other.dump());
    const Ran ran = cde({"advise", "--from", "other.json"});
    EXPECT_EQ(ran.status, 2) << text;
    EXPECT_TRUE(has(ran.err, "other.json: " + text));
  };
  refused("/configurations/1/all_families/false_hits/count", 5000,
          "configuration 2: 400 cases, of these ");
  refused("/configurations/0/all_families/cases", -5, "configuration 1: cases is -5; it must be");
  for (const char* key : {"latency_levels", "initiation_interval"})
    refused(fmt::format("/configurations/0/cost/{}", key).c_str(), -1,
            fmt::format("configuration 1: {} is -1; it must be a whole number", key));
  refused("/configurations/0/cost/operators_by_kind/div", -3, "configuration 1: div is -3");
  refused("/configurations/0/cost/latency_levels", 1ull << 32,
          "configuration 1: latency_levels is 4294967296; expected at most 4294967295");
  refused("/configurations/0/all_families/t_error_u/count", -7, "configuration 1: count is -7");
  refused("/seed", -1, "seed is -1; it must be a whole number");
  refused("/seed", "one", "seed is \"one\"");
}

/// docs/accuracy.json matches the output of its command: two of its configurations are measured
/// again.
TEST_F(Advise, KeptTable_MatchesANewMeasurement) {
  std::ifstream in(std::filesystem::path(CDE_SOURCE_DIR) / "docs/accuracy.json");
  const json kept = json::parse(in, nullptr, false);
  ASSERT_TRUE(kept.is_object());
  for (const auto& [pair, format, algorithm] :
       {std::tuple{"sphere-sphere", "fp16", ""}, {"ray-triangle", "fp24", "watertight"}}) {
    Words words = {"accuracy",
                   "--pair",
                   pair,
                   "--formats",
                   format,
                   "--cases",
                   fmt::to_string(kept.at("cases").get<int>()),
                   "--seed",
                   fmt::to_string(kept.at("seed").get<int>()),
                   "-q",
                   "--json",
                   "--short"};
    if (*algorithm != '\0') words.insert(words.end(), {"--algorithms", algorithm, "--box", "off"});
    const Ran ran = cde(words);
    ASSERT_EQ(ran.status, 0) << ran.err;
    const json one = json::parse(ran.out).at("configurations").at(0);
    bool found = false;
    for (const json& there : kept.at("configurations")) {
      if (there.at("pair") != pair || there.at("format") != format ||
          there.at("algorithm") != one.at("algorithm") || there.at("box") != one.at("box"))
        continue;
      found = true;
      EXPECT_EQ(there.at("all_families"), one.at("all_families"));
      for (const char* key : {"latency_levels", "initiation_interval", "operators_by_kind"})
        EXPECT_EQ(there.at("cost").at(key), one.at("cost").at(key)) << key;
    }
    EXPECT_TRUE(found) << pair;
  }
}

}  // namespace
}  // namespace cde::testing
