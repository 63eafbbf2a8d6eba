// SPDX-License-Identifier: Apache-2.0
// Signals while a program runs: its descendants and temporary folders end with this process.
#include "cde/support/process.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <functional>
#include <string>
#include <thread>

#include "cde/support/output_file.hpp"
#include "cde/support/scratch.hpp"
#include "testing.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;

bool wait_until(const std::function<bool()>& happened) {
  for (int i = 0; i < 1000; ++i) {
    if (happened()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

/// Whether a process runs whose command line contains the text.
bool is_running(const std::string& text) {
  std::error_code gone;
  for (const auto& entry : fs::directory_iterator("/proc", gone))
    if (bytes_of(entry.path() / "cmdline").find(text) != std::string::npos) return true;
  return false;
}

/// As the programs do.
void remove_and_end(int signal) {
  OutputFile::remove_unfinished();
  ::signal(signal, SIG_DFL);
  ::raise(signal);
}

/// In the current folder other users may have put programs.
TEST(Process, RelativeEntriesOfPath_AreNotSearched) {
  const Folder folder;
  folder.write("own-tool", "#!/bin/sh\necho ran\n");
  fs::permissions(folder / "own-tool", fs::perms::owner_all);
  const pid_t child = ::fork();
  if (child == 0) {
    int failures = ::chdir((folder / "").c_str());
    for (const char* path : {"", ":/usr/bin:/bin", ".:/usr/bin:/bin", "/usr/bin:/bin:"}) {
      ::setenv("PATH", path, 1);
      try {
        (void)process::run({"own-tool"});
        ++failures;
      } catch (const Error& e) {
        failures += std::string(e.what()) != "cannot run own-tool: No such file or directory";
      }
    }
    ::setenv("PATH", (":" + (folder / "").string() + ":/usr/bin:/bin").c_str(), 1);
    failures += process::run({"own-tool"}).output != "ran\n";
    failures += process::run({"/bin/sh", "-c", "own-tool"}).output != "ran\n";
    failures += process::run({"/usr/bin/env"}).output.find("PATH=/") == std::string::npos;
    ::_exit(failures);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0) << "failures";
}

TEST(Process, SignalDuringARun_EndsDescendantsAndRemovesScratch) {
  const std::string seconds = fmt::format("98765.{}", ::getpid());  // marks the descendants
  // The second program ignores SIGTERM, so it must be killed.
  for (const char* before : {"", "trap '' TERM; "}) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
      SCOPED_TRACE(fmt::format("signal {} {}", signal, before));
      const Folder folder;
      const pid_t child = ::fork();
      if (child == 0) {
        ::setenv("TMPDIR", (folder / "").c_str(), 1);
        ::signal(signal, remove_and_end);
        try {
          const Scratch scratch("cde-elaborate");
          fs::create_directory(scratch / "inner");
          const std::string script = fmt::format(
              "{}touch '{}'; touch '{}'; sleep {} & sleep {}; true", before,
              (scratch / "inner/file").string(), (folder / "began").string(), seconds, seconds);
          (void)process::run({"/bin/sh", "-c", script});
        } catch (const std::exception&) {
        }
        ::_exit(1);
      }
      EXPECT_TRUE(wait_until([&] { return fs::exists(folder / "began") && is_running(seconds); }));
      EXPECT_EQ(folder.files(), 2u);
      ::kill(child, signal);
      int status = 0;
      ASSERT_EQ(::waitpid(child, &status, 0), child);
      EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal) << status;
      EXPECT_TRUE(wait_until([&] { return !is_running(seconds); }));
      EXPECT_EQ(folder.files(), 1u) << "only the file that the program made";
    }
  }
}

TEST(Process, SignalWithAHandlerThatReturns_IsAnError) {
  const auto before = ::signal(SIGTERM, [](int) {});
  const pid_t parent = ::getpid();
  try {
    (void)process::run({"/bin/sh", "-c", fmt::format("kill -TERM {}; sleep 1000", parent)});
    ADD_FAILURE() << "an interrupted program returned";
  } catch (const Error& e) {
    EXPECT_EQ(static_cast<int>(e.code()), static_cast<int>(ErrorCode::kInterrupted));
    EXPECT_EQ(e.signal(), SIGTERM);
  }
  ::signal(SIGTERM, before);
}

}  // namespace
}  // namespace cde::testing
