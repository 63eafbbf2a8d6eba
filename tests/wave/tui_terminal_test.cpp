// SPDX-License-Identifier: Apache-2.0
// `cde wave tui` on a tmux terminal: its screen, and the state in which it leaves the terminal.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "../has.hpp"
#include "run_cde.hpp"
#include "sample.hpp"

namespace cde::testing {
namespace {

using std::chrono::milliseconds;

class TuiTerminal : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    write_sample(folder_ / "a.fst");
    if (shell("command -v tmux").status != 0) GTEST_SKIP() << "needs tmux";
  }
  void TearDown() override {
    (void)tmux("kill-server");
    Cli::TearDown();
  }
  Ran tmux(const std::string& words) {
    return shell(fmt::format("unset TMUX; tmux -S '{}' -f /dev/null {}", socket(), words));
  }
  /// Opens a shell that runs the command. Then it prints the status, and whether the terminal
  /// echoes.
  void open(const std::string& words, unsigned columns = 80, unsigned rows = 24,
            const std::string& environment = "LC_ALL=C.UTF-8") {
    write("run.sh", fmt::format("cd '{}'\nexport {}\necho before\n\"{}\" wave tui {}\necho "
                                "\"status $?\"\nstty -a | grep -ow -e '-\\?icanon' -e '-\\?echo'\n"
                                "echo after\nsleep 1000\n",
                                folder_.string(), environment, CDE_COMMAND, words));
    const Ran ran = tmux(fmt::format("new-session -d -x {} -y {} 'bash \"{}\"'", columns, rows,
                                     (folder_ / "run.sh").string()));
    ASSERT_EQ(ran.status, 0) << ran.err;
  }
  std::string screen() { return tmux("capture-pane -p").out; }
  /// Waits until the screen contains the text; returns the last screen.
  std::string wait_for(const std::string& text) {
    std::string seen;
    for (unsigned i = 0; i < 200; ++i) {
      seen = screen();
      if (seen.find(text) != std::string::npos) return seen;
      std::this_thread::sleep_for(milliseconds(50));
    }
    ADD_FAILURE() << text << " does not appear on the screen:\n" << seen;
    return seen;
  }
  void keys(const std::string& words) { EXPECT_EQ(tmux("send-keys " + words).status, 0); }
  /// Expects the shell's screen with its cursor and modes.
  void expect_restored(const std::string& status) {
    const std::string seen = wait_for("after");
    EXPECT_TRUE(has(seen, "before"));
    EXPECT_TRUE(has(seen, status));
    EXPECT_TRUE(has(seen, "\nicanon\necho\n"));
    EXPECT_EQ(tmux("display-message -p '#{cursor_flag} #{alternate_on}'").out, "1 0\n");
  }
  /// Sends a signal to the command, or to the child that owns the screen.
  void send(const std::string& signal, bool child) {
    const Ran ran = shell(fmt::format(
        "pid=$(tmux -S '{}' display-message -p '#{{pane_pid}}')\n"
        "for level in {}; do read -r pid _ < /proc/$pid/task/$pid/children; done; kill -{} $pid",
        socket(), child ? "1 2" : "1", signal));
    EXPECT_EQ(ran.status, 0) << ran.err;
  }
  [[nodiscard]] std::string socket() const {
    return (folder_ / fmt::format("socket{}", server_)).string();
  }
  unsigned server_ = 0;  ///< each test has a new server, because an old one needs time to end
};

TEST_F(TuiTerminal, Keys_ShowMoveAndQuit) {
  open("a.fst clk count:dec valid data:fp32 --around fail --window 3");
  std::string seen = wait_for("A 75ns cyc:7");
  EXPECT_TRUE(has(seen, "{3.5 nan}"));
  EXPECT_TRUE(has(seen, "▁╱▔"));
  keys("j w");
  seen = wait_for("A 85ns cyc:8");
  EXPECT_TRUE(has(seen, "signal 2 of 4"));
  keys("F1");
  wait_for("zoom in or out");
  keys("Escape");
  wait_for("A 85ns");
  keys("Right");
  wait_for("A 86ns");
  keys("f 'count:dec == 10' Enter");
  wait_for("A 105ns cyc:10");
  keys("q");
  expect_restored("status 0");
}

TEST_F(TuiTerminal, Resize_RedrawsTheScreen) {
  open("a.fst");
  wait_for("A 75ns cyc:7");
  EXPECT_EQ(tmux("resize-window -x 30 -y 10").status, 0);
  wait_for("too small");
  EXPECT_EQ(tmux("resize-window -x 120 -y 40").status, 0);
  const std::string seen = wait_for(" 0 to 195ns");
  EXPECT_FALSE(has(seen, "too small"));
  keys("C-c");
  expect_restored("status 0");
}

/// The terminal is restored after signals to the command or its child, after a crash, and after
/// SIGKILL.
TEST_F(TuiTerminal, AnyEnd_LeavesAWorkingTerminal) {
  const std::vector<std::tuple<std::string, bool, std::string>> ends = {
      {"TERM", false, "status 143"}, {"INT", false, "status 130"}, {"HUP", false, "status 129"},
      {"TERM", true, "status 143"},  {"KILL", true, "status 137"}, {"SEGV", true, "status 2"},
  };
  for (const auto& [signal, child, status] : ends) {
    SCOPED_TRACE(signal + (child ? " to the child" : ""));
    open("a.fst");
    wait_for("A 75ns cyc:7");
    send(signal, child);
    expect_restored(status);
    (void)tmux("kill-server");
    ++server_;
  }
}

TEST_F(TuiTerminal, StopAndResume_KeepTheScreen) {
  write("job.sh", fmt::format("set -m\ncd '{}'\nexport LC_ALL=C.UTF-8\n\"{}\" wave tui a.fst\necho "
                              "stopped\nread -r\nfg\necho \"status $?\"\nsleep 1000\n",
                              folder_.string(), CDE_COMMAND));
  ASSERT_EQ(
      tmux(fmt::format("new-session -d -x 80 -y 24 'bash \"{}\"'", (folder_ / "job.sh").string()))
          .status,
      0);
  wait_for("A 75ns cyc:7");
  keys("C-z");
  EXPECT_FALSE(has(wait_for("stopped"), "75ns"));
  keys("Enter");
  wait_for("A 75ns cyc:7");
  keys("q");
  wait_for("status 0");
}

TEST_F(TuiTerminal, TerminalsOfAllKinds_ShowTheWaves) {
  for (const char* environment : {"LC_ALL=C", "TERM=vt100 LC_ALL=C", "NO_COLOR=1 LC_ALL=C.UTF-8"}) {
    SCOPED_TRACE(environment);
    open("a.fst --around fail --window 3", 80, 24, environment);
    std::string seen = wait_for("A 75ns cyc:7");
    const bool utf8 = seen.find("▔") != std::string::npos;
    EXPECT_EQ(utf8, std::string(environment).find("UTF-8") != std::string::npos) << seen;
    if (!utf8) {
      EXPECT_TRUE(has(seen, "/---"));
    }
    keys("q");
    seen = wait_for("after");
    EXPECT_FALSE(has(seen, "75ns"));
    EXPECT_TRUE(has(seen, "status 0\nicanon\necho\n"));
    (void)tmux("kill-server");
    ++server_;
  }
  open("a.fst", 80, 24, "TERM=no-such-terminal");
  EXPECT_TRUE(has(wait_for("status 2"), "is not known here"));
}

class TuiCommand : public Cli {};

TEST_F(TuiCommand, WaveTuiWithoutATerminal_IsRefused) {
  write_sample(folder_ / "a.fst");
  const Ran ran = shell("\"$CDE\" wave tui a.fst < /dev/null");
  EXPECT_EQ(ran.status, 2);
  EXPECT_EQ(ran.out, "");
  EXPECT_TRUE(has(ran.err, "cde wave tui needs a terminal"));
  const Ran json = cde({"wave", "tui", "a.fst", "--json"});
  EXPECT_EQ(json.status, 2);
  EXPECT_TRUE(has(json.err, "has no option '--json'"));
  const Ran other = cde({"wave", "show", "a.fst", "clk", "--diff", "a.fst"});
  EXPECT_EQ(other.status, 2);
  EXPECT_TRUE(has(other.err, "has no option '--diff'"));
}

}  // namespace
}  // namespace cde::testing
