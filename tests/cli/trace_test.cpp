// SPDX-License-Identifier: Apache-2.0
// --trace-window, --trace-scope, and a signal while waves are written.
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
  /// Output of `cde wave info` for a file.
  nlohmann::json info(const std::string& file) {
    const Ran ran = cde({"wave", "info", file, "--json"});
    EXPECT_EQ(ran.status, 0) << ran.err;
    return nlohmann::json::parse(ran.out, nullptr, false);
  }
};

/// 64 pairs in 8 lanes; each half of a cycle is one time in a unit's waves.
TEST_F(TraceWindow, WindowOfAQuery_HoldsItsCycles) {
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

TEST_F(TraceWindow, WindowBeyondTheRun_IsReported) {
  const Ran ran = shell(
      "echo '0,0,0,1,3,0,0,1' | \"$CDE\" query sphere-sphere -q --trace w.fst --trace-window "
      "9000:");
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(has(ran.err, "w.fst has no cycle of the run"));
}

TEST_F(TraceWindow, WindowOfACast_HoldsItsCycles) {
  const auto traced = [&](const Words& more) {
    Words words = {"cast", "terrain:3,3,1", "--grid", "4x4",     "--lanes",
                   "4",    "--exact-card",  "-q",     "--trace", "w.fst"};
    words.insert(words.end(), more.begin(), more.end());
    const Ran ran = cde(words);
    EXPECT_EQ(ran.status, 0) << ran.err;
    return info("w.fst");
  };
  constexpr std::uint64_t kClock = 10000;  // ps, at 100 MHz
  const nlohmann::json all = traced({}), window = traced({"--trace-window", "20:29"});
  const auto from = window["from"].get<std::uint64_t>(), to = window["to"].get<std::uint64_t>();
  EXPECT_EQ(window["cycles"], 10);
  EXPECT_GE(from, all["from"].get<std::uint64_t>() + 19 * kClock);
  EXPECT_LT(to - from, 10 * kClock);
  EXPECT_LT(window["file_bytes"], all["file_bytes"]);
}

/// Ports of a scope are aliases of signals around it, which are not written.
TEST_F(TraceWindow, Scope_EqualsTheWholeTrace) {
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
  refused_saying({"cast", "terrain:3,3,1", "--grid", "4x4", "--lanes", "4", "--exact-card", "-q",
                  "--trace", "none.fst", "--trace-scope", "control", "--trace-scope", "contr?"},
                 "waves of 'contr?': the card has no signal or scope of that name");
}

TEST_F(TraceWindow, InvalidWindow_IsRefused) {
  for (const char* bad :
       {"7:5", "7", ":", "a:b", "1:2:3", "-1:5", "1.5:7", "99999999999999999999:"})
    refused_saying(
        {"query", "sphere-sphere", "--trace", "w.fst", fmt::format("--trace-window={}", bad)},
        fmt::format(
            "'{}' is no window of cycles; expected FROM:TO, FROM: or :TO with FROM not above "
            "TO, e.g. 1000:1200",
            bad));
  refused_saying({"query", "sphere-sphere", "--trace-window", "5:7"},
                 "--trace-window needs --trace");
  refused_saying({"cast", "terrain:3,3,1", "--trace-window", "5:7"},
                 "--trace-window needs --trace");
  refused_saying({"cast", "terrain:3,3,1", "--trace-scope", "update"},
                 "--trace-scope needs --trace");
}

/// A signal during a long run must leave readable waves. At most one block is unwritten then, so
/// the command ends at once.
class WavesOnSignal : public TraceWindow, public ::testing::WithParamInterface<int> {
 protected:
  /// Size of the waves in the folder, under any name.
  std::uint64_t bytes_of_waves() const {
    std::uint64_t bytes = 0;
    for (const std::string& name : files())
      if (name.starts_with("w.fst")) bytes += fs::file_size(folder_ / name);
    return bytes;
  }
  /// Starts a command that takes minutes and sends the signal after two written blocks. The wave
  /// file must be readable.
  void stop(const Words& words) {
    const pid_t child = start(words);
    for (int i = 0; i < 6000 && bytes_of_waves() < 2'500'000; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    ASSERT_GE(bytes_of_waves(), 2'500'000u);
    const auto sent = std::chrono::steady_clock::now();
    ASSERT_EQ(::kill(child, GetParam()), 0);
    const Ran ran = finish(child);
    EXPECT_LT(std::chrono::steady_clock::now() - sent, std::chrono::seconds(5));
    EXPECT_EQ(ran.status, 128 + GetParam()) << ran.err;
    EXPECT_TRUE(has(ran.err, "stopped; w.fst has the waves until ")) << ran.err;
    const nlohmann::json waves = info("w.fst");
    EXPECT_GT(waves["cycles"], 10);
    EXPECT_GE(waves["blocks"], 3) << "at least three blocks";
    EXPECT_TRUE(has(ran.err, fmt::format("until {} ps", waves["to"].get<std::uint64_t>())))
        << ran.err;
  }
};
INSTANTIATE_TEST_SUITE_P(Signals, WavesOnSignal, ::testing::Values(SIGINT, SIGTERM),
                         [](const auto& info) { return info.param == SIGINT ? "Int" : "Term"; });

TEST_P(WavesOnSignal, Cast_LeavesReadableWaves) {
  stop({"cast", "terrain:300,300,1", "--grid", "64x64", "--lanes", "4", "--exact-card", "-q",
        "--no-check", "--trace", "w.fst"});
  EXPECT_EQ(files(), Words{"w.fst"});
}

/// Waves on stdout are written at the end.
TEST_P(WavesOnSignal, WavesOnStdout_HaveATime) {
  const auto cast = [](const char* mesh, const char* grid, const char* waves) {
    return Words{"cast",         mesh, "--grid",     grid,      "--lanes", "4",
                 "--exact-card", "-q", "--no-check", "--trace", waves};
  };
  ASSERT_EQ(cde(cast("terrain:3,3,1", "1x1", "first.fst")).status, 0);  // the model exists
  const pid_t child = start(cast("terrain:300,300,1", "64x64", "-"));
  std::this_thread::sleep_for(std::chrono::seconds(3));
  ASSERT_EQ(::kill(child, GetParam()), 0);
  const Ran ran = finish(child);
  EXPECT_EQ(ran.status, 128 + GetParam()) << ran.err;
  write("w.fst", ran.out);
  EXPECT_TRUE(has(ran.err, fmt::format("stopped; stdout has the waves until {} ps",
                                       info("w.fst")["to"].get<std::uint64_t>())))
      << ran.err;
}

/// Messages go to a full pipe that has a reader, who does not read.
TEST_F(TraceWindow, FullStderr_LetsTheRunEnd) {
  write("s.toml",
        "frames = 1000\n[card]\nlanes = 4\nbvh = \"off\"\n[[object]]\nname = \"t\"\n"
        "mesh = \"terrain:20,20,1\"\n[[object]]\nname = \"rays\"\n"
        "random_rays = { count = 300 }\n" +
            hit_query("t"));
  ASSERT_EQ(cde({"run", "s.toml", "--frames", "0", "-q", "-o", "first.run"}).status, 0);
  const Ran ran = shell(
      "mkfifo full && exec 7<>full && head -c 65536 /dev/zero >&7\n"
      "\"$CDE\" run s.toml -o s.run 2>&7 >/dev/null 7<&- &\n"
      "sleep 3; kill $!\n"
      "for ((i = 0; i < 60; ++i)); do kill -0 $! 2>/dev/null || break; sleep 0.05; done\n"
      "kill -KILL $! 2>/dev/null; wait $!; echo $?");
  EXPECT_EQ(ran.out, fmt::format("{}\n", 128 + SIGTERM));
}

TEST_P(WavesOnSignal, Run_LeavesReadableWaves) {
  write("s.toml",
        "[card]\nlanes = 4\nbvh = \"off\"\n[[object]]\nname = \"t\"\n"
        "mesh = \"terrain:200,200,1\"\n[[object]]\nname = \"rays\"\n"
        "random_rays = { count = 4096 }\n" +
            hit_query("t"));
  stop({"run", "s.toml", "-q", "--trace", "w.fst"});
  EXPECT_EQ(files(), (Words{"s.run", "s.toml", "w.fst"}));
}

}  // namespace
}  // namespace cde::testing
