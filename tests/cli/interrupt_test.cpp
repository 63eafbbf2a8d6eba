// SPDX-License-Identifier: Apache-2.0
// A signal during the build of a simulation model: the build ends with the command, whichever
// process got the signal.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <sstream>
#include <thread>

#include "../has.hpp"
#include "run_cde.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;

class ModelBuild : public Cli {
 protected:
  pid_t start_building() {
    return start({"cast", "terrain:3,3,1", "--grid", "4x4", "--lanes", "2", "-o", "hits.csv"},
                 {"CDE_CACHE=" + (folder_ / "cache").string()});
  }
  /// Waits until the compiler works on the model, and a little longer.
  bool wait_for_compiler(pid_t child) {
    for (int i = 0; i < 600; ++i) {
      if (commands().find("all.cpp") != std::string::npos) return true;
      siginfo_t info{};
      ::waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOHANG | WNOWAIT);
      if (info.si_pid == child) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return false;
  }
  /// Command lines of all processes that name the cache of this test or work in it.
  std::string commands() {
    std::string found;
    std::error_code gone;
    for (const auto& entry : fs::directory_iterator("/proc", gone)) {
      const std::string line = bytes_of(entry.path() / "cmdline");
      const std::string cache = (folder_ / "cache").string();
      const std::string works_in = fs::read_symlink(entry.path() / "cwd", gone).string();
      if (line.find(cache) != std::string::npos || works_in.starts_with(cache))
        found += entry.path().filename().string() + ": " + line + "\n";
    }
    return found;
  }
  /// The builder, a child of the command.
  static pid_t builder_of(pid_t command) {
    std::istringstream children(bytes_of("/proc/" + std::to_string(command) + "/task/" +
                                         std::to_string(command) + "/children"));
    pid_t child = 0;
    children >> child;
    return child;
  }
  void expect_nothing_left() {
    EXPECT_EQ(commands(), "");
    for (const auto& entry : fs::directory_iterator(folder_ / "cache")) {
      const std::string name = entry.path().filename();
      EXPECT_TRUE(name.starts_with(".runtime-") || name.ends_with(".lock")) << name;
    }
    EXPECT_FALSE(exists("hits.csv"));
  }
};

TEST_F(ModelBuild, SignalToTheCommand_EndsTheBuild) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    SCOPED_TRACE(signal);
    const pid_t child = start_building();
    const bool began = wait_for_compiler(child);
    ::kill(child, signal);
    const Ran ran = finish(child);
    ASSERT_TRUE(began) << ran.err;
    EXPECT_EQ(ran.status, 128 + signal) << ran.err;
    expect_nothing_left();
    EXPECT_EQ(files(), std::vector<std::string>{"cache"}) << "an output was left behind";
  }
}

/// A run that never began leaves neither its folder nor its page.
TEST_F(ModelBuild, SignalBeforeARun_LeavesNoFolder) {
  write("s.toml",
        "[card]\nlanes = 2\n[[object]]\nname = \"t\"\nmesh = \"terrain:3,3,1\"\n[[object]]\n"
        "name = \"rays\"\nrandom_rays = { count = 2 }\n[[query]]\nname = \"q\"\n"
        "pair = \"ray-triangle\"\nprimaries = \"rays\"\nsecondaries = \"t\"\n");
  const pid_t child = start({"run", "s.toml", "--out", "new/r.run", "--report", "page.html"},
                            {"CDE_CACHE=" + (folder_ / "cache").string()});
  const bool began = wait_for_compiler(child);
  ::kill(child, SIGINT);
  const Ran ran = finish(child);
  ASSERT_TRUE(began) << ran.err;
  EXPECT_EQ(ran.status, 128 + SIGINT) << ran.err;
  expect_nothing_left();
  EXPECT_EQ(files(), (std::vector<std::string>{"cache", "s.toml"}));
}

TEST_F(ModelBuild, SignalToTheBuilder_EndsTheCommand) {
  for (const int signal : {SIGINT, SIGTERM}) {
    SCOPED_TRACE(signal);
    const pid_t child = start_building();
    const bool began = wait_for_compiler(child);
    ASSERT_GT(builder_of(child), 0);
    ::kill(builder_of(child), signal);
    const Ran ran = finish(child);
    ASSERT_TRUE(began) << ran.err;
    EXPECT_EQ(ran.status, 128 + signal) << ran.err;
    EXPECT_TRUE(has(ran.err, "was stopped"));
    expect_nothing_left();
  }
}

/// SIGKILL leaves no time to clean up; the child processes notice that the command is gone.
TEST_F(ModelBuild, KilledCommand_LeavesNoCompiler) {
  const pid_t child = start_building();
  const bool began = wait_for_compiler(child);
  ::kill(child, SIGKILL);
  EXPECT_EQ(finish(child).status, 128 + SIGKILL);
  ASSERT_TRUE(began);
  for (int i = 0; i < 250 && !commands().empty(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  expect_nothing_left();
}

/// nohup, and `&` of a shell without job control.
TEST_F(ModelBuild, IgnoredSignals_StayIgnored) {
  for (const int signal : {SIGINT, SIGHUP}) ::signal(signal, SIG_IGN);
  const pid_t child = start_building();
  for (const int signal : {SIGINT, SIGHUP}) ::signal(signal, SIG_DFL);
  const bool began = wait_for_compiler(child);
  for (const int signal : {SIGINT, SIGHUP}) {
    ::kill(child, signal);
    ::kill(builder_of(child), signal);
  }
  const Ran ran = finish(child);
  ASSERT_TRUE(began) << ran.err;
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(exists("hits.csv"));
}

/// The builder ends its own children, and the command learns their statuses.
TEST_F(ModelBuild, IgnoredTermAndChildSignals_LetTheBuildEnd) {
  for (const int signal : {SIGTERM, SIGCHLD}) ::signal(signal, SIG_IGN);
  const pid_t child = start_building();
  for (const int signal : {SIGTERM, SIGCHLD}) ::signal(signal, SIG_DFL);
  const Ran ran = finish(child);
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(exists("hits.csv"));
  // Any user who can read a lock file can hold its lock.
  int locks = 0;
  for (const auto& entry : fs::directory_iterator(folder_ / "cache")) {
    if (entry.path().extension() != ".lock") continue;
    ++locks;
    EXPECT_EQ(entry.status().permissions(), fs::perms::owner_read | fs::perms::owner_write);
  }
  EXPECT_EQ(locks, 1);
}

/// The same during a run: `cde run` handles signals itself.
TEST_F(ModelBuild, IgnoredSignals_StayIgnoredInARun) {
  ::signal(SIGHUP, SIG_IGN);
  const pid_t child =
      start({"run", std::string(CDE_SOURCE_DIR) + "/meshes/scenes/mixed.toml", "--frames", "0..1"});
  ::signal(SIGHUP, SIG_DFL);
  for (int i = 0; i < 50; ++i) {
    ::kill(child, SIGHUP);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  const Ran ran = finish(child);
  EXPECT_EQ(ran.status, 0) << ran.err;
}

}  // namespace
}  // namespace cde::testing
