// SPDX-License-Identifier: Apache-2.0
// cde query.
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <random>
#include <regex>
#include <sstream>

#include "../has.hpp"
#include "cde/wave/wave_file.hpp"
#include "planted.hpp"
#include "query.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;

TEST_F(Query, AnySpelling_AnswersInOrder) {
  const Ran ran = query({"sphere-sphere"},
                        "# two spheres\n"
                        "0,0,0,1,1.5,0,0,1\n"
                        "\n"
                        "  0 0 0 1   5 0 0 0x1.8p0\r\n"
                        "0x00000000, 0X0, +0, 1e0, 0x1p1, -0, 0, 0x3f800000\n"
                        "   # and one more, without a line end\n"
                        "0\t0\t0\t1\t0\t-4\t0\t2");
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(ran.out, kHeader +
                         "1,0.5,0.75,0,0,1,0,0,\n"
                         "0,2.5,2.25,0,0,1,0,0,\n"
                         "1,0,1,0,0,1,-0,0,\n"
                         "0,1,0,-1.5,0,0,-1,0,\n");
  EXPECT_TRUE(has(ran.err, "4 of 4 answers match the reference"));
}

/// The form in which tests and `cde run` print a pair.
TEST_F(Query, BarBetweenAAndB_IsAccepted) {
  const Ran ran = query({"sphere-sphere", "-q"},
                        "0,0,0,1 | 1.5,0,0,1\n"
                        "0x00000000 0x00000000 0x00000000 0x3f800000 | 0x3fc00000 0 0 1\n"
                        "0,0,0,1|1.5,0,0,1\n"
                        "0,0,0 | 1,1.5,0,0,1\n"
                        "0,0,0,1 | 1.5,0 | 0,1\n");
  const std::string answer = "1,0.5,0.75,0,0,1,0,0,\n",
                    none = "0,nan,nan,nan,nan,nan,nan,nan,malformed\n";
  EXPECT_EQ(ran.out, kHeader + answer + answer + answer + none + none);
  EXPECT_EQ(ran.status, 2);
  EXPECT_EQ(ran.err.find("cde: line 4: 3 words before the |, of 8 in all; A has 4\n"
                         "cde: line 5, column 17: a second |; expected one, between A and B\n"),
            0u)
      << ran.err;
  const Ran ray = query({"ray-triangle", "-q"},
                        "0,0,2,0,0,-1 | -1,-1,0,1,-1,0,0,1,0\n"
                        "0,0,2,0,0,-1,0,1 | -1,-1,0,1,-1,0,0,1,0\n");
  EXPECT_EQ(ray.status, 0) << ray.err;
  EXPECT_EQ(ray.out, kHeader + "1,2,0,0,0,,,,\n0,inf,0,0,0,,,,\n");
}

/// A failing builder prints its cause first, then much else.
TEST_F(Query, FailedBuild_NamesItsCauseAndLog) {
  std::filesystem::create_directories(folder_ / "share/verilator");
  std::filesystem::create_directories(folder_ / "share/rtl");
  const std::string builder = write("share/verilator/model_builder", R"(#!/bin/bash
[[ $1 == hash ]] && { echo 0123456789abcdef 0123456789abcdef01234567; exit; }
echo "compiling a great deal" >&2
echo "%Error: lane.sv:12:3: no such signal" >&2
echo "   12 |   signul <= 0;" >&2
for k in {1..40}; do echo "... included from file $k" >&2; done
exit 1
)");
  std::filesystem::permissions(folder_ / builder, std::filesystem::perms::owner_all);
  const Ran ran = query({"sphere-sphere", "-q"}, "0,0,0,1,2,0,0,1\n",
                        {"CDE_MODELS=/nowhere", "CDE_CACHE=" + (folder_ / "cache").string(),
                         "CDE_SHARE=" + (folder_ / "share").string()});
  EXPECT_EQ(ran.status, 2) << ran.err;
  EXPECT_TRUE(
      has(ran.err, "failed:\n%Error: lane.sv:12:3: no such signal\n   12 |   signul <= 0;\n"));
  EXPECT_FALSE(has(ran.err, "included from"));
  const std::string log = "cache/0123456789abcdef01234567.log";
  EXPECT_TRUE(has(ran.err, log));
  ASSERT_TRUE(exists(log));
  EXPECT_TRUE(has(read(log), "included from file 40"));
}

/// A header without answers would look like a result.
TEST_F(Query, WithoutAnswers_NothingIsWritten) {
  const std::string cache = "CDE_CACHE=" + (folder_ / "cache").string();
  const Ran unbuilt = query({"sphere-sphere", "-q"}, "0,0,0,1,2,0,0,1\n",
                            {"CDE_MODELS=/nowhere", cache, "CDE_SHARE=/nowhere"});
  EXPECT_EQ(unbuilt.status, 2) << unbuilt.err;
  EXPECT_EQ(unbuilt.out, "");
  const Ran folder = shell("\"$CDE\" query sphere-sphere -q < .");
  EXPECT_EQ(folder.status, 2) << folder.err;
  EXPECT_EQ(folder.out, "");
  const Ran too_long = query({"sphere-sphere", "-q"}, std::string(std::size_t{5} << 20, '1'));
  EXPECT_EQ(too_long.status, 2) << too_long.err;
  EXPECT_EQ(too_long.out, "");
}

TEST_F(Query, EmptyInput_GivesAnEmptyTable) {
  const Ran ran = query({"sphere-sphere", "-q"}, "");
  EXPECT_EQ(ran.status, 0);
  EXPECT_EQ(ran.out, kHeader);
  EXPECT_EQ(ran.err, "");
}

TEST_F(Query, RaysOfSixAndEightWords_AreAccepted) {
  const std::string triangle = ",-1,-1,0,1,-1,0,0,1,0\n";
  const Ran ran = query({"ray-triangle"}, "0,0,2,0,0,-1" + triangle +          // the whole ray
                                              "0,0,2,0,0,-1,0,1" + triangle +  // ends before it
                                              "0,0,2,0,0,-1,0,inf" + triangle + "0,0,-2,0,0,-1" +
                                              triangle +  // the triangle is behind
                                              "0,0,-2,0,0,-1,-inf,inf" + triangle);
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(ran.out, kHeader +
                         "1,2,0,0,0,,,,\n"
                         "0,inf,0,0,0,,,,\n"
                         "1,2,0,0,0,,,,\n"
                         "0,inf,0,0,0,,,,\n"
                         "1,-2,0,0,0,,,,\n");
}

/// A triangle without area. The pipe without the box rule reports a hit 3.4 away from it.
TEST_F(Query, BoxRule_MissesTrianglesWithoutArea) {
  const std::string line = "0.2 2.8 -2.3 -0.1 -0.9 0.7 0.1 0.7 -0.4 0.2 -0.4 0.9 0.2 -0.4 0.9\n";
  Ran ran = query({"ray-triangle", "--algorithm", "pluecker"}, line);
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(ran.out, kHeader + "0,inf,0,0,0,,,,\n");
  EXPECT_TRUE(has(ran.err, "pluecker, box rule"));
  EXPECT_EQ(query({"ray-triangle", "--algorithm", "pluecker", "--box", "-q"}, line).out, ran.out);
  ran = query({"ray-triangle", "--algorithm", "pluecker", "--no-box"}, line);
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(ran.out.substr(kHeader.size(), 4), "1,0,") << ran.out;
  EXPECT_FALSE(has(ran.err, "box rule"));
  refused({"sphere-sphere", "--box"},
          "--box cannot be combined with sphere-sphere; expected a pair with a triangle");
}

/// T and CP of a hit are finite, and T is never -0.
TEST_F(Query, HitsOfRays_AreFinite) {
  const Ran ran = query({"ray-triangle", "-q"},
                        "0 0 20 0 0 -1e-38 -1 -1 0 2 -1 0 -1 2 0\n"
                        "0 0 20 0 0 -0x1p-34 -1 -1 0 2 -1 0 -1 2 0\n"
                        "0 0 0 0 0 -1 -1 -1 0 2 -1 0 -1 2 0\n"
                        "0 0 0 0 0 1 -1 -1 0 2 -1 0 -1 2 0\n");
  EXPECT_EQ(ran.out, kHeader +
                         "0,nan,nan,nan,nan,,,,bad\n1,343597400000,0,0,0,,,,\n1,0,0,0,0,,,,\n"
                         "1,0,0,0,0,,,,\n");
}

TEST_F(Query, MalformedLines_AreNamedAndOthersAnswered) {
  const std::string good = "0,0,0,1,1.5,0,0,1\n";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"0,0,abc,1,1,0,0,1", "line 2, word 3: 'abc' is not a number"},
      {"0,0,0,1,1,0,0,1x", "line 2, word 8: '1x' is not a number"},
      {"0,,0,1,1,0,0,1", "line 2, word 2: '' is not a number"},
      {"0,0,0,1,1,0,0,", "line 2, word 8: '' is not a number"},
      {"--1,0,0,1,1,0,0,1", "line 2, word 1: '--1' is not a number"},
      {"0x,0,0,1,1,0,0,1", "line 2, word 1: '0x' is not a number"},
      {"-0x3f800000,0,0,1,1,0,0,1",
       "line 2, word 1: '-0x3f800000' is not a number: 0x and digits are the bits of a word"},
      {"0x100000000,0,0,1,1,0,0,1", "line 2, word 1: '0x100000000' has more than the 32 bits"},
      {"0x11111111111111111,0,0,1,1,0,0,1",
       "line 2, word 1: '0x11111111111111111' has more than the 32 bits of fp32"},
      {"3.5e38,0,0,1,1,0,0,1", "line 2, word 1: '3.5e38' is beyond the largest fp32 number"},
      {"1e999,0,0,1,1,0,0,1", "line 2, word 1: '1e999' is beyond the largest fp32 number"},
      {"0,0,0,1,1,0,0", "line 2: 7 words, must be 8 (4 of A, 4 of B)"},
      {"0,0,0,1,1,0,0,1,1", "line 2: 9 words, must be 8 (4 of A, 4 of B)"},
      {",", "line 2: 2 words, must be 8"},
      {std::string("0\0,0,0,1,1,0,0,1", 16), "line 2, word 1: '0\\x00' is not a number"}};
  for (const auto& [line, message] : cases) {
    const Ran ran = query({"sphere-sphere"}, fmt::format("{0}{1}\n{0}", good, line));
    SCOPED_TRACE(line);
    EXPECT_EQ(ran.status, 2);
    EXPECT_TRUE(has(ran.err, "cde: " + message));
    EXPECT_EQ(ran.out, kHeader +
                           "1,0.5,0.75,0,0,1,0,0,\n"
                           "0,nan,nan,nan,nan,nan,nan,nan,malformed\n"
                           "1,0.5,0.75,0,0,1,0,0,\n");
    EXPECT_TRUE(has(ran.err, "2, 0 bad, and 1 malformed line\n"));
  }
  const Ran ray = query({"ray-triangle", "--bits", "-q"}, "0,0,2,0,0,-1,0,1,1,1,1,1,1,1,1,1\n");
  EXPECT_EQ(ray.status, 2);
  EXPECT_EQ(ray.err, "cde: line 1: 16 words, must be 15 or 17 (6 or 8 of A, 9 of B)\n");
  EXPECT_EQ(ray.out, kHeader + "0,0x7fc00000,0x7fc00000,0x7fc00000,0x7fc00000,,,,malformed\n");
}

TEST_F(Query, BadOperands_AreNamedAndFlagged) {
  struct BadPair {
    const char *pair, *line, *message;
  };
  const std::array cases = {
      BadPair{"sphere-sphere", "0,0,0,1,0,0,0,-2", "line 1: sphere B: radius is -2, must be > 0"},
      BadPair{"sphere-sphere", "0,0,0,-0,0,0,0,1", "line 1: sphere A: radius is -0, must be > 0"},
      BadPair{"sphere-sphere", "0,inf,0,1,0,0,0,1",
              "line 1: sphere A: center.y is inf, must be finite"},
      BadPair{"sphere-sphere", "0,0,0,1,0,0,0x7f800001,1",
              "line 1: sphere B: center.z is nan, must be finite"},
      BadPair{"ray-triangle", "0,0,0,0,-0,0,1,2,3,4,5,6,7,8,9",
              "line 1: ray A: direction is zero, must have a length"},
      BadPair{"ray-triangle", "0,0,0,0,0,1,nan,1,1,2,3,4,5,6,7,8,9",
              "line 1: ray A: tmin is nan, must be a number or infinite"},
      BadPair{"ray-triangle", "0,0,0,0,0,1,1,2,3,4,5,6,7,8,-inf",
              "line 1: triangle B: v2.z is -inf, must be finite"}};
  for (const BadPair& bad : cases) {
    SCOPED_TRACE(bad.line);
    const bool ray = std::string(bad.pair) == "ray-triangle";
    const Ran ran = query({bad.pair, "-q"}, std::string(bad.line) + "\n# next\n" +
                                                (ray ? "0,0,2,0,0,-1,-1,-1,0,1,-1,0,0,1,0\n"
                                                     : "0,0,0,1,1.5,0,0,1\n"));
    EXPECT_EQ(ran.status, 2);
    EXPECT_EQ(ran.err, std::string("cde: ") + bad.message + "\n");
    EXPECT_EQ(ran.out,
              kHeader + (ray ? "0,nan,nan,nan,nan,,,,bad\n1,2,0,0,0,,,,\n"
                             : "0,nan,nan,nan,nan,nan,nan,nan,bad\n1,0.5,0.75,0,0,1,0,0,\n"));
  }
}

// A box deep below a plane: separated from the surface, inside the half-space.
TEST_F(Query, HalfSpaceOption_MakesThePlaneSolid) {
  const std::string below = "0,0,-5,1,1,1,1,0,0,0,1,0,0,0,1,0,0,1,0\n";
  EXPECT_EQ(query({"obb-plane", "-q"}, below).out, kHeader + "0,4,0,0,-2,0,0,1,\n");
  EXPECT_EQ(query({"obb-plane", "--half-space", "-q"}, below).out,
            kHeader + "1,6,0,0,-3,-0,-0,-1,\n");
}

TEST_F(Query, Messages_KeepTheOrderOfLines) {
  const Ran ran =
      query({"sphere-sphere", "-q"}, "0,0,0,-1,0,0,0,1\n0,0,0,x,0,0,0,1\n0,0,0,1,0,0,0,-1\n1\n");
  const auto lines = lines_of(ran.err);
  ASSERT_EQ(lines.size(), 4u) << ran.err;
  for (std::size_t i = 0; i < lines.size(); ++i)
    EXPECT_TRUE(lines[i].starts_with(fmt::format("cde: line {}", i + 1))) << ran.err;
}

TEST_F(Query, NoPairs_PrintNoRate) {
  const Ran ran = query({"sphere-sphere"}, "");
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(ran.out, "F,T,CPx,CPy,CPz,nx,ny,nz,flags\n");
  EXPECT_FALSE(has(ran.err, "nan"));
  EXPECT_TRUE(has(ran.err, "0 of 0 answers match"));
}

TEST_F(Query, WrongUsage_IsRefused) {
  refused({"teapot"}, "no pair 'teapot'; there are: ray-triangle, obb-obb");
  refused({"ray-triangle", "--algorithm", "mollar"}, "--algorithm is 'mollar'; it must be moller");
  refused({"sphere-sphere", "--algorithm", "badouel"},
          "--algorithm cannot be combined with sphere-sphere; expected ray-triangle");
  refused({"sphere-sphere", "--half-space"}, "--half-space cannot be combined with sphere-sphere");
  refused({"sphere-sphere", "--arith", "gates"}, "--arith is 'gates'; it must be host or rtl");
  refused({"sphere-sphere", "--sat-interval", "3"},
          "--sat-interval cannot be combined with sphere-sphere");
  refused({"obb-obb", "--sat-interval", "2"}, "--sat-interval is '2'; it must be 1 or 3");
  refused({"sphere-sphere", "--lanes", "0"}, "--lanes is '0'; it must be a whole number, 1 to 256");
  refused({"sphere-sphere", "--lanes", "257"},
          "--lanes is '257'; it must be a whole number, 1 to 256");
  refused({"sphere-sphere", "--format", "fp7"}, "--format is 'fp7'");
  refused({"sphere-sphere", "--format", "e4m3"},
          "--format is 'e4m3'; it must be fp16, bf16, tf32, fp24, fp32 or fp64");
  refused({"sphere-sphere", "--iterations", "4,8,8"},
          "--iterations cannot be combined with sphere-sphere");
  refused({"cylinder-cylinder", "--iterations", "4,8"},
          "--iterations is '4,8'; it must be M,K1,K2");
  refused({"cylinder-cylinder", "--iterations", "0,8,8"},
          "iterations: M is 0, expected 4, 8 or 16");
  refused({"cylinder-cylinder", "--iterations", "5,8,8"},
          "iterations: M is 5, expected 4, 8 or 16");
  refused({"cylinder-cylinder", "--iterations", "4,8,65"},
          "iterations: K2 is 65, expected 0 to 64");
  refused({"cylinder-cylinder", "--iterations", "4,8,8,"},
          "--iterations is '4,8,8,'; it must be M,K1,K2");
  refused({"cylinder-cylinder", "--iterations", "13"},
          "--iterations is 13; cylinder-cylinder needs 14 to 334 evaluations");
  refused({"obb-cylinder", "--iterations", "29"},
          "--iterations is 29; obb-cylinder needs 30 to 258 evaluations");
  refused({"obb-cylinder", "--iterations", "259"},
          "--iterations is 259; obb-cylinder needs 30 to 258 evaluations");
  refused({"triangle-cylinder", "--iterations", "99999"},
          "--iterations is 99999; triangle-cylinder needs 26 to 254 evaluations");
  refused({}, "cde query needs PAIR");
}

TEST_F(Query, Iterations_SetTheCyclesOfACylinderPair) {
  const std::string pair = "0,0,0,0,0,1,1,0.5,2,0.3,0.1,0.6,0,0.8,1,0.5\n";
  const auto cycles = [&](const Words& iterations) {
    Words words = {"cylinder-cylinder", "--json"};
    words.insert(words.end(), iterations.begin(), iterations.end());
    const Ran ran = query(words, pair);
    EXPECT_EQ(ran.status, 0) << ran.err;
    const auto json = nlohmann::json::parse(lines_of(ran.out).back());
    EXPECT_EQ(json["records_matching"], 1);
    return json["device_cycles"].get<int>();
  };
  const int whole = cycles({}), none = cycles({"--iterations", "4,0,0"});
  EXPECT_EQ(cycles({"--iterations", "8,8,8"}), whole);
  // 54 and 14 evaluations, plus 9 loops each for the witness points: one more loop costs one trip
  // through the pipeline.
  const int loop = (whole - none) / 40;
  EXPECT_EQ(whole - none, 40 * loop);
  EXPECT_EQ(cycles({"--iterations", "14"}), none);
  EXPECT_EQ(cycles({"--iterations", "54"}), whole);
  EXPECT_EQ(cycles({"--iterations", "58"}), whole + 3 * loop)
      << "K2 takes three of four evaluations";
}

// ---- Complete runs ----

TEST_F(Query, CandidateAxesOfLongWords_UseOneLane) {
  const std::string box = "1,1,1,1,0,0,0,1,0,0,0,1";  // unit half extents, not rotated
  const Ran ran = query({"obb-obb", "--format", "fp64", "--json"},
                        "0,0,0," + box + ",3.5,0,0," + box + "\n" +  //
                            "0,0,0," + box + ",1.5,0.25,0," + box + "\n");
  ASSERT_EQ(ran.status, 0) << ran.err;
  const auto json = nlohmann::json::parse(lines_of(ran.out).back());
  EXPECT_EQ(json["lanes"], 1) << "clang takes minutes to build more lanes";
  EXPECT_EQ(json["records_matching"], 2);
  const auto lines = lines_of(ran.out);
  ASSERT_EQ(lines.size(), 4u) << "the last line is the summary";
  EXPECT_TRUE(lines[1].starts_with("0,1.5,")) << lines[1];
  EXPECT_TRUE(lines[2].starts_with("1,0.5,")) << lines[2];
}

TEST_F(Query, BothArithmetics_GiveTheSameAnswers) {
  std::mt19937_64 random(3);
  std::string input;
  for (int i = 0; i < 1000; ++i)
    for (int k = 0; k < 8; ++k)
      input += fmt::format("{:#x}{}", random() & 0xffffffff, k == 7 ? '\n' : ' ');
  const Ran host = query({"sphere-sphere", "--bits", "-q"}, input);
  const Ran rtl = query({"sphere-sphere", "--bits", "-q", "--arith", "rtl"}, input);
  EXPECT_EQ(host.status, 2) << "random words have negative radii";
  EXPECT_EQ(rtl.out, host.out);
  EXPECT_EQ(rtl.err, host.err);
}

TEST_F(Query, MillionPairs_AreAnsweredInOrder) {
  constexpr int kPairs = 1'000'000;
  std::string input;
  input.reserve(20 * kPairs);
  for (int i = 0; i < kPairs; ++i)
    fmt::format_to(std::back_inserter(input), "0,0,0,1,{},0,0,1\n", i + 2);
  const Ran ran = query({"sphere-sphere", "--json"}, input);
  ASSERT_EQ(ran.status, 0) << ran.err.substr(0, 1000);
  std::istringstream lines(ran.out);
  std::string line;
  std::getline(lines, line);
  int i = 0;
  for (; std::getline(lines, line) && !line.starts_with('{'); ++i)
    ASSERT_TRUE(line.starts_with(fmt::format("{},{},", i == 0 ? 1 : 0, i))) << i << ": " << line;
  EXPECT_EQ(i, kPairs);
  const auto j = nlohmann::json::parse(lines_of(ran.out).back());
  EXPECT_EQ(j["pair"], "sphere-sphere");
  EXPECT_EQ(j["format"], "fp32");
  EXPECT_EQ(j["tests"], kPairs);
  EXPECT_EQ(j["records_matching"], kPairs);
  EXPECT_EQ(j["hits"], 1);
  EXPECT_EQ(j["bad_pairs"], 0);
  EXPECT_EQ(j["malformed_lines"], 0);
  EXPECT_GE(j["device_cycles"], kPairs / 8);
}

/// The output of a running child so far.
std::string stdout_of(pid_t child) {
  const fs::path link = fmt::format("/proc/{}/fd/1", child);
  std::error_code none;
  if (fs::read_symlink(link, none).filename() != "out") return {};  // not redirected yet
  std::stringstream text;
  text << std::ifstream(link).rdbuf();
  return text.str();
}

/// A line is answered as soon as it is complete, not when the input ends.
TEST_F(Query, OpenInput_IsAnsweredLineByLine) {
  int in[2];
  ASSERT_EQ(::pipe(in), 0);
  const int own = ::dup(STDIN_FILENO);
  ::dup2(in[0], STDIN_FILENO);
  ::close(in[0]);
  ::fcntl(in[1], F_SETFD, FD_CLOEXEC);
  const pid_t child = start({"query", "sphere-sphere", "-q"});
  ::dup2(own, STDIN_FILENO);
  ::close(own);
  std::string seen;
  for (int tenths = 0; tenths < 1200 && seen.empty(); ++tenths) {
    ::usleep(100'000);
    seen = stdout_of(child);
  }
  EXPECT_EQ(seen, kHeader) << "the header must come before the first input line";
  const std::string line = "0,0,0,1,2,0,0,1\n0,0,0";  // and a part of a line
  ASSERT_EQ(::write(in[1], line.data(), line.size()), static_cast<ssize_t>(line.size()));
  for (int tenths = 0; tenths < 1200 && lines_of(seen).size() < 2; ++tenths) {
    ::usleep(100'000);
    seen = stdout_of(child);
  }
  EXPECT_EQ(seen, kHeader + "1,0,1,0,0,1,0,0,\n");
  const std::string rest = ",1,4,0,0,1\n";
  EXPECT_EQ(::write(in[1], rest.data(), rest.size()), static_cast<ssize_t>(rest.size()));
  ::close(in[1]);
  const Ran ran = finish(child);
  EXPECT_EQ(ran.status, 0);
  EXPECT_EQ(ran.out, kHeader + "1,0,1,0,0,1,0,0,\n0,2,2,0,0,1,0,0,\n");
}

/// A card whose sphere-sphere pipe puts CP on the wrong side. The query ends with status 3, and the
/// printed command finds the same difference.
TEST_F(Query, FaultyPipe_IsFound) {
  const Planted fault(folder_, "rtl/pipes/sphere_sphere.sv", "`DF_VADD(cp, a_c, offset)",
                      "`DF_VSUB(cp, a_c, offset)");
  Words environment = fault.environment();
  environment.push_back("CDE_CACHE=" + (folder_ / "cache").string());

  const Words words = {"sphere-sphere", "--lanes", "2", "--no-bundle"};
  const std::string input = "# the first has CP = cA\n0,0,0,1,0,0,0,1\n\n0,0,0,1,1.5,0,0,1\n";
  const Ran ran = query(words, input, environment);
  EXPECT_EQ(ran.status, 3) << ran.err;
  EXPECT_EQ(ran.out, "") << "no answer is right, so neither answers nor header are written";
  EXPECT_TRUE(has(ran.err, "line 4: the card's answer differs from the reference"));
  EXPECT_TRUE(has(ran.err, "CP -0x1.8p-1,0x0p+0,0x0p+0"));
  // The second pair of the first row, which leaves the pipe after its 11 cycles.
  EXPECT_TRUE(has(ran.err, "\n  differ in CPx\n  where     cycle 11, lane 1, row 0\n"));
  std::string later = input;
  for (int i = 0; i < 4; ++i) later.insert(0, "0,0,0,1,0,0,0,1\n");
  const Ran third_row = query(words, later, environment);
  EXPECT_TRUE(has(third_row.err, "line 8: "));
  EXPECT_TRUE(has(third_row.err, "\n  where     cycle 13, lane 1, row 2\n"));
  std::smatch match;
  ASSERT_TRUE(std::regex_search(
      ran.err, match, std::regex("repeat with: yes (\\S*) \\| head -n (\\d+) \\| cde query (.*)")))
      << ran.err;
  EXPECT_EQ(match[2], "2");
  std::istringstream in(match[3]);
  Words again{std::istream_iterator<std::string>(in), {}};
  again.push_back("--no-bundle");
  const std::string pairs = match[1].str() + "\n" + match[1].str() + "\n";
  EXPECT_EQ(query(again, pairs, environment).status, 3);
  EXPECT_EQ(query({"sphere-sphere"}, pairs).status, 0) << "the correct pipe";
  Words going = {"sphere-sphere", "--lanes", "2", "-k", "--json"};
  for (const bool distributed : {false, true}) {
    if (distributed) going.insert(going.end(), {"--resume", (folder_ / "journal").string()});
    const Ran all = query(going, input + "0,0,0,1,0,0,0,-1\n", environment);
    EXPECT_EQ(all.status, 3) << "takes precedence over the status of a bad pair";
    ASSERT_EQ(lines_of(all.out).size(), 5u) << all.out;
    EXPECT_EQ(lines_of(all.out)[1], "1,2,0,0,0,0,0,1,") << "the correct answer";
    EXPECT_EQ(lines_of(all.out)[2], "1,0.5,-0.75,0,0,1,0,0,differs");
    EXPECT_TRUE(lines_of(all.out)[3].ends_with(",bad")) << all.out;
    const auto summary = nlohmann::json::parse(lines_of(all.out)[4]);
    EXPECT_EQ(summary.at("records_compared"), 3);
    EXPECT_EQ(summary.at("records_matching"), 2);
    EXPECT_TRUE(has(all.err,
                    "cde: line 4: the card's answer differs from the reference in CPx\n"
                    "repeat with: " +
                        match[0].str().substr(std::string("repeat with: ").size()) + "\n"));
    EXPECT_FALSE(fs::exists("cde-failure")) << "only the command that repeats a failure packs it";
  }
  std::string many;
  for (int i = 0; i < 103; ++i) many += "0,0,0,1,1.5,0,0,1\n";
  const Ran capped = query({"sphere-sphere", "--lanes", "2", "-k", "-q"}, many, environment);
  EXPECT_EQ(capped.status, 3);
  EXPECT_TRUE(has(capped.err, "cde: line 100: the card's"));
  EXPECT_FALSE(has(capped.err, "cde: line 101: the card's"));
  EXPECT_TRUE(has(capped.err, "cde: 3 more answers differ from the reference\n"));
  Words unchecked = words;
  unchecked.emplace_back("--no-check");
  const Ran wrong_answers = query(unchecked, input, environment);
  EXPECT_EQ(wrong_answers.status, 0);
  EXPECT_EQ(wrong_answers.out, kHeader + "1,2,0,0,0,0,0,1,\n1,0.5,-0.75,0,0,1,0,0,\n");
}

// ---- Waves ----

/// Words of a port, [word][lane], at a time in the waves.
class Ports {
 public:
  explicit Ports(fs::path file) : file_(std::move(file)), signals_(wave::signals(file_)) {}
  [[nodiscard]] std::uint64_t at(const std::string& port, std::uint64_t time) {
    auto& values = seen_[port];
    if (values.empty()) {
      const auto signal = signals_.find("pair_unit." + port);
      if (signal == signals_.end()) throw std::runtime_error("no signal " + port);
      values = wave::changes(file_, signal->second);
    }
    auto value = values.upper_bound(time);
    if (value == values.begin()) throw std::runtime_error(port + " has no value yet");
    return std::stoull((--value)->second, nullptr, 2);
  }
  [[nodiscard]] float word(const std::string& port, std::uint64_t time) {
    return std::bit_cast<float>(static_cast<std::uint32_t>(at(port, time)));
  }

 private:
  fs::path file_;
  std::map<std::string, unsigned> signals_;
  std::map<std::string, std::map<std::uint64_t, std::string>> seen_;
};

/// Each row shows its operands in the cycle in which it enters, and its results one pipe latency
/// later. docs/reference/pairs.md states these times.
TEST_F(Query, Waves_ShowOperandsAndResults) {
  constexpr unsigned kLanes = 8, kLatency = 11, kRows = 3;
  std::string text;
  for (unsigned i = 0; i < kLanes * kRows; ++i) text += fmt::format("0,0,0,1,{},0,0,1\n", 3 + i);
  const Ran ran = query({"sphere-sphere", "--trace", "w.fst"}, text);
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(ran.out, query({"sphere-sphere"}, text).out);
  EXPECT_EQ(files(), (Words{"stdin", "w.fst"}));
  Ports ports(folder_ / "w.fst");
  for (unsigned row = 0; row < kRows; ++row) {
    const std::uint64_t in = 2 * row + 9, out = in + 2 * (kLatency - 1);
    SCOPED_TRACE(fmt::format("row {}, times {} and {}", row, in, out));
    EXPECT_EQ(ports.at("valid_i", in), 1u);
    EXPECT_EQ(ports.at("tag_i", in), row);
    EXPECT_EQ(ports.at("valid_o", out), 1u);
    EXPECT_EQ(ports.at("tag_o", out), row);
    for (unsigned lane = 0; lane < kLanes; ++lane) {
      const auto i = static_cast<float>(kLanes * row + lane);
      EXPECT_EQ(ports.word(fmt::format("b_i[0][{}]", lane), in), 3 + i);
      EXPECT_EQ(ports.word(fmt::format("t_o[{}]", lane), out), 1 + i);
      EXPECT_EQ(ports.word(fmt::format("cp_o[0][{}]", lane), out), (3 + i) / 2);
      EXPECT_EQ(ports.at(fmt::format("f_o[{}]", lane), out), 0u);
    }
  }
  EXPECT_EQ(ports.at("valid_o", 9 + 2 * (kLatency - 1) - 2), 0u) << "before the first row";
  EXPECT_EQ(ports.at("valid_o", 9 + 2 * (kLatency - 1 + kRows)), 0u) << "after the last row";
}

/// Answers are written when all pairs are known. Their number and the file are checked first.
TEST_F(Query, Waves_AreCompleteOrAnError) {
  const std::string pair = "0,0,0,1,3,0,0,1\n";
  std::string many = "# a line that is none\n";
  std::mt19937 random(7);
  for (int i = 0; i < 4096; ++i)
    many += fmt::format("{},{},{},1,3,0,0,1\n", random() % 997, random() % 997, random() % 997);
  const Words traced = {"sphere-sphere", "-q", "--trace", "w.fst"};
  Ran ran = query(traced, many);
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(lines_of(ran.out).size(), 4097u);
  const std::uint64_t whole = fs::file_size(folder_ / "w.fst");
  fs::remove(folder_ / "w.fst");
  ran = query(traced, many + pair);
  EXPECT_EQ(ran.status, 2);
  EXPECT_EQ(ran.out, "");
  EXPECT_EQ(ran.err, "cde: line 4098: --trace takes at most 4096 pairs\n");
  EXPECT_FALSE(exists("w.fst"));
  {
    ASSERT_GT(whole / 2, many.size()) << "the limit must apply to the waves, not to stdin";
    const FileLimit limit(whole / 2);
    ran = query(traced, many);
    EXPECT_EQ(ran.status, 2);
    EXPECT_EQ(ran.err, "cde: w.fst: the waves are incomplete: File too large\n");
    EXPECT_FALSE(exists("w.fst"));
  }
  ran = query({"sphere-sphere", "-q", "--trace", "w.fst"}, "");
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(wave::signals(folder_ / "w.fst").count("pair_unit.valid_i"));
  refused({"sphere-sphere", "--trace", "none/w.fst"}, "none");
  refused({"sphere-sphere", "--trace", "-"}, "--trace and the answers both write to stdout");
  fs::create_hard_link(folder_ / "stdin", folder_ / "stdin.fst");
  refused({"sphere-sphere", "--trace", "stdin.fst"}, "which stdin reads");
}

}  // namespace
}  // namespace cde::testing
