// SPDX-License-Identifier: Apache-2.0
// cde run and cde plan.
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <regex>
#include <sstream>

#include "../has.hpp"
#include "planted.hpp"
#include "run_scene.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

TEST_F(RunScene, Run_ChecksAndWritesEveryRecord) {
  write("flight.toml", kFlight);
  const Ran ran = cde({"run", "flight.toml", "--json"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(has(ran.err, "1200 of 1200 records compared with the reference, 0 differ"));
  EXPECT_TRUE(has(ran.err, "per frame on large (projected, 100 MHz)"));
  const auto j = nlohmann::json::parse(ran.out);
  EXPECT_EQ(j, run_json("flight.run"));
  EXPECT_EQ(j["finished"], true);
  EXPECT_EQ(j["check"], "all");
  EXPECT_EQ(j["clock_hz"], 1e8);
  ASSERT_EQ(j["frame_results"].size(), 4u);
  std::uint64_t hits = 0;
  for (const auto& frame : j["frame_results"]) {
    const auto& q = frame["queries"][0];
    EXPECT_EQ(q["passes"], 2) << "300 rays";
    EXPECT_EQ(q["records"], 300);
    EXPECT_EQ(q["records_compared"], 300);
    EXPECT_EQ(q["mismatches"], 0);
    EXPECT_EQ(q["counters"]["tests"], 300 * 216);
    EXPECT_EQ(q["counters"]["rows"], 216 * (16 + 3));
    const auto& s = q["modelled_seconds"];
    // The compute time: the cycles of two passes, plus the time of go and interrupt.
    EXPECT_NEAR(s["compute"].get<double>(), q["counters"]["device_cycles"].get<double>() / 1e8,
                2 * 1e-6);
    EXPECT_NEAR(s["total"].get<double>(),
                s["upload"].get<double>() + s["compute"].get<double>() +
                    s["write_back"].get<double>() + s["download"].get<double>() +
                    s["registers"].get<double>(),
                1e-15);
    // PCI takes at least 15 ns per 8 bytes.
    EXPECT_GT(s["download"].get<double>(), 300 * 4 * 15e-9);
    EXPECT_GT(s["upload"].get<double>(), 300 * 4 * 15e-9);
    EXPECT_GT(s["registers"].get<double>(), 0);
    hits += q["hits"].get<std::uint64_t>();
    EXPECT_EQ(frame["files"], nlohmann::json::array());
  }
  EXPECT_EQ(j["files"], nlohmann::json::array({"hit.csv"}));
  const std::string csv = read("flight.run/hit.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 4 * 300);
  EXPECT_GT(hits, 120u);
  EXPECT_LT(hits, 1080u);
  // The first frame uploads everything, the others only the moved objects.
  const auto words = [&](int frame) {
    return j["frame_results"][frame]["queries"][0]["counters"]["secondary_words"].get<int>();
  };
  EXPECT_EQ(words(0), 216 * 9);
  EXPECT_GT(words(1), 0);
  EXPECT_LT(words(1), 216 * 9 * 2 / 3);
}

/// A frame does not depend on earlier frames or on the arithmetic back end.
TEST_F(RunScene, Frames_AreReproducible) {
  write("flight.toml", kFlight);
  std::string gates = kFlight;
  gates.replace(gates.find("lanes = 16"), 10, "lanes = 16\narithmetic = \"rtl\"");
  write("gates.toml", gates);
  const auto play = [&](const Words& words) {
    Words all = {"run", "-q", "--file-per-frame"};
    all.insert(all.end(), words.begin(), words.end());
    return cde(all).status;
  };
  ASSERT_EQ(play({"flight.toml", "--out", "all"}), 0);
  ASSERT_EQ(play({"flight.toml", "--out", "one", "--frames", "3"}), 0);
  ASSERT_EQ(play({"gates.toml", "--out", "rtl", "--frames", "2..3"}), 0);
  EXPECT_EQ(read("all/hit.000003.csv"), read("one/hit.000003.csv"));
  EXPECT_EQ(read("all/hit.000003.csv"), read("rtl/hit.000003.csv"));
  EXPECT_NE(read("all/hit.000003.csv"), read("all/hit.000002.csv"));
  EXPECT_FALSE(exists("one/hit.000002.csv"));
}

/// A mesh that moves and deforms costs the words of its vertices and one transform.
TEST_F(RunScene, CardTransforms_CostPoseAndChangedVertices) {
  const std::string motion =
      "[object.motion]\nkind = \"velocity\"\nlinear = [30, 0, 0]\nangular = [0, 0, 5]\n";
  std::string scene = kFlight;
  scene.insert(scene.find("[[object]]\nname = \"rays\""), motion);
  write("moving.toml", scene);
  const Ran plan = cde({"plan", "moving.toml"});
  ASSERT_EQ(plan.status, 0) << plan.err;
  EXPECT_TRUE(has(plan.out, "moving an object takes 12 words"));
  EXPECT_TRUE(has(plan.out, "TRANSFORM=1"));
  const Ran ran = cde({"run", "moving.toml"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const auto j = run_json("moving.run");
  const auto words = [&](std::size_t frame) {
    return j["frame_results"][frame]["queries"][0]["counters"]["secondary_words"]
        .get<std::uint64_t>();
  };
  const auto moved = j["plan"]["queries"][0]["moved_words"].get<std::uint64_t>();
  EXPECT_EQ(words(0), 216u * 9 + 14);
  for (const std::size_t frame : {1u, 2u, 3u}) {
    EXPECT_GE(words(frame), moved);
    EXPECT_LE(words(frame), moved + 40) << "rounded up to whole beats";
  }
  // Transforms on the host give the same records.
  write("host.toml", std::string(scene).replace(scene.find("lanes = 16"), 10,
                                                "lanes = 16\ntransform_site = \"host\""));
  ASSERT_EQ(cde({"run", "host.toml", "-q"}).status, 0);
  EXPECT_EQ(run_json("host.run")["frame_results"][1]["queries"][0]["counters"]["secondary_words"],
            216 * 9);
  EXPECT_EQ(read("moving.run/hit.csv"), read("host.run/hit.csv"));
}

// A ray that starts beyond the range is bad input, and its record is no hit. A run reports this
// once.
TEST_F(RunScene, OutOfRangeRay_IsReportedOnce) {
  std::string text = flight("lanes = 16");
  const std::string points = "[90, 60, 250]";
  text.replace(text.find(points), points.size(), "[1e30, 60, 250]");
  write("far.toml", text);
  const Ran ran = cde({"run", "far.toml", "-q"});
  EXPECT_EQ(ran.status, 0) << ran.err;
  const std::string said =
      "query 'hit': 300 of its primaries and 0 of its secondaries are bad input";
  const std::size_t at = ran.err.find(said);
  ASSERT_NE(at, std::string::npos) << ran.err;
  EXPECT_TRUE(has(ran.err, "beyond 2^40"));
  EXPECT_EQ(ran.err.find(said, at + 1), std::string::npos) << ran.err;
}

TEST_F(RunScene, DdrFlips_AreCorrectedOrFound) {
  write("ecc.toml", flight("lanes = 4\necc = true"));
  Ran ran = cde({"run", "ecc.toml", "--fault", "ddr:20@1", "--fault", "ddr@2", "--frames", "0..2"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(has(ran.err, "900 of 900 records compared with the reference, 0 differ"));
  EXPECT_TRUE(has(ran.err, "2 of 2 injected; repeated: 0 transfers"));
  auto faults = run_json("ecc.run")["faults"];
  EXPECT_EQ(faults["scheduled"][0]["fault"], "ddr:20:1@1");
  EXPECT_EQ(faults["injected"], 2);
  EXPECT_GE(faults["corrected_words"], 2 * 20) << "in both passes of frame 1";

  ran = cde({"run", "ecc.toml", "--fault", "ddr:1:2@1", "--fault", "ddr@3"});
  EXPECT_EQ(ran.status, 4) << ran.err;
  EXPECT_TRUE(has(ran.err, "1 word of DDR has uncorrectable errors"));
  EXPECT_TRUE(has(ran.err, "1 of 2 injected"));
  const auto j = run_json("ecc.run");
  EXPECT_EQ(j["finished"], false);
  EXPECT_EQ(j["frame_results"].size(), 1u);
  EXPECT_EQ(j["faults"]["scheduled"][1]["injected"], false);

  write("bare.toml", kFlight);
  EXPECT_EQ(cde({"run", "bare.toml", "--fault", "ddr:500:16@1"}).status, 3);
  EXPECT_EQ(run_json("bare.run")["faults"]["injected"], 1);
}

TEST_F(RunScene, BusFaults_AreRetriedOrOneError) {
  write("cycle.toml", flight("lanes = 4\nbus = \"cycle\""));
  Ran ran = cde({"run", "cycle.toml", "--frames", "0..1", "--fault", "target-abort:2:0@1",
                 "--fault", "disconnect:9:2@0", "--fault", "lost-interrupt@0"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const auto faults = run_json("cycle.run")["faults"];
  EXPECT_EQ(faults["injected"], 3);
  EXPECT_GE(faults["transfer_retries"].get<int>() + faults["pass_retries"].get<int>(), 1);
  EXPECT_GE(faults["lost_interrupts"], 1);
  ran = cde({"run", "cycle.toml", "--frames", "0..1", "--fault", "target-abort:all:0@1"});
  EXPECT_EQ(ran.status, 4) << ran.err;
  EXPECT_TRUE(has(ran.err, "target abort"));
  EXPECT_TRUE(has(ran.err, "1 of 1 injected"));
  EXPECT_EQ(run_json("cycle.run")["frame_results"].size(), 1u);
}

/// Several pairs, swapped roles, normals, masks, and other secondaries for every query.
TEST_F(RunScene, MixedScene_IsCheckedCompletely) {
  const std::string scene = std::string(CDE_SOURCE_DIR) + "/meshes/scenes/mixed.toml";
  const Ran ran = cde({"run", scene, "--out", "out", "--frames", "0..5"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const auto j = run_json("out");
  ASSERT_EQ(j["frame_results"].size(), 6u);
  for (const auto& frame : j["frame_results"]) {
    ASSERT_EQ(frame["queries"].size(), 3u);
    EXPECT_EQ(frame["queries"][0]["records"], 41 - 4);
    EXPECT_EQ(frame["queries"][1]["records"], 3);
    EXPECT_EQ(frame["queries"][2]["records"], 40);
    for (const auto& q : frame["queries"]) EXPECT_EQ(q["records_compared"], q["records"]);
  }
  EXPECT_GT(j["totals"]["hits"], 0);
  EXPECT_EQ(j["totals"]["mismatches"], 0);
  EXPECT_EQ(j["files"].size(), 3u);
  const std::string csv = read("out/nearest_ball.csv");
  EXPECT_EQ(csv.find("frame,primary,F,bad,T,CPx,CPy,CPz,index,nx,ny,nz,T_bits"), 0u) << csv;
  EXPECT_FALSE(has(read("out/scan.csv"), "\n0,3,")) << "ray 3 is masked";
}

TEST_F(RunScene, SampledOrSkippedChecks_AreReported) {
  write("flight.toml", kFlight);
  Ran ran = cde({"run", "flight.toml", "--frames", "0..1", "--check", "sample"});
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(has(ran.err, "32 of 600 records compared with the reference, a sample, 0 differ"));
  ran = cde({"run", "flight.toml", "--frames", "0..1", "--check", "none"});
  EXPECT_EQ(ran.status, 0);
  EXPECT_TRUE(has(ran.err, "skipped: no record was compared"));
  EXPECT_EQ(run_json("flight.run")["totals"]["records_compared"], 0);
  EXPECT_EQ(run_json("flight.run")["check"], "none");
}

TEST_F(RunScene, BinaryRecords_EqualCsv) {
  std::string scene = kFlight;
  write("csv.toml", scene + "[report]\nbits = true\nonly_hits = true\n");
  write("bin.toml", scene + "[report]\nresults = \"binary\"\n");
  for (const char* file : {"csv.toml", "bin.toml"})
    ASSERT_EQ(cde({"run", file, "--frames", "1", "-q", "--file-per-frame"}).status, 0);
  const std::string bytes = read("bin.run/hit.000001.bin");
  ASSERT_EQ(bytes.size(), 300u * 28);
  std::istringstream csv(read("csv.run/hit.000001.csv"));
  std::string line;
  std::getline(csv, line);
  std::size_t hits = 0;
  const auto word = [&](std::size_t record, std::size_t k) {
    std::uint32_t w = 0;
    for (std::size_t i = 4; i-- > 0;)
      w = w << 8 | static_cast<unsigned char>(bytes[28 * record + 4 * k + i]);
    return w;
  };
  for (std::size_t i = 0; i < 300; ++i) {
    EXPECT_EQ(word(i, 6), i);
    if ((word(i, 3) & 1) == 0) continue;
    ++hits;
    ASSERT_TRUE(std::getline(csv, line));
    EXPECT_EQ(line.rfind(fmt::format("{},1,0,", i), 0), 0u) << line;
    EXPECT_TRUE(has(line, fmt::format(",{},{:08x},{:08x},{:08x},{:08x}", word(i, 4), word(i, 5),
                                      word(i, 0), word(i, 1), word(i, 2))));
  }
  EXPECT_GT(hits, 50u);
  EXPECT_FALSE(std::getline(csv, line));
}

TEST_F(RunScene, WrongUsage_IsRefused) {
  write("flight.toml", kFlight);
  for (const char* frames : {"4", "0..4", "3..2", "x", "1..", "-1..2", "0..1x"})
    refused({"run", "flight.toml", fmt::format("--frames={}", frames)},
            "it must be A..B within 0..3");
  refused({"run", "flight.toml", "--check", "some"}, "--check is 'some'");
  refused({"run", "flight.toml", "--fault", "retry@1"},
          "fault 'retry:1@1': the functional bus has no such fault; it needs bus = \"cycle\"");
  refused({"run", "flight.toml", "--fault", "ddr@4"},
          "frame 4 is not among the frames of the run, 0..3");
  refused({"run", "flight.toml", "--fault", "ddr@0", "--frames", "1..2"},
          "frame 0 is not among the frames of the run, 1..2");
  refused({"run", "flight.toml", "--fault", "dddr@0"}, "there is no kind 'dddr'");
  refused({"run", "none.toml"}, "none.toml");
  refused({"plan", "none.toml"}, "none.toml");
  write("bad.toml", std::string("framse = 3\n") + kFlight);
  for (const char* verb : {"run", "plan"})
    refused({verb, "bad.toml"},
            "bad.toml:1:1: there is no key 'framse' here (did you mean 'frames'?)");
  for (const auto& [former, now] :
       {std::pair{"hierarchy", "bvh"}, std::pair{"mover", "transform_site"},
        std::pair{"verdicts", "filter"}}) {
    write("former.toml",
          fmt::format("card.{} = \"auto\"\n", former) + std::string(kFlight).replace(11, 18, ""));
    refused({"plan", "former.toml"},
            fmt::format("there is no key '{}' here; it is now '{}'", former, now));
  }
  write("burst.toml", "card.burst = 100\n" + std::string(kFlight).replace(11, 18, ""));
  for (const char* verb : {"run", "plan"})
    refused({verb, "burst.toml"}, "card, burst: is 100; it must be a multiple of 8 bytes");
}

TEST_F(RunScene, Deadline_IsStatus4AndLeavesAReadableFile) {
  write("flight.toml", kFlight);
  const Ran ran = cde({"run", "flight.toml", "--deadline", "100", "--report", "page.html"});
  EXPECT_EQ(ran.status, 4) << ran.err;
  const auto j = run_json("flight.run");
  EXPECT_EQ(j["finished"], false);
  EXPECT_TRUE(has(j["error"].get<std::string>(), "deadline of 100 cycles"));
  EXPECT_TRUE(has(read("page.html"), "The run ended early, after 0 of "));
}

TEST_F(RunScene, Interrupt_LeavesReadableFiles) {
  std::string scene = kFlight;
  scene.replace(0, 10, "frames = 100000");
  write("long.toml", scene);
  write("page.html", "old");
  const pid_t child = start({"run", "long.toml", "--file-per-frame", "--report", "page.html"});
  for (int i = 0; i < 600 && !exists("long.run/hit.000002.csv"); ++i) ::usleep(50'000);
  ::kill(child, SIGINT);
  const Ran ran = finish(child);
  EXPECT_EQ(ran.status, 128 + SIGINT) << ran.err;
  EXPECT_EQ(read("page.html"), "old");
  const auto j = run_json("long.run");
  EXPECT_EQ(j["finished"], false);
  EXPECT_EQ(j["stopped_by_signal"], SIGINT);
  const auto frames = j["frame_results"].size();
  ASSERT_GE(frames, 3u);
  std::size_t csv = 0;
  for (const auto& entry : fs::directory_iterator(folder_ / "long.run")) {
    csv += entry.path().extension() == ".csv" ? 1 : 0;
    EXPECT_TRUE(entry.path().extension() == ".csv" || entry.path().filename() == "run.json")
        << entry.path();
  }
  EXPECT_EQ(csv, frames);
}

TEST_F(RunScene, Waves_AreWrittenOrRemoved) {
  std::string scene = kFlight;
  scene.replace(scene.find("lanes = 16"), 10, "lanes = 4");
  write("small.toml", scene);
  ASSERT_EQ(cde({"run", "small.toml", "--frames", "0", "--trace", "w.fst", "-q"}).status, 0);
  const std::uint64_t whole = fs::file_size(folder_ / "w.fst");
  EXPECT_GT(whole, 10'000u);
  // Waves that do not fit are removed; the results of the run are kept.
  fs::remove(folder_ / "w.fst");
  ASSERT_GT(whole / 2, fs::file_size(folder_ / "small.run/run.json"));
  fs::remove_all(folder_ / "small.run");
  const FileLimit limit(whole / 2);
  const Ran ran = cde({"run", "small.toml", "--frames", "0", "--trace", "w.fst", "-q"});
  EXPECT_EQ(ran.status, 2);
  EXPECT_EQ(ran.err, "cde: w.fst: the waves are incomplete: File too large\n");
  EXPECT_FALSE(exists("w.fst"));
  EXPECT_EQ(run_json("small.run")["frame_results"].size(), 1u);
}

/// A faulty card: hits lie outside triangles. The run stops after the frame with status 3, and
/// run.json counts the mismatches. The printed command finds them again.
TEST_F(RunScene, FaultyCard_IsFound) {
  const Words environment = faulty_card(folder_);
  std::string scene = kFlight;
  scene.replace(scene.find("lanes = 16"), 10, "lanes = 4\nalgorithm = \"moller\"");
  write("small.toml", scene);
  const Ran ran = cde({"run", "small.toml", "--no-bundle"}, environment);
  EXPECT_EQ(ran.status, 3) << ran.err;
  EXPECT_TRUE(has(ran.err, "frame 0, query 'hit': "));
  EXPECT_TRUE(has(ran.err, "differ from the reference, the first:\nprimary "));
  const auto j = run_json("small.run");
  EXPECT_EQ(j["frame_results"].size(), 1u);
  EXPECT_GT(j["totals"]["mismatches"], 0);
  EXPECT_FALSE(exists("small.run/hit.csv")) << "no table, because frames are missing";
  EXPECT_LT(j["totals"]["mismatches"], 300);
  std::smatch match;
  EXPECT_TRUE(std::regex_search(
      ran.err, match,
      std::regex("  differ in (F, )?(T, CPx, CPy, CPz, index|index|T, CPz, index)\n")))
      << ran.err;
  ASSERT_TRUE(std::regex_search(
      ran.err, match,
      std::regex("where     cycle ([0-9]+) \\(record read\\), lane ([0-9]+), row ([0-9]+)\n"
                 "  primary ([0-9]+):")))
      << ran.err;
  EXPECT_GT(std::stoul(match[1]), 100u);
  EXPECT_EQ(4 * std::stoul(match[3]) + std::stoul(match[2]), std::stoul(match[4]) % 256);
  // The pairs alone, in the faulty pipe and in the correct one.
  const std::string wrong_pipe = fmt::format("export {}; ", fmt::join(environment, " "));
  const std::regex alone("(echo .* \\| )cde (query .*)");
  std::vector<int> in_wrong_pipe;
  for (std::sregex_iterator line(ran.err.begin(), ran.err.end(), alone), end; line != end; ++line) {
    const std::string command = (*line)[1].str() + "\"$CDE\" " + (*line)[2].str();
    in_wrong_pipe.push_back(shell(wrong_pipe + command + " --lanes 1 --no-bundle").status);
    EXPECT_EQ(shell(command).status, 0) << command;
  }
  EXPECT_EQ(in_wrong_pipe, (std::vector{0, 3})) << ran.err;
  ASSERT_TRUE(std::regex_search(ran.err, match, std::regex("the frame again: cde (.*)")))
      << ran.err;
  std::istringstream words(match[1]);
  Words again{std::istream_iterator<std::string>(words), {}};
  again.push_back("--no-bundle");
  EXPECT_EQ(cde(again, environment).status, 3);
  EXPECT_EQ(cde(again).status, 0) << "the correct card";
  EXPECT_EQ(cde({"run", "small.toml", "--check", "none"}, environment).status, 0);
}

/// The card of mixed.toml, which has one pipe more than this scene needs.
TEST_F(RunScene, BuiltCard_StandsIn) {
  write("s.toml", R"(frames = 2
[card]
lanes = 8
[[object]]
name = "rays"
random_rays = { count = 30 }
[[object]]
name = "balls"
random = { shape = "sphere", count = 9, min = [-4, -4, -4], max = [4, 4, 4], size = [0.5, 2] }
[[object]]
name = "boxes"
random = { shape = "obb", count = 20, min = [-4, -4, -4], max = [4, 4, 4], size = [0.5, 2] }
[[query]]
name = "seen"
pair = "ray-sphere"
primaries = "rays"
secondaries = "balls"
[[query]]
name = "touching"
pair = "sphere-obb"
primaries = "boxes"
secondaries = "balls"
normals = true
)");
  const Words none = {"CDE_CACHE=" + (folder_ / "cache").string()};
  const auto exact =
      nlohmann::json::parse(cde({"plan", "s.toml", "--exact-card", "--json"}, none).out);
  EXPECT_EQ(exact["built"], false);
  EXPECT_EQ(exact["stands_in_for"], nullptr);
  const auto planned = nlohmann::json::parse(cde({"plan", "s.toml", "--json"}, none).out);
  EXPECT_EQ(planned["built"], true);
  EXPECT_EQ(planned["stands_in_for"]["parameters"], exact["parameters"]);
  EXPECT_GT(planned["stands_in_for"]["estimated_times"], 1.0);
  EXPECT_LE(planned["stands_in_for"]["estimated_times"], 1.3);
  const Ran text = cde({"plan", "s.toml"}, none);
  EXPECT_TRUE(has(text.out, "PAIRS=6145"));
  std::istringstream words(text.out);  // at any line breaks
  std::string all, word;
  while (words >> word) all += word + " ";
  EXPECT_TRUE(has(all, "planned card board ARITH=host LANES=8 PAIRS=6144"));

  const Ran ran = cde({"run", "s.toml"}, none);
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_FALSE(exists("cache")) << "no model was built";
  EXPECT_EQ(
      ran.err.find("cde: the built card board ARITH=host LANES=8 PAIRS=6145 BOX=1 SWAP=1 NORMALS=1 "
                   "LAT_ADD=9 LAT_MUL=11 LAT_DIV=34 LAT_SQRT=32 LAT_CMP=3 replaces the planned "
                   "card board ARITH=host LANES=8 PAIRS=6144"),
      0u)
      << ran.err;
  EXPECT_TRUE(has(ran.err, "100 of 100 records compared with the reference, 0 differ"));
  const auto j = run_json("s.run");
  EXPECT_EQ(j["plan"]["stands_in_for"], planned["stands_in_for"]);
  EXPECT_EQ(j["model"], planned["model"]);
  EXPECT_GT(j["totals"]["hits"], 0);
}

TEST_F(RunScene, Plan_NamesPartsAndReasons) {
  write("flight.toml", kFlight);
  const Ran text = cde({"plan", "flight.toml"});
  ASSERT_EQ(text.status, 0) << text.err;
  for (const char* line :
       {"pipes", "ray-triangle", "lanes", "asked for in [card]", "transformer",
        "no secondary moves as a rigid body", "left out", "model      board ARITH=host", ".so"})
    EXPECT_TRUE(has(text.out, line));
  const Ran ran = cde({"plan", "flight.toml", "--json"});
  const auto j = nlohmann::json::parse(ran.out);
  EXPECT_EQ(j["queries"][0]["tests"], 300 * 216);
  EXPECT_GT(j["queries"][0]["moved_words"], 0);
  EXPECT_EQ(j["built"], true);
  EXPECT_EQ(files(), Words{"flight.toml"}) << "no run may start";
  // For a model that does not exist, the plan names the file that would be built.
  const Ran empty =
      cde({"plan", "flight.toml", "--json"},
          {"CDE_SHARE=" + std::string(CDE_SOURCE_DIR), "CDE_MODELS=/nowhere",
           "CDE_CACHE=" + (folder_ / "cache").string(), "CDE_ASSERT=0", "CDE_MARCH=x86-64-v2"});
  ASSERT_EQ(empty.status, 0) << empty.err;
  EXPECT_EQ(nlohmann::json::parse(empty.out)["built"], false);
  EXPECT_FALSE(exists("cache"));
}

}  // namespace
}  // namespace cde::testing
