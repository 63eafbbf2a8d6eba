// SPDX-License-Identifier: Apache-2.0
// cde explain --from-record and --from-test: how a record was computed, and the line of a failing
// test.
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "../has.hpp"
#include "planted.hpp"
#include "run_cde.hpp"

namespace cde::testing {
namespace {

using nlohmann::json;

/// Rays point down at triangles at z = 1, 3, 2 and again 3; the last triangle is elsewhere.
const char* const kStack =
    "v 0 0 1\nv 4 0 1\nv 0 4 1\nf 1 2 3\n"
    "v 0 0 3\nv 4 0 3\nv 0 4 3\nf 4 5 6\n"
    "v 0 0 2\nv 4 0 2\nv 0 4 2\nf 7 8 9\n"
    "f 4 5 6\n"
    "v 9 9 0\nv 10 9 0\nv 9 10 0\nf 10 11 12\n";

/// The second ray starts between them, the third misses, the fourth is masked.
std::string scene(const std::string& mode) {
  return "frames = 2\n[card]\nlanes = 4\n"
         "[[object]]\nname = \"stack\"\nmesh = \"stack.obj\"\n"
         "[[object]]\nname = \"rays\"\n"
         "ray = [{ origin = [0.5, 0.5, 5], direction = [0, 0, -1] },"
         " { origin = [1, 1, 2.5], direction = [0, 0, -1] },"
         " { origin = [-9, 1, 5], direction = [0, 0, -1] },"
         " { origin = [1, 1, 5], direction = [0, 0, -1] }]\n"
         "[[query]]\nname = \"q\"\npair = \"ray-triangle\"\nprimaries = \"rays\"\n"
         "secondaries = \"stack\"\nmask = [3]\nmode = \"" +
         mode + "\"\n";
}

class ExplainRecord : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    write("stack.obj", kStack);
    for (const char* mode : {"nearest", "farthest", "any", "hits", "all"})
      write(std::string(mode) + ".toml", scene(mode));
  }
  /// JSON of the explanation of a record.
  json told(const std::string& record, int status = 0,
            const std::vector<std::string>& environment = {}) {
    const Ran ran = cde({"explain", "--from-record", record, "--json"}, environment);
    EXPECT_EQ(ran.status, status) << ran.err;
    json j = json::parse(ran.out, nullptr, false);
    EXPECT_EQ(j["same"], status == 0);
    for (const std::string& key : keys_of(j.dump()))
      EXPECT_TRUE(documented_keys().contains(key))
          << "docs/reference/json.md lacks the key " << key;
    return j;
  }
  std::string text(const std::string& record, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"explain", "--from-record", record};
    words.insert(words.end(), more.begin(), more.end());
    const Ran ran = cde(words);
    EXPECT_EQ(ran.status, 0) << ran.err;
    return ran.out;
  }
  static std::vector<int> column(const json& candidates, const char* key) {
    std::vector<int> all;
    for (const json& c : candidates) all.push_back(c[key].get<int>());
    return all;
  }
  static std::vector<bool> stored(const json& candidates) {
    std::vector<bool> all;
    for (const json& c : candidates) all.push_back(c["card_side"]["stored"].get<bool>());
    return all;
  }
};

using List = std::vector<int>;
using Bits = std::vector<bool>;

TEST_F(ExplainRecord, Candidates_AreListedWithTheirComparison) {
  const json j = told("nearest.toml:q:1:0");
  EXPECT_EQ(j["frame"], 1);
  EXPECT_EQ(j["lane"], 0);
  const json& all = j["candidates"];
  EXPECT_EQ(column(all, "index"), (List{0, 1, 2, 3}));
  EXPECT_EQ(stored(all), (Bits{true, true, false, false}));
  EXPECT_EQ(all[0]["reason"], "kept, the first");
  EXPECT_EQ(all[1]["reason"], "kept, 2 < 4 of secondary 0");
  EXPECT_EQ(all[2]["reason"], "not kept, 3 > 2 of secondary 1");
  EXPECT_EQ(all[3]["reason"], "not kept, tie with 1: lower index stays");
  for (const json& c : all) {
    EXPECT_EQ(c["card_side"], c["reference_side"]);
    EXPECT_TRUE(c["reference_otherwise"].is_null());
  }
  // A row of four rays and a secondary enter the pipe in every cycle.
  const List cycles = column(all, "pass_cycle");
  for (std::size_t i = 1; i < cycles.size(); ++i) EXPECT_EQ(cycles[i], cycles[i - 1] + 1);
  EXPECT_EQ(j["pairs_tested"], 5);
  EXPECT_EQ(j["reference_candidates"], 4);
  EXPECT_EQ(j["card_records_of_it"][0]["index"], 1);
  EXPECT_EQ(j["card_records_of_it"], j["reference_records_of_it"]);
  EXPECT_EQ(j["explained"]["index"], 1);
  EXPECT_EQ(j["explained"]["same"], true);
  EXPECT_GT(j["explained"]["operations"].get<int>(), 50);
  EXPECT_TRUE(j["lacking"].empty());
  EXPECT_TRUE(j["too_many"].empty());
}

TEST_F(ExplainRecord, OtherModes_KeepOtherCandidates) {
  const json far = told("farthest.toml:q:0:0")["candidates"];
  EXPECT_EQ(stored(far), (Bits{true, false, false, false}));
  EXPECT_EQ(far[1]["reason"], "not kept, 2 < 4 of secondary 0");
  const json any = told("any.toml:q:0:1");
  EXPECT_EQ(any["candidates"][0]["reason"], "kept, the first");
  EXPECT_EQ(any["card_records_of_it"][0]["index"], 0);
  EXPECT_TRUE(any["lacking"].empty());
  const json hits = told("hits.toml:q:0:0");
  EXPECT_EQ(column(hits["candidates"], "index"), (List{0, 1, 2, 3}));
  EXPECT_TRUE(hits["candidates"][0]["pass_cycle"].is_null());
  EXPECT_EQ(hits["card_records_of_it"].size(), 4u);
  EXPECT_EQ(told("all.toml:q:0:0")["candidates"].size(), 5u);
}

TEST_F(ExplainRecord, Text_EndsWithTheWinnerAndItsPair) {
  const std::string all = text("nearest.toml:q:0:0", {"--max", "1"});
  const auto at = [&all](const char* part) {
    EXPECT_TRUE(has(all, part));
    return all.find(part);
  };
  EXPECT_EQ(at("nearest.toml, frame 0, query 'q', primary 0 (row 0, lane 0)"), 0u);
  const std::size_t list = at("On the card 4 of 5 pairs are candidates");
  EXPECT_LT(list, at("0  1  4 (0x40800000)"));
  EXPECT_LT(at("3 more (--max)"), at("card       secondary 1 wins, T 2 (0x40000000)"));
  EXPECT_LT(at("Brute force in the reference: 4 of 5 pairs are candidates."),
            at("Primary 0 and secondary 1 in the pipe alone"));
  at("The card's answer equals the reference's.");
  const std::string none = text("nearest.toml:q:0:2");
  EXPECT_TRUE(has(none, "On the card 0 of 5 pairs are candidates."));
  EXPECT_TRUE(has(none, "no secondary wins"));
  EXPECT_TRUE(
      has(text("hits.toml:q:0:0"), "In mode hits every hit has a record. There is no winner"));
}

TEST_F(ExplainRecord, Manual_ShowsThePrintedOutput) {
  write("stack.toml", scene("nearest"));
  std::ifstream in(std::filesystem::path(CDE_SOURCE_DIR) / "docs/guides/explain.md");
  const std::string manual{std::istreambuf_iterator<char>(in), {}};
  const std::string all = text("stack.toml:q:0:0");
  std::istringstream lines(all.substr(0, all.find("ray-triangle --algorithm")));
  std::string indented = "    $ cde explain --from-record stack.toml:q:0:0\n";
  for (std::string line; std::getline(lines, line);)
    indented += (line.empty() ? "" : "    ") + line + '\n';
  EXPECT_TRUE(has(manual, indented));
}

/// Waves of a BVH traversal show few pairs. The explanation uses brute force, which has the same
/// record.
TEST_F(ExplainRecord, BvhQuery_IsExplainedByBruteForce) {
  std::string bvh = scene("nearest");
  bvh.insert(bvh.find("[card]\n") + 7, "bvh = \"on\"\n");
  write("bvh.toml", bvh);
  const json plan = json::parse(cde({"plan", "bvh.toml", "--json"}).out);
  EXPECT_EQ(plan["queries"][0]["through"], "bvh");
  const json j = told("bvh.toml:q:0:0");
  EXPECT_EQ(j["brute_force_instead"], true);
  EXPECT_EQ(j["pairs_tested"], 5);
  EXPECT_EQ(j["card_records_of_it"][0]["index"], 1);
  EXPECT_TRUE(has(text("bvh.toml:q:0:0"), "the packet is tested by brute force"));
  EXPECT_EQ(told("nearest.toml:q:0:0")["brute_force_instead"], false);
}

TEST_F(ExplainRecord, RunFolder_NamesTheRun) {
  ASSERT_EQ(cde({"run", "nearest.toml", "--out", "out", "-q", "--frames", "0..1"}).status, 0);
  EXPECT_EQ(told("out:q:1:1")["candidates"].size(), 2u);
}

TEST_F(ExplainRecord, WrongUpdate_IsNamed) {
  const Planted fault(folder_, "rtl/update/update_lanes.sv", "{CW{index_i < index_old[l]}}",
                      "{CW{index_i > index_old[l]}}");
  const json j = told("nearest.toml:q:0:0", 3, fault.environment());
  EXPECT_EQ(j["candidates"][3]["reason"], "kept, though tie with 1: lower index stays");
  EXPECT_EQ(j["candidates"][3]["reference_otherwise"], "not kept");
  EXPECT_EQ(j["card_records_of_it"][0]["index"], 3);
  EXPECT_EQ(j["reference_records_of_it"][0]["index"], 1);
  EXPECT_EQ(j["explained"]["index"], 3);
  EXPECT_EQ(j["explained"]["same"], true);
  // The same with the folder of the run that found it.
  std::string traced = scene("nearest");
  traced.insert(traced.find("lanes"), "trace = true\n");
  write("traced.toml", traced);
  ASSERT_EQ(
      cde({"run", "traced.toml", "--out", "out", "-q", "--no-bundle"}, fault.environment()).status,
      3);
  const json again = told("out:q:0:0", 3, fault.environment());
  EXPECT_EQ(again["candidates"], j["candidates"]);
  EXPECT_EQ(again["first_frame"], 0);
}

TEST_F(ExplainRecord, MissedPair_IsListedAsMissing) {
  const Planted fault(folder_, "rtl/pipes/ray_triangle_moller.sv", "`DF_DOT(u, p, s)",
                      "`DF_DOT(u, p, e1)");
  std::string moller = scene("nearest");
  moller.insert(moller.find("lanes"), "algorithm = \"moller\"\n");
  write("moller.toml", moller);
  const json j = told("moller.toml:q:0:0", 3, fault.environment());
  EXPECT_FALSE(j["lacking"].empty() && j["too_many"].empty()) << j.dump(1);
  EXPECT_EQ(j["explained"]["same"], false);
  const json& place = j["explained"]["first_differences"][0]["sources"][0][0];
  EXPECT_EQ(place["file"], "ray_triangle_moller.sv");
  EXPECT_EQ(place["line"], fault.line());
}

TEST_F(ExplainRecord, InvalidRecordName_IsRefused) {
  const auto no = [this](const std::string& record, const std::string& why) {
    refused({"explain", "--from-record", record}, why);
  };
  no("nearest.toml:q:0", "RUN:QUERY:FRAME:PRIMARY");
  no("nearest.toml:q:x:0", "RUN:QUERY:FRAME:PRIMARY");
  no("nearest.toml:p:0:0", "query");
  no("nearest.toml:q:2:0", "frame 2");
  no("nearest.toml:q:0:4", "primary 4");
  no("nearest.toml:q:0:3", "masked");
  no("nothing.toml:q:0:0", "nothing.toml");
  no(".:q:0:0", "run.json");
  // A stranger's run.json names a FIFO, for whose writer the command would wait.
  std::filesystem::create_directory(folder_ / "theirs");
  write("theirs/run.json",
        R"({"scene":")" + (folder_ / "fifo").string() + R"(","frame_results":[],"frames":[0,0]})");
  ASSERT_EQ(::mkfifo((folder_ / "fifo").c_str(), 0600), 0);
  const Ran fifo = shell("timeout 60 \"$CDE\" explain --from-record theirs:q:0:0");
  EXPECT_EQ(fifo.status, 2);
  EXPECT_TRUE(has(fifo.err, "fifo: is not a regular file\n")) << fifo.err;
  refused({"explain", "sphere-sphere", "--from-record", "nearest.toml:q:0:0"}, "--from-record");
  refused({"explain", "--from-record", "nearest.toml:q:0:0", "--arith", "host"}, "--arith");
  refused({"explain", "--from-record", "nearest.toml:q:0:0", "--from-test", "x"},
          "--from-test cannot be combined with --from-record");
  refused({"explain", "--exact-card", "sphere-sphere", "0"}, "--exact-card");
  refused({"explain"}, "PAIR");
}

class ExplainLine : public Cli {};

TEST_F(ExplainLine, LineOfATestOrQuery_IsRead) {
  const std::string words = "0x1p+0 0x0 0 0x40000000 | 0x3fc00000 0 0 1";
  const Ran plain = cde({"explain", "sphere-sphere", "--arith", "host", words});
  ASSERT_EQ(plain.status, 0) << plain.err;
  for (const std::string& line :
       {"  explain: cde explain sphere-sphere --format fp32 --arith host '" + words + "'",
        "  echo '" + words + "' | cde query sphere-sphere --format fp32 --arith host --lanes 8",
        "echo '" + words +
            "' | cde query sphere-sphere --bits -q --no-check --bundle F --arith host",
        "repeat with: yes " + std::string("0x1p+0,0,0,2,1.5,0,0,1") +
            " | head -n 3 | cde query sphere-sphere; echo $?",
        "explain it:  /x/cde explain sphere-sphere --arith host \"" + words + "\""}) {
    const Ran ran = cde({"explain", "--from-test", line});
    EXPECT_EQ(ran.status, 0) << ran.err;
    EXPECT_EQ(ran.out, plain.out) << line;
  }
  const Ran half = cde({"explain", "--json", "--from-test",
                        "explain: cde explain sphere-sphere --format fp16 --arith host '0 0 0 "
                        "0x3c00 | 0x3e00 0 0 1'"});
  EXPECT_EQ(half.status, 0) << half.err;
  EXPECT_TRUE(json::parse(half.out)["same"].get<bool>());
}

TEST_F(ExplainLine, UnreadableLine_IsRefused) {
  for (const char* line :
       {"", "case 3", "cde explain sphere-sphere", "echo '1 2' | cde query spheer-sphere",
        "cde explain sphere-sphere '0 0 0 1", "cde explain sphere-sphere --depth 3 '0 0 0 1'"}) {
    const Ran ran = cde({"explain", "--from-test", line});
    EXPECT_EQ(ran.status, 2) << line;
    EXPECT_EQ(ran.out, "");
    if (*line == '\0') continue;  // an empty value counts as none
    EXPECT_TRUE(has(ran.err, "expected a line with \"cde explain PAIR"));
  }
  refused({"explain", "--from-test", "cde explain sphere-sphere --depth 3 '0 0 0 1'"},
          "--from-test: cde explain has no option '--depth'; `cde explain --help` lists them; "
          "expected a line");
  refused({"explain", "--from-test", "cde query sphere-sphere --depth 3"},
          "--from-test: cde query has no option '--depth'; `cde query --help` lists them");
  const Ran words = cde({"explain", "--from-test", "cde explain sphere-sphere '0 0 0 1'"});
  EXPECT_EQ(words.status, 2);
  EXPECT_TRUE(has(words.err, "4 words, must be 8"));
}

/// A failing pipe test leaves the same package as `cde query`, and its line can be read.
TEST_F(ExplainLine, FailingPipeTest_LeavesABundle) {
  const Planted fault(folder_, "rtl/pipes/sphere_sphere.sv", "`DF_VSUB(", "`DF_VADD(");
  std::string exports;
  for (const std::string& variable : fault.environment()) exports += "export " + variable + "\n";
  const Ran ran = shell(exports +
                        "export CDE_FAILURES=$PWD/failures CDE_CASES=64\n"
                        "'" CDE_PAIR_TESTS
                        "' --gtest_filter=Fp32/PairPipe.Pipe_EqualsItsReference"
                        "BitForBit/sphere_sphere_fp32_host");
  EXPECT_EQ(ran.status, 1) << ran.out << ran.err;
  const std::string folder =
      "failures/Fp32_PairPipe.Pipe_EqualsItsReferenceBitForBit_sphere_sphere_fp32_host";
  EXPECT_TRUE(has(ran.out, "packed in:   "));
  EXPECT_TRUE(exists(folder + "/waves.fst"));
  EXPECT_FALSE(exists(folder + "-2")) << "one folder per test";
  const json j = json::parse(read(folder + "/fail.json"));
  EXPECT_EQ(j["pair"], "sphere-sphere");
  EXPECT_EQ(j["happened_again"], true);
  EXPECT_EQ(j["differs_alone"], true);
  const json& place = j["first_differences"][0]["sources"][0][0];
  EXPECT_EQ(place["file"], "sphere_sphere.sv");
  EXPECT_EQ(place["line"], fault.line());
  const std::size_t at = ran.out.find("  explain: cde explain ");
  ASSERT_NE(at, std::string::npos) << ran.out;
  const std::string line = ran.out.substr(at, ran.out.find('\n', at) - at);
  const Ran told = cde({"explain", "--from-test", line, "--json"}, fault.environment());
  EXPECT_EQ(told.status, 3) << told.err;
  EXPECT_EQ(json::parse(told.out)["first_differences"][0]["sources"][0][0]["line"], fault.line());
}

}  // namespace
}  // namespace cde::testing
