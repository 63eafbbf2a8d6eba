// SPDX-License-Identifier: Apache-2.0
// cde cast and cde doctor.
#include <fmt/format.h>
#include <signal.h>
#include <sys/mount.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "../has.hpp"
#include "cde/wave/wave_file.hpp"
#include "planted.hpp"
#include "run_cde.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;
using namespace std::string_literals;
using Words = std::vector<std::string>;

const char* const kTwo = "v 0 0 1\nv 1 0 1\nv 0 1 1\nv 0 0 2\nv 1 0 2\nv 0 1 2\nf 1 2 3\nf 4 5 6\n";

class Cast : public Cli {};

TEST_F(Cast, CsvOnStdout_IsTheOnlyOutput) {
  write("one.obj", kOneTriangle);
  const Ran ran =
      cde({"cast", "one.obj", "--ray", "0.25,0.25,0,0,0,2", "--ray=-5,0,0,0,0,1", "-o", "-"});
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(ran.out,
            "ray,F,T,CPx,CPy,CPz,index\n0,1,0.5,0.25,0.25,1,0\n1,0,inf,0,0,0,4294967295\n");
  EXPECT_TRUE(has(ran.err, "2 of 2 records match the reference"));
  EXPECT_TRUE(has(ran.err, "device           large (projected, 100 MHz)"));
  EXPECT_EQ(files(), Words{"one.obj"});
}

/// No card with 4 lanes exists without waves, but one with waves does.
TEST_F(Cast, BuiltCard_StandsIn) {
  write("one.obj", kOneTriangle);
  const Words environment = {"CDE_CACHE=" + (folder_ / "cache").string()};
  Words words = {"cast",    "one.obj", "--ray", "0.25,0.25,0,0,0,2", "--algorithm", "moller",
                 "--lanes", "4",       "--json"};
  const Ran ran = cde(words, environment);
  ASSERT_EQ(ran.status, 0) << ran.err;
  const std::string planned =
      "ARITH=host LANES=4 BOX=1 LAT_ADD=9 LAT_MUL=11 LAT_DIV=34 "
      "LAT_SQRT=32 LAT_CMP=3";
  EXPECT_EQ(ran.err.find("cde: the built card board " + planned +
                         " TRACE=1 replaces the planned card board " + planned +
                         ", at an estimated 1.10 times its time; --exact-card builds the planned "
                         "one\n"),
            0u)
      << ran.err;
  EXPECT_FALSE(exists("cache")) << "no model was built";
  const auto j = nlohmann::json::parse(ran.out);
  Words parameters;
  std::istringstream words_of(planned);
  for (std::string word; words_of >> word;) parameters.push_back(word);
  EXPECT_EQ(j["stands_in_for"]["parameters"], parameters);
  parameters.emplace_back("TRACE=1");
  EXPECT_EQ(j["parameters"], parameters);
  EXPECT_NEAR(j["stands_in_for"]["estimated_times"].get<double>(), 1.1, 1e-9);
  EXPECT_EQ(j["records_matching"], 1);
  EXPECT_EQ(j["hits"], 1);
  words.emplace_back("-q");
  EXPECT_EQ(cde(words, environment).err, "");
  // A file in the place of the cache shows that a card would be built.
  write("cache", "");
  words.back() = "--exact-card";
  const Ran exact = cde(words, environment);
  EXPECT_EQ(exact.status, 2);
  EXPECT_EQ(exact.out, "");
  EXPECT_TRUE(has(exact.err, "is not a folder"));
  // Explicit requests are kept: algorithm, box rule, and lanes if given.
  for (const Words& other : {Words{"--no-box"}, Words{"--algorithm", "badouel"}}) {
    words.pop_back();
    words.insert(words.end(), other.begin(), other.end());
    const Ran built = cde(words, environment);
    EXPECT_EQ(built.status, 2) << built.err;
    EXPECT_FALSE(has(built.err, "stands in"));
  }
  // Without a number of lanes the default card is used.
  const Ran standard = cde({"cast", "one.obj", "--ray", "0,0,0,0,0,1", "--json"}, environment);
  EXPECT_EQ(nlohmann::json::parse(standard.out)["stands_in_for"], nullptr);
}

/// A ray in the plane of a sliver: the pipe without the box rule reports a hit in empty space.
TEST_F(Cast, Summary_TellsWhetherTheBoxRuleApplies) {
  write("one.obj", kOneTriangle);
  const Words ray = {"cast", "one.obj", "--ray", "0.25,0.25,0,0,0,2", "--json"};
  Ran ran = cde(ray);
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(has(ran.err, "fp32, watertight, box rule, mode nearest"));
  EXPECT_EQ(nlohmann::json::parse(ran.out)["box"], true);
  Words plain = ray;
  plain.insert(plain.end(), {"--no-box", "--algorithm", "moller"});
  ran = cde(plain);
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(has(ran.err, "fp32, moller, no box rule, mode nearest"));
  EXPECT_EQ(nlohmann::json::parse(ran.out)["box"], false);
}

TEST_F(Cast, BitsQuietAndFile_WriteOnlyTheFile) {
  write("one.obj", kOneTriangle);
  const Ran ran =
      cde({"cast", "one.obj", "--ray", "0.25,0.25,0,0,0,2", "-o", "hits.csv", "--bits", "-q"});
  EXPECT_EQ(ran.status, 0);
  EXPECT_EQ(ran.out + ran.err, "");
  EXPECT_EQ(read("hits.csv"),
            "ray,F,T,CPx,CPy,CPz,index,T_bits,CPx_bits,CPy_bits,CPz_bits\n"
            "0,1,0.5,0.25,0.25,1,0,3f000000,3e800000,3e800000,3f800000\n");
}

TEST_F(Cast, EveryMode_HasItsRecords) {
  write("two.obj", kTwo);
  const std::map<std::string, std::string> expected = {
      {"nearest", "0,1,1,0.25,0.25,1,0\n1,0,inf,0,0,0,4294967295\n"},
      {"farthest", "0,1,2,0.25,0.25,2,1\n1,0,inf,0,0,0,4294967295\n"},
      {"any", "0,1,1,0.25,0.25,1,0\n1,0,inf,0,0,0,4294967295\n"},
      {"all",
       "0,1,1,0.25,0.25,1,0\n1,0,inf,0,0,0,4294967295\n0,1,2,0.25,0.25,2,1\n1,0,inf,0,0,0,"
       "4294967295\n"},
      {"hits", "0,1,1,0.25,0.25,1,0\n0,1,2,0.25,0.25,2,1\n"}};
  for (const auto& [mode, rows] : expected) {
    const Ran ran = cde({"cast", "two.obj", "--ray", "0.25,0.25,0,0,0,1", "--ray", "9,9,9,1,0,0",
                         "--mode", mode, "-o", "-", "-q"});
    EXPECT_EQ(ran.status, 0) << mode << ran.err;
    EXPECT_EQ(ran.out, "ray,F,T,CPx,CPy,CPz,index\n" + rows) << mode;
  }
}

TEST_F(Cast, RaysOfSeveralPackets_GiveAllRecords) {
  write("one.obj", kOneTriangle);
  std::string rays = "ox,oy,oz,dx,dy,dz\n";
  for (int i = 0; i < 600; ++i) rays += fmt::format("{},0.001,0,0,0,1\n", i / 400.0);
  write("rays.csv", rays);
  const Ran ran = cde({"cast", "one.obj", "--rays", "rays.csv", "--json", "-o", "hits.csv"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const auto j = nlohmann::json::parse(ran.out);
  EXPECT_EQ(j["rays"], 600);
  EXPECT_EQ(j["packets"], 3);
  EXPECT_EQ(j["triangles"], 1);
  EXPECT_EQ(j["hits"], 400);
  EXPECT_EQ(j["records"], 600);
  EXPECT_EQ(j["records_compared"], 600);
  EXPECT_EQ(j["records_matching"], 600);
  EXPECT_EQ(j["tests"], 600);
  EXPECT_EQ(j["clock_hz"], 1e8);
  EXPECT_GT(j["device_cycles"], 3 * 16);
  EXPECT_DOUBLE_EQ(j["modelled_pass_seconds"],
                   (j["device_cycles"].get<double>() + j["writeback_cycles"].get<double>()) / 1e8);
  const std::string csv = read("hits.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 601);
  EXPECT_TRUE(has(csv, "\n599,0,inf"));
}

TEST_F(Cast, BothArithmetics_GiveTheSameFile) {
  for (const char* arithmetic : {"host", "rtl"}) {
    const Ran ran = cde({"cast", "terrain:12,9,3", "--grid", "20x17", "--bits", "-o",
                         fmt::format("{}.csv", arithmetic), "--arith", arithmetic});
    EXPECT_EQ(ran.status, 0) << ran.err;
    EXPECT_TRUE(has(ran.err, "340 of 340 records match"));
  }
  EXPECT_EQ(read("host.csv"), read("rtl.csv"));
}

/// Three packets on one card and on three: the same records in the same order, in a third of the
/// modelled time.
TEST_F(Cast, MoreCards_GiveTheSameFile) {
  for (const char* mode : {"nearest", "hits"}) {
    nlohmann::json summary[2];
    for (int i = 0; i < 2; ++i) {
      const Ran ran =
          cde({"cast", "terrain:12,9,3", "--grid", "32x24", "--mode", mode, "--bits", "--json",
               "-o", fmt::format("{}.csv", i), "--boards", i == 0 ? "1" : "3"});
      ASSERT_EQ(ran.status, 0) << ran.err;
      summary[i] = nlohmann::json::parse(ran.out);
    }
    EXPECT_EQ(read("0.csv"), read("1.csv")) << mode;
    for (const char* sum : {"hits", "records", "records_compared", "tests"})
      EXPECT_EQ(summary[0][sum], summary[1][sum]) << mode << " " << sum;
    EXPECT_GT(summary[0]["hits"], 0);
    EXPECT_NEAR(summary[1]["modelled_pass_seconds"].get<double>() * 3,
                summary[0]["modelled_pass_seconds"].get<double>(),
                0.05 * summary[0]["modelled_pass_seconds"].get<double>());
  }
  EXPECT_EQ(cde({"cast", "terrain:1,1,1", "--grid", "4x4", "--boards", "65"}).status, 2);
  EXPECT_EQ(
      cde({"cast", "terrain:1,1,1", "--grid", "4x4", "--boards", "2", "--trace", "x.fst"}).status,
      2);
}

/// Parallel cards buffer records that have to wait, and each holds a mesh. Excess memory is refused
/// with the sizes before anything is built or cast. One card buffers none.
TEST_F(Cast, MemoryOfManyCards_IsLimited) {
  const Ran ran = cde({"cast", "terrain:64,64,1", "--grid", "8192x8192", "--mode", "all",
                       "--boards", "64", "-o", "x.csv"});
  EXPECT_EQ(ran.status, 2);
  std::smatch match;
  ASSERT_TRUE(std::regex_search(
      ran.err, match,
      std::regex("cde: 64 cards take (\\d+) MB, and records that wait for earlier cards "
                 "(\\d+) MB; the limit on this machine is (\\d+) MB")))
      << ran.err;
  EXPECT_EQ(match[1], "18") << "64 times 8192 triangles of 36 bytes";
  const double records = 63.0 / 64 * 8192 * 8192 * 8192 * 40 / (1 << 20);
  EXPECT_NEAR(std::stod(match[2]), records, 1e-3 * records);
  EXPECT_LT(std::stod(match[3]), std::stod(match[2]));
  EXPECT_TRUE(files().empty());
}

TEST_F(Cast, Clock_ChangesOnlyTheModelledTime) {
  write("one.obj", kOneTriangle);
  const auto at = [&](const char* mhz) {
    return nlohmann::json::parse(
        cde({"cast", "one.obj", "--ray", "0,0,0,0,0,1", "--json", "-q", "--clock", mhz}).out);
  };
  const auto slow = at("50"), fast = at("200");
  EXPECT_EQ(slow["device_cycles"], fast["device_cycles"]);
  EXPECT_DOUBLE_EQ(slow["modelled_pass_seconds"], 4 * fast["modelled_pass_seconds"].get<double>());
  for (const char* clock : {"200MHz", "0.2GHz", "200000kHz", "2e8Hz", "200 MHz"})
    EXPECT_EQ(at(clock)["clock_hz"], 2e8) << clock;
}

TEST_F(Cast, Pictures_HaveTheirSize) {
  const Ran ran = cde({"render", "terrain:20,20,1", "--size", "48x32", "--image", "depth.png",
                       "--shaded", "sun.png"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  for (const char* name : {"depth.png", "sun.png"}) {
    const std::string png = read(name);
    ASSERT_GT(png.size(), 100u);
    EXPECT_EQ(png.substr(1, 3), "PNG");
    EXPECT_EQ(png.substr(16, 8), std::string("\0\0\0\x30\0\0\0\x20", 8)) << "width and height";
  }
  EXPECT_EQ(cde({"cast", "terrain:20,20,1", "--camera=-50,-50,500,100,100,100,60", "--size",
                 "16x16", "-q"})
                .status,
            0);
}

TEST_F(Cast, Waves_HaveEverySignal) {
  write("one.obj", kOneTriangle);
  Ran ran =
      cde({"cast", "one.obj", "--ray", "0,0,0,0,0,1", "--lanes", "4", "--trace", "waves.fst"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_GT(read("waves.fst").size(), 10'000u);
  EXPECT_EQ(files(), (Words{"one.obj", "waves.fst"}));
  // Waves hold every signal of the pipe (lane by lane), of control and of the bus. They hold no
  // parameters, memories or internals of operators.
  const std::map<std::string, unsigned> signals = wave::signals(folder_ / "waves.fst");
  const std::string pipe =
      "board.board.engine.group[0].lanes.pair[0].g_present.g_free.pipe.pipe.pipe.g_pipe.pipe.";
  for (const std::string& name :
       {"board.bus_valid_i"s, "board.board.control.state_q"s, "board.board.registers.cycles_q"s,
        "board.board.clk_engine"s, "board.board.secondary[8]"s, pipe + "a_i[7][3]", pipe + "det[0]",
        pipe + "cp_o[2][3]"})
    EXPECT_TRUE(signals.count(name)) << name;
  for (const auto& [name, handle] : signals)
    for (const char* part : {"LAT_ADD", ".T_", "cell_u", "mem["}) EXPECT_FALSE(has(name, part));
  const std::string one = fmt::format("{:032b}", 0x3f800000);
  EXPECT_TRUE(wave::values(folder_ / "waves.fst", signals.at(pipe + "t_o[0]")).count(one));
  // A failing cast keeps its waves.
  fs::remove(folder_ / "waves.fst");
  ran = cde({"cast", "one.obj", "--ray", "0,0,0,0,0,1", "--lanes", "4", "--trace", "waves.fst",
             "--deadline", "10"});
  EXPECT_EQ(ran.status, 4);
  EXPECT_EQ(files(), (Words{"one.obj", "waves.fst"}));
}

TEST_F(Cast, BadInput_IsRefusedAndNamed) {
  write("one.obj", kOneTriangle);
  write("empty.obj", "");
  write("points.obj", "v 0 0 0\n");
  write("nan.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  write("none.csv", "# nothing\n");
  write("bad.csv", "0,0,0,0,0,1\n0,0,zero,0,0,1\n");
  write("zero.csv", "0,0,0,0,0,0\n");
  fs::create_directory(folder_ / "folder");
  const Words out = {"-o", "hits.csv"};
  const auto with = [&](Words words) {
    words.insert(words.begin(), "cast");
    words.insert(words.end(), out.begin(), out.end());
    return words;
  };
  const std::string ray = "0,0,0,0,0,1";
  refused({"cast"}, "cde cast needs MESH");
  refused({"cats"}, "no verb 'cats'; did you mean cast?");
  refused(with({"one.obj", "--ray", ray, "--no-such-option"}), "--no-such-option");
  refused(with({"missing.obj", "--ray", ray}), "missing.obj");
  refused(with({"folder", "--ray", ray}), "folder");
  refused(with({"empty.obj", "--ray", ray}), "empty.obj");
  refused(with({"points.obj", "--ray", ray}), "points.obj");
  refused(with({"nan.obj", "--ray", ray}), "nan");
  refused(with({"terrain:0,1,1", "--ray", ray}), "terrain");
  refused(with({"one.obj", "--ray", "0,0,0"}), "--ray");
  refused(with({"one.obj", "--ray", "0,0,0,0,0,0"}), "direction is zero");
  refused(with({"one.obj", "--ray", "0,0,0,0,0,nan"}), "--ray");
  refused(with({"one.obj", "--rays", "missing.csv"}), "missing.csv");
  refused(with({"one.obj", "--rays", "none.csv"}), "none.csv: no rays");
  refused(with({"one.obj", "--rays", "bad.csv"}), "bad.csv:2:5");
  refused(with({"one.obj", "--rays", "zero.csv"}), "zero.csv:1");
  refused(with({"one.obj", "--rays", "folder"}), "folder");
  refused(with({"one.obj", "--ray", ray, "--grid", "4x4"}), "--grid cannot be combined with --ray");
  refused(with({"one.obj", "--camera", "0,0,0,1,1,1", "--grid", "4x4"}),
          "--grid cannot be combined with --camera");
  refused(with({"one.obj", "--grid", "4x4", "--size", "4x4"}), "--size");
  refused(with({"one.obj", "--ray", ray, "--size", "4x4"}), "--size");
  refused(with({"one.obj", "--grid", "0x4"}), "0 x 4 pixels");
  refused(with({"one.obj", "--size", "axb"}), "--size");
  refused(with({"one.obj", "--camera", "0,0"}), "--camera");
  refused(with({"one.obj"}), "rays are missing");
  refused(with({"one.obj", "--ray", ray, "--image", "x.png"}), "no option '--image'");
  refused({"render", "one.obj", "--ray", ray}, "no option '--ray'");
  refused({"render", "one.obj", "--mode", "all"}, "no option '--mode'");
  refused(with({"one.obj", "--ray", ray, "--mode", "best"}), "--mode is 'best'");
  refused(with({"one.obj", "--ray", ray, "--arith", "gpu"}), "--arith is 'gpu'");
  for (const char* lanes : {"0", "3", "512"})
    refused(with({"one.obj", "--ray", ray, "--lanes", lanes}),
            fmt::format("--lanes is '{}'; it must be auto or a power of two", lanes));
  for (const char* lanes : {"-1", "many", "4.5"})
    refused(with({"one.obj", "--ray", ray, "--lanes", lanes}), "--lanes");
  for (const char* clock :
       {"0", "-5", "nan", "inf", "1e6", "1e-300", "11GHz", "1mhz", "5 s", "MHz"})
    refused(with({"one.obj", "--ray", ray, "--clock", clock}), "it must be 1 to 10000 MHz");
  refused(with({"one.obj", "--ray", ray, "--deadline", "-1"}), "--deadline is '-1'; it must be");
  refused(with({"one.obj", "--ray", ray, "--timeout", "0"}), "--timeout");
  refused({"cast", "one.obj", "--ray", ray, "--json", "-o", "-"}, "stdout");
  refused({"cast", "one.obj", "--ray", ray, "-o", "no-folder/hits.csv"}, "no-folder/hits.csv");
  refused({"cast", "one.obj", "--ray", ray, "-o", "folder"}, "folder");
  refused({"render", "one.obj", "--grid", "4x4", "--image", "no-folder/x.png"}, "no-folder/x.png");
  refused(with({"one.obj", "--ray", ray, "--lanes", "4", "--trace", "no-folder/x.fst"}),
          "no-folder/x.fst");
}

TEST_F(Cast, Timeout_IsStatus4AndKeepsTheOldFile) {
  write("one.obj", kOneTriangle);
  write("hits.csv", "old");
  refused({"cast", "one.obj", "--ray", "0,0,0,0,0,1", "--deadline", "10", "-o", "hits.csv"},
          "deadline of 10 cycles", 4);
  EXPECT_EQ(read("hits.csv"), "old");
  refused({"cast", "terrain", "--grid", "16x16", "--no-bvh", "--timeout", "0.01", "--no-bundle",
           "-o", "hits.csv"},
          "watchdog of 0.01 s", 4);
  EXPECT_EQ(read("hits.csv"), "old");
}

/// The signal comes as soon as the file exists. The command must then already be able to remove the
/// file.
TEST_F(Cast, Interrupt_LeavesNoFile) {
  for (int i = 0; i < 15; ++i) {
    const int signal = std::array{SIGINT, SIGTERM, SIGHUP}.at(i % 3);
    SCOPED_TRACE(fmt::format("signal {}, round {}", signal, i / 3));
    const pid_t child = start({"cast", "terrain:60,60,1", "--grid", "300x300", "-o", "hits.csv"});
    const bool began = wait_for_file(child);
    ::kill(child, signal);
    const Ran ran = finish(child);
    ASSERT_TRUE(began) << "ended before it wrote a file: " << ran.err;
    ASSERT_EQ(ran.status, 128 + signal) << ran.err;
    ASSERT_EQ(files(), Words{});
  }
}

/// Later, in the middle of the cast.
TEST_F(Cast, InterruptWhileCasting_LeavesNoFile) {
  const pid_t child = start({"cast", "terrain", "--grid", "1000x1000", "-o", "hits.csv"});
  const bool began = wait_for_file(child);
  ::usleep(500'000);
  ::kill(child, SIGTERM);
  const Ran ran = finish(child);
  ASSERT_TRUE(began) << "ended before it wrote a file: " << ran.err;
  EXPECT_EQ(ran.status, 128 + SIGTERM) << ran.err;
  EXPECT_EQ(files(), Words{});
}

/// A faulty card: without the comparison of the third edge, hits lie outside triangles. The cast
/// ends with status 3 and keeps no file. The printed command finds the same difference.
TEST_F(Cast, FaultyCard_IsFound) {
  const Words environment = faulty_card(folder_);
  const Ran ran = cde({"cast", "terrain:3,3,1", "--grid", "9x9", "--lanes", "4", "--algorithm",
                       "moller", "--json", "-o", "hits.csv", "--no-bundle"},
                      environment);
  EXPECT_EQ(ran.status, 3) << ran.err;
  EXPECT_FALSE(exists("hits.csv"));
  const auto j = nlohmann::json::parse(ran.out);
  EXPECT_EQ(j["records_compared"], 81);
  EXPECT_LT(j["records_matching"], 81);
  EXPECT_GT(j["records_matching"], 0);
  EXPECT_TRUE(has(ran.err, fmt::format("{} of 81 records match the reference",
                                       j["records_matching"].get<int>())));
  EXPECT_TRUE(has(ran.err, "differs from the reference"));
  std::smatch match;
  // A ray through an edge of two triangles hits the triangle that it should miss.
  ASSERT_TRUE(std::regex_search(ran.err, match, std::regex("differ in (.*)\n"))) << ran.err;
  EXPECT_EQ(match[1], "index") << ran.err;
  ASSERT_TRUE(std::regex_search(
      ran.err, match,
      std::regex("where     cycle ([0-9]+) \\(record read\\), lane ([0-9]+), row ([0-9]+)\n"
                 "(?:.*\n)*  ray ([0-9]+):")))
      << ran.err;
  EXPECT_GT(std::stoul(match[1]), 18u * 21) << "18 triangles times 21 rows of 4 rays come before";
  EXPECT_LT(std::stoul(match[1]), 5000u);
  EXPECT_EQ(4 * std::stoul(match[3]) + std::stoul(match[2]), std::stoul(match[4])) << ran.err;
  ASSERT_TRUE(std::regex_search(ran.err, match, std::regex("repeat with: cde (.*)"))) << ran.err;
  std::istringstream words(match[1]);
  Words again{std::istream_iterator<std::string>(words), {}};
  again.push_back("--no-bundle");
  EXPECT_EQ(cde(again, environment).status, 3);
  EXPECT_EQ(cde(again).status, 0) << "the correct card";
  Words unchecked = again;
  unchecked.push_back("--no-check");
  EXPECT_EQ(cde(unchecked, environment).status, 0);
}

/// Waves into a file with a size limit, from 100 bytes to all bytes except one: one error line and
/// no file. Verilator's writer reports no such error, and its own temporary file can end it with
/// SIGBUS.
TEST_F(Cast, WavesBeyondTheFileLimit_AreAnError) {
  write("one.obj", kOneTriangle);
  const Words words = {"cast", "one.obj", "--ray",     "0,0,0,0,0,1", "--lanes",
                       "4",    "--trace", "waves.fst", "--quiet"};
  ASSERT_EQ(cde(words).status, 0);
  const std::uint64_t whole = fs::file_size(folder_ / "waves.fst");
  fs::remove(folder_ / "waves.fst");
  for (const std::uint64_t bytes :
       {std::uint64_t{100}, whole / 16, whole / 4, whole / 2, whole - 1}) {
    SCOPED_TRACE(fmt::format("{} of {} bytes", bytes, whole));
    const FileLimit limit(bytes);
    const Ran ran = cde(words);
    EXPECT_EQ(ran.status, 2);
    EXPECT_EQ(ran.err, "cde: waves.fst: the waves are incomplete: File too large\n");
    EXPECT_EQ(files(), Words{"one.obj"});
  }
}

/// The same on a full disk: a small one in memory.
TEST_F(Cast, WavesOnAFullDisk_AreAnError) {
  write("one.obj", kOneTriangle);
  const auto cast_to = [&](const std::string& file) {
    return cde({"cast", "one.obj", "--ray", "0,0,0,0,0,1", "--lanes", "4", "--trace", file, "-q"});
  };
  ASSERT_EQ(cast_to("waves.fst").status, 0);
  const std::uint64_t whole = fs::file_size(folder_ / "waves.fst");
  const fs::path disk = folder_ / "disk";
  for (const std::uint64_t pages : {std::uint64_t{1}, whole / 4096 / 2, whole / 4096 * 2}) {
    SCOPED_TRACE(fmt::format("{} bytes for waves of {}", pages * 4096, whole));
    fs::create_directory(disk);
    if (::mount("tmpfs", disk.c_str(), "tmpfs", 0, fmt::format("size={}", pages * 4096).c_str()))
      GTEST_SKIP() << "cannot create a disk of this size: " << std::strerror(errno);
    const bool fits = pages * 4096 > whole;
    // Verilator's temporary files are also on this disk.
    const Ran ran = cde({"cast", "one.obj", "--ray", "0,0,0,0,0,1", "--lanes", "4", "--trace",
                         "disk/waves.fst", "-q"},
                        {"TMPDIR=" + disk.string()});
    const bool kept = fs::exists(disk / "waves.fst");
    const bool empty = fs::is_empty(disk);
    ::umount2(disk.c_str(), MNT_DETACH);
    EXPECT_EQ(ran.status, fits ? 0 : 2) << ran.err;
    EXPECT_EQ(
        ran.err,
        fits ? "" : "cde: disk/waves.fst: the waves are incomplete: No space left on device\n");
    EXPECT_EQ(kept, fits);
    EXPECT_EQ(empty, !fits) << "an incomplete file was left behind";
  }
}

class Doctor : public Cli {};

TEST_F(Doctor, CompleteInstallation_Passes) {
  const Ran ran = cde({"doctor", "--build"}, {"CDE_CACHE=" + (folder_ / "cache").string()});
  EXPECT_EQ(ran.status, 0) << ran.out << ran.err;
  EXPECT_FALSE(has(ran.out, "BAD"));
  for (const char* text :
       {"Verilator 5", "clang version", "host arithmetic: 204800 of 204800 records match",
        "rtl arithmetic: 12800 of 12800 records match"}) {
    EXPECT_TRUE(has(ran.out, text));
  }
}

TEST_F(Doctor, WithoutBuild_BuildsNothing) {
  const Ran ran = cde({"doctor"}, {"CDE_CACHE=" + (folder_ / "cache").string(),
                                   "CDE_MODELS=" + (folder_ / "none").string(),
                                   "CDE_MARCH=x86-64-v2"});  // no model exists for this processor
  EXPECT_EQ(ran.status, 0) << ran.out << ran.err;
  EXPECT_TRUE(has(ran.out,
                  "--   card, host host arithmetic: the card is not built; cde doctor "
                  "--build builds and checks it"));
  EXPECT_TRUE(has(ran.out, "--   card, rtl  rtl arithmetic: the card is not built"));
}

TEST_F(Doctor, Problems_AreNamedWithRemedies) {
  Ran ran = cde({"doctor"}, {"CDE_CLANG=no-such-compiler"});
  EXPECT_EQ(ran.status, 1);
  EXPECT_TRUE(has(ran.out, "no-such-compiler is missing"));
  EXPECT_TRUE(has(ran.out, "apt-get install clang"));
  // A home directory that cannot be created counts as none.
  const fs::path spare = fmt::format("/tmp/cde-{}", ::geteuid());
  for (const std::string home : {"/dev/null/home", "/proc/home"}) {
    ran = cde({"doctor"}, {"CDE_CACHE=", "XDG_CACHE_HOME=", "HOME=" + home});
    EXPECT_EQ(ran.err,
              fmt::format("cde: cache of simulation models {}/.cache/cde cannot be written; using "
                          "{} instead (set CDE_CACHE to use another folder)\n",
                          home, spare.string()));
    EXPECT_TRUE(has(ran.out, "model cache " + spare.string() + ":"));
  }
  std::error_code not_empty;
  fs::remove(spare, not_empty);
  ran = cde({"doctor"}, {"CDE_CACHE=/proc/no-folder"});
  EXPECT_EQ(ran.status, 1);
  EXPECT_TRUE(has(ran.out, "set CDE_CACHE"));
}

}  // namespace
}  // namespace cde::testing
