// SPDX-License-Identifier: Apache-2.0
// --trace-window, --trace-scope and a signal while waves are written.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <signal.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "../has.hpp"
#include "run_cde.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

class TraceWindow : public Cli {
 protected:
  /// What `cde wave info` says of a file.
  nlohmann::json info(const std::string& file) {
    const Ran ran = cde({"wave", "info", file, "--json"});
    EXPECT_EQ(ran.status, 0) << ran.err;
    return nlohmann::json::parse(ran.out, nullptr, false);
  }
};

/// 64 pairs in 8 lanes; both halves of a clock are times of a unit's waves.
TEST_F(TraceWindow, OfAQueryIsItsClocks) {
  std::string text;
  for (int i = 0; i < 64; ++i) text += fmt::format("0,0,0,1,{},0,0,1\n", 3 + i);
  write("pairs", text);
  const auto traced = [&](const Words& more) {
    const Ran ran = shell(fmt::format("\"$CDE\" query sphere-sphere -q --trace w.fst {} < pairs",
                                      fmt::join(more, " ")));
    EXPECT_EQ(ran.status, 0) << ran.err;
    return std::pair(info("w.fst"), ran.out);
  };
  const auto [all, answers] = traced({});
  const auto start = all["from"].get<std::uint64_t>() / 2 * 2;
  const auto [window, same] = traced({"--trace-window", "2:5"});
  EXPECT_EQ(same, answers);
  EXPECT_EQ(window["from"], start + 2 * 2);
  EXPECT_EQ(window["to"], start + 2 * 5 + 1);
  EXPECT_EQ(window["signals"], all["signals"]);
  EXPECT_EQ(traced({"--trace-window", ":5"}).first["to"], start + 2 * 5 + 1);
  EXPECT_EQ(traced({"--trace-window", "5:"}).first["from"], start + 2 * 5);
  EXPECT_EQ(traced({"--trace-window", "5:"}).first["to"], all["to"]);
}

TEST_F(TraceWindow, ThatTheRunDoesNotComeToIsSaid) {
  const Ran ran = shell(
      "echo '0,0,0,1,3,0,0,1' | \"$CDE\" query sphere-sphere -q --trace w.fst --trace-window "
      "9000:");
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(has(ran.err, "w.fst has no clock of the run"));
}

TEST_F(TraceWindow, OfACastIsItsClocks) {
  const auto traced = [&](const Words& more) {
    Words words = {"cast", "terrain:3,3,1", "--grid", "4x4",     "--lanes",
                   "4",    "--exact-card",  "-q",     "--trace", "w.fst"};
    words.insert(words.end(), more.begin(), more.end());
    const Ran ran = cde(words);
    EXPECT_EQ(ran.status, 0) << ran.err;
    return info("w.fst");
  };
  constexpr std::uint64_t kClock = 10000;  // ps, of 100 MHz
  const nlohmann::json all = traced({}), window = traced({"--trace-window", "20:29"});
  const auto from = window["from"].get<std::uint64_t>(), to = window["to"].get<std::uint64_t>();
  EXPECT_EQ(window["cycles"], 10);
  EXPECT_GE(from, all["from"].get<std::uint64_t>() + 19 * kClock);
  EXPECT_LT(to - from, 10 * kClock);
  EXPECT_LT(window["file_bytes"], all["file_bytes"]);
}

/// Ports of what is inside are other names of signals around it, which are not written.
TEST_F(TraceWindow, AScopeIsWrittenAsWithAllAroundIt) {
  const auto traced = [&](const std::string& file, const Words& more) {
    Words words = {"cast", "terrain:3,3,1", "--grid", "4x4",     "--lanes",
                   "4",    "--exact-card",  "-q",     "--trace", file};
    words.insert(words.end(), more.begin(), more.end());
    const Ran ran = cde(words);
    EXPECT_EQ(ran.status, 0) << ran.err;
    return info(file);
  };
  const nlohmann::json all = traced("all.fst", {});
  const auto listed = [&](const std::string& glob) {
    const Ran ran = cde({"wave", "ls", "all.fst", glob, "--json", "--max", "0"});
    EXPECT_EQ(ran.status, 0) << ran.err;
    return nlohmann::json::parse(ran.out)["signals"].size();
  };
  const std::vector<Words> wanted = {
      {"control"}, {"engine.primaries"}, {"*.row_i"}, {"fifo", "state_q"}};
  for (const Words& globs : wanted) {
    Words options;
    for (const std::string& glob : globs) options.insert(options.end(), {"--trace-scope", glob});
    SCOPED_TRACE(fmt::format("{}", fmt::join(globs, " ")));
    const nlohmann::json some = traced("some.fst", options);
    std::size_t signals = 0;
    for (const std::string& glob : globs) signals += listed(glob);
    EXPECT_EQ(some["signals"], signals);
    EXPECT_LT(some["file_bytes"], all["file_bytes"]);
    EXPECT_EQ(some["comments"], all["comments"]);
    const Ran diff = cde({"wave", "diff", "all.fst", "some.fst"});
    EXPECT_EQ(diff.status, 0) << diff.out << diff.err;
  }
  refused_saying({"cast", "terrain:3,3,1", "--lanes", "4", "--exact-card", "-q", "--trace",
                  "none.fst", "--trace-scope", "control", "--trace-scope", "contr?"},
                 "waves of 'contr?': the card has no signal or scope of that name");
}

TEST_F(TraceWindow, ThatMakesNoSenseIsRefused) {
  for (const char* bad :
       {"7:5", "7", ":", "a:b", "1:2:3", "-1:5", "1.5:7", "99999999999999999999:"})
    refused_saying(
        {"query", "sphere-sphere", "--trace", "w.fst", fmt::format("--trace-window={}", bad)},
        fmt::format("'{}' is no window of clocks; FROM:TO, FROM: and :TO are, FROM not above "
                    "TO, e.g. 1000:1200",
                    bad));
  refused_saying({"query", "sphere-sphere", "--trace-window", "5:7"},
                 "--trace-window is of --trace");
  refused_saying({"cast", "terrain:3,3,1", "--trace-window", "5:7"},
                 "--trace-window is of --trace");
  refused_saying({"cast", "terrain:3,3,1", "--trace-scope", "update"},
                 "--trace-scope is of --trace");
}

/// Waves are wanted most when something takes too long.
TEST_F(TraceWindow, ASignalLeavesWavesThatCanBeRead) {
  // A card that takes minutes, whose waves begin late enough to be small.
  const Words words = {"cast",  "terrain:300,300,1", "--grid", "64x64",      "--lanes",
                       "4",     "--exact-card",      "-q",     "--no-check", "--trace",
                       "w.fst", "--trace-window",    ":2000"};
  ASSERT_EQ(cde({"cast", "terrain:3,3,1", "--grid", "4x4", "--lanes", "4", "--exact-card", "-q",
                 "--trace", "w.fst"})
                .status,
            0);  // the card is built
  fs::remove(folder_ / "w.fst");
  const pid_t child = start(words);
  // Its file is there, under another name, from when waves begin.
  for (int i = 0; i < 1500 && files().empty(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  ASSERT_FALSE(files().empty());
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  ASSERT_EQ(::kill(child, SIGINT), 0);
  const Ran ran = finish(child);
  EXPECT_EQ(ran.status, 128 + SIGINT) << ran.err;
  EXPECT_EQ(files(), Words{"w.fst"});
  EXPECT_GT(info("w.fst")["cycles"], 10);
}

}  // namespace
}  // namespace cde::testing
