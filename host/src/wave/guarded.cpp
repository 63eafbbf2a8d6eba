// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/guarded.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/process.hpp"
#include "cde/support/read_limits.hpp"

namespace cde::wave {
namespace {

/// Passes on the child's messages as they arrive, up to the last line that begins like one of this
/// command. The rest may be the C library's message about a corrupt heap.
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
    process::write_all(STDERR_FILENO, held.substr(1, rest));
    held.erase(0, rest);
  }
  return held.substr(1);
}

/// Limits the processor time of this process. Programs that it starts begin at 0.
void limit_time(std::chrono::seconds time) {
  rlimit limit{};
  ::getrlimit(RLIMIT_CPU, &limit);
  rusage used{};
  ::getrusage(RUSAGE_SELF, &used);
  const auto end = static_cast<rlim_t>(used.ru_utime.tv_sec + used.ru_stime.tv_sec + time.count());
  limit.rlim_cur = std::min(limit.rlim_cur, end);
  ::setrlimit(RLIMIT_CPU, &limit);
}

}  // namespace

int guarded(const std::string& file, const std::function<void()>& work,
            const std::function<void()>& crashed) {
  std::string last_words;
  const std::chrono::seconds time = ReadLimits::time_for(file);
  const auto limited = [&] {
    const bool viewer = static_cast<bool>(crashed);
    if (!viewer) limit_time(time);
    within_memory_for(file, work);
  };
  const auto ended = process::continue_in_child(
      limited, [&](int errors) { last_words = relay(errors); }, static_cast<bool>(crashed));
  if (!ended) return -1;
  const int signal = ended->signal;
  if (crashed && signal != 0) crashed();
  if (signal == SIGXCPU) fail_slow(file, time);
  const bool crash = signal == SIGSEGV || signal == SIGBUS || signal == SIGABRT ||
                     signal == SIGFPE || signal == SIGILL;
  if (signal != 0 && !crash) {
    process::write_all(STDERR_FILENO, last_words);
    std::signal(signal, SIG_DFL);
    std::raise(signal);
    return ended->status;
  }
  if (!ended->worked || signal != 0)
    throw Error(
        ErrorCode::kFile,
        printable_name(file) +
            ": is corrupt: Verilator's FST reader crashed on it; do not trust any output above");
  process::write_all(STDERR_FILENO, last_words);
  return ended->status;
}

}  // namespace cde::wave
