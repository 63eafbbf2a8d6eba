// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/guarded.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <optional>

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

void write_all(int file, const std::string& text) {
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t n = ::write(file, text.data() + at, text.size() - at);
    if (n < 0 && errno != EINTR) return;
    if (n > 0) at += static_cast<std::size_t>(n);
  }
}

/// Hands messages of the child on as they come, up to the last line that begins as one of this
/// command, until it has ended. What is left may be the last word of the C library on a corrupt
/// heap.
std::string relay(int messages) {
  std::array<char, 4096> part{};
  std::string held = "\n";
  for (ssize_t n = 0; (n = ::read(messages, part.data(), part.size())) != 0;) {
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) break;
    held.append(part.data(), static_cast<std::size_t>(n));
    const std::size_t end = held.rfind('\n'), ours = held.rfind("\ncde: ", end - 1);
    if (end == 0 || ours == std::string::npos) continue;
    const std::size_t rest = held.find('\n', ours + 1);
    write_all(STDERR_FILENO, held.substr(1, rest));
    held.erase(0, rest);
  }
  return held.substr(1);
}

constexpr std::array kForwarded{SIGINT, SIGTERM, SIGHUP, SIGQUIT};
volatile pid_t forward_to = 0;

extern "C" void forward(int signal) {
  ::kill(forward_to, signal);
}

/// While it lives signals that end a process are for the child, which has something to put back.
class Forwarding {
 public:
  /// Before the child is there: no signal is lost.
  Forwarding() {
    sigset_t all;
    ::sigemptyset(&all);
    for (const int signal : kForwarded) ::sigaddset(&all, signal);
    ::sigprocmask(SIG_BLOCK, &all, &mask_);
  }
  void to(pid_t child) {
    forward_to = child;
    struct sigaction action {};
    action.sa_handler = forward;
    for (std::size_t i = 0; i < kForwarded.size(); ++i) {
      ::sigaction(kForwarded[i], nullptr, &before_[i]);
      if (before_[i].sa_handler != SIG_IGN) ::sigaction(kForwarded[i], &action, nullptr);
    }
    installed_ = true;
    ready();
  }
  void ready() { ::sigprocmask(SIG_SETMASK, &mask_, nullptr); }
  void end() {
    if (!installed_) return;
    for (std::size_t i = 0; i < kForwarded.size(); ++i)
      ::sigaction(kForwarded[i], &before_[i], nullptr);
    installed_ = false;
  }

 private:
  sigset_t mask_{};
  std::array<struct sigaction, kForwarded.size()> before_{};
  bool installed_ = false;
};

}  // namespace

int guarded(const std::string& file, const std::function<void()>& work,
            const std::function<void()>& crashed) {
  std::array<int, 2> done{}, messages{};
  const pid_t parent = ::getpid();
  if (::pipe2(done.data(), O_CLOEXEC) != 0 || ::pipe2(messages.data(), O_CLOEXEC) != 0)
    throw Error(ErrorCode::kFile, "no pipe can be made to read waves in another process");
  std::optional<Forwarding> forwarding;
  if (crashed) forwarding.emplace();
  const pid_t child = ::fork();
  if (child < 0 && forwarding) forwarding->ready();
  if (child < 0) throw Error(ErrorCode::kFile, "no process can be made to read waves in");
  if (child == 0) {
    ::close(done[0]);
    ::close(messages[0]);
    ::dup2(messages[1], STDERR_FILENO);
    ::close(messages[1]);
    if (forwarding) forwarding->ready();
    work_as_child(done[1], parent, work);
    return -1;
  }
  if (forwarding) forwarding->to(child);
  ::close(done[1]);
  ::close(messages[1]);
  const std::string last_words = relay(messages[0]);
  ::close(messages[0]);
  char byte = 0;
  ssize_t told = 0;
  do {
    told = ::read(done[0], &byte, 1);
  } while (told < 0 && errno == EINTR);
  ::close(done[0]);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (forwarding) forwarding->end();
  if (crashed && WIFSIGNALED(status)) crashed();
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    const bool crash = signal == SIGSEGV || signal == SIGBUS || signal == SIGABRT ||
                       signal == SIGFPE || signal == SIGILL;
    if (!crash) {
      write_all(STDERR_FILENO, last_words);
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
  write_all(STDERR_FILENO, last_words);
  return WEXITSTATUS(status);
}

}  // namespace cde::wave
