// SPDX-License-Identifier: Apache-2.0
#include "wave/guarded.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"

namespace cde::wave {
namespace {

void work_as_child(int done, pid_t parent, const std::function<void()>& work) {
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != parent) std::raise(SIGTERM);
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  const auto tell = [done] {
    while (::write(done, "", 1) < 0 && errno == EINTR) {
    }
    ::close(done);
  };
  try {
    work();
  } catch (...) {
    tell();
    throw;
  }
  tell();
}

}  // namespace

int guarded(const std::string& file, const std::function<void()>& work) {
  std::array<int, 2> done{};
  const pid_t parent = ::getpid();
  if (::pipe2(done.data(), O_CLOEXEC) != 0)
    throw Error(ErrorCode::kFile, "no pipe can be made to read waves in another process");
  const pid_t child = ::fork();
  if (child < 0) throw Error(ErrorCode::kFile, "no process can be made to read waves in");
  if (child == 0) {
    ::close(done[0]);
    work_as_child(done[1], parent, work);
    return -1;
  }
  ::close(done[1]);
  char byte = 0;
  ssize_t told = 0;
  do {
    told = ::read(done[0], &byte, 1);
  } while (told < 0 && errno == EINTR);
  ::close(done[0]);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    const bool crash = signal == SIGSEGV || signal == SIGBUS || signal == SIGABRT ||
                       signal == SIGFPE || signal == SIGILL;
    if (!crash) {
      std::signal(signal, SIG_DFL);
      std::raise(signal);
      return 128 + signal;
    }
  }
  if (told != 1 || !WIFEXITED(status))
    throw Error(ErrorCode::kFile,
                printable_name(file) +
                    ": is corrupt: Verilator's reader of FST crashed on it, and what is printed "
                    "above, if anything, is not to be trusted");
  return WEXITSTATUS(status);
}

}  // namespace cde::wave
