// SPDX-License-Identifier: Apache-2.0
// Signals while a terminal takes no output, and children of a killed command.
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <pty.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "run_cde.hpp"

namespace cde::testing {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

class Stopped : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    // Names that fill a screen.
    std::string text;
    for (unsigned i = 0; i < 5000; ++i)
      text += fmt::format("$var wire 8 s{0} a_long_name_of_a_signal_{0} $end\n", i);
    text += "$enddefinitions $end\n";
    for (unsigned t = 0; t < 200; ++t)
      for (unsigned i = 0; i < 300; ++i) text += fmt::format("#{}\nb{:08b} s{}\n", t, t, i);
    write("w.vcd", text);
  }
  void TearDown() override {
    if (terminal_ >= 0) ::close(terminal_);
    Cli::TearDown();
  }
  /// Starts `cde wave WORDS` on a terminal of 500 columns.
  pid_t start_on_terminal(const std::string& words) {
    winsize size{200, 500, 0, 0};
    const pid_t child = ::forkpty(&terminal_, nullptr, nullptr, &size);
    if (child != 0) return child;
    ::setenv("TERM", "xterm", 1);
    ::setenv("LC_ALL", "C.UTF-8", 1);
    if (::chdir(folder_.c_str()) != 0) ::_exit(126);
    const std::string line = fmt::format("exec '{}' wave {}", CDE_COMMAND, words);
    ::execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
    ::_exit(127);
  }
  /// Reads the terminal until nothing comes for a while.
  void read_terminal(milliseconds quiet) const {
    char part[65536];
    for (pollfd ready{terminal_, POLLIN, 0};
         ::poll(&ready, 1, static_cast<int>(quiet.count())) == 1 &&
         ::read(terminal_, part, sizeof part) > 0;) {
    }
  }
  /// Sends the signal and expects the command's end.
  static void expect_end(pid_t child, int signal) {
    const auto sent = Clock::now();
    ::kill(child, signal);
    int status = 0;
    pid_t ended = 0;
    while ((ended = ::waitpid(child, &status, WNOHANG)) == 0 &&
           Clock::now() - sent < std::chrono::seconds(10))
      std::this_thread::sleep_for(milliseconds(5));
    if (ended == 0) {
      ::kill(child, SIGKILL);
      ::waitpid(child, &status, 0);
    }
    ASSERT_EQ(ended, child) << "the command does not end";
    EXPECT_LT(Clock::now() - sent, std::chrono::seconds(3));
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal) << status;
  }
  int terminal_ = -1;
};

TEST_F(Stopped, FullTerminal_LetsSignalsEndTheCommand) {
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) {
    const pid_t child = start_on_terminal("at w.vcd 5 '*' --max 0");
    std::this_thread::sleep_for(milliseconds(500));  // until the terminal is full
    expect_end(child, signal);
    ::close(terminal_);
  }
  terminal_ = -1;
}

TEST_F(Stopped, ViewerOnAStoppedTerminal_EndsAtASignal) {
  const pid_t child = start_on_terminal("tui w.vcd");
  read_terminal(milliseconds(1000));
  const char stop = 0x13;  // ^S
  ASSERT_EQ(::write(terminal_, &stop, 1), 1);
  for (int i = 0; i < 40; ++i) {
    ASSERT_EQ(::write(terminal_, i % 2 == 0 ? "+" : "-", 1), 1);
    std::this_thread::sleep_for(milliseconds(20));
  }
  expect_end(child, SIGTERM);
}

/// The child waits for a pipe that never ends, and SIGTERM is ignored.
TEST_F(Stopped, KilledCommand_LeavesNoChildThatIgnoresSigterm) {
  const std::string pipe = (folder_ / "pipe").string();
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const int writer = ::open(pipe.c_str(), O_RDWR | O_CLOEXEC);
  ::signal(SIGTERM, SIG_IGN);
  const pid_t command = start({"wave", "info", "pipe"});
  ::signal(SIGTERM, SIG_DFL);
  const std::string children = fmt::format("/proc/{0}/task/{0}/children", command);
  pid_t child = 0;
  for (int i = 0; i < 500 && child == 0; ++i) {
    std::ifstream(children) >> child;
    std::this_thread::sleep_for(milliseconds(10));
  }
  ASSERT_NE(child, 0);
  ::kill(command, SIGKILL);
  (void)finish(command);
  bool ended = false;
  for (int i = 0; i < 500 && !ended; ++i) {
    std::ifstream stat(fmt::format("/proc/{}/stat", child));
    std::string number, name, state;
    ended = !(stat >> number >> name >> state) || state == "Z";
    std::this_thread::sleep_for(milliseconds(10));
  }
  EXPECT_TRUE(ended);
  ::close(writer);
}

}  // namespace
}  // namespace cde::testing
