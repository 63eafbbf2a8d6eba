// SPDX-License-Identifier: Apache-2.0
#include "cde/support/process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <sstream>
#include <utility>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "support/descriptor.hpp"

extern char** environ;

namespace cde::process {
namespace {

std::array<int, 2> new_pipe(ErrorCode code = ErrorCode::kBuild) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0)
    throw Error(code, fmt::format("cannot create a pipe: {}", std::strerror(errno)));
  return ends;
}

/// The absolute entries of PATH. Relative and empty ones lead into the current folder, where other
/// users may put programs.
std::string absolute_path() {
  const char* const all = std::getenv("PATH");  // NOLINT(concurrency-mt-unsafe)
  std::string kept;
  std::istringstream entries(all != nullptr ? all : "/usr/bin:/bin");
  for (std::string entry; std::getline(entries, entry, ':');)
    if (entry.starts_with('/')) kept += (kept.empty() ? "" : ":") + entry;
  return kept;
}

/// The file of a program, found through the path unless its name has a slash.
std::string program_file(const std::string& name, const std::string& path) {
  if (name.find('/') != std::string::npos) return name;
  std::istringstream entries(path);
  for (std::string entry; std::getline(entries, entry, ':');) {
    const std::string file = entry + '/' + name;
    struct stat info {};
    if (::stat(file.c_str(), &info) == 0 && S_ISREG(info.st_mode) &&
        ::access(file.c_str(), X_OK) == 0)
      return file;
  }
  return {};
}

/// This process's environment with LC_ALL=C, so that cde can parse messages. Shells and Perl warn
/// of a locale that is not installed; C is always there. `path` is "PATH=...".
std::vector<char*> environment(std::string& path) {
  static char language[] = "LC_ALL=C";
  std::vector<char*> all;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string_view text = *variable;
    if (!text.starts_with("LC_ALL=") && !text.starts_with("PATH=")) all.push_back(*variable);
  }
  all.insert(all.end(), {language, path.data(), nullptr});
  return all;
}

/// Starts a program with these descriptors as stdin, stdout and, unless `errors` is negative,
/// stderr. With `own_group` it leads a process group, so that its descendants can be ended with it.
pid_t start(const std::vector<std::string>& command, int input, int output, int errors,
            bool own_group = false) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  if (input >= 0)
    posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
  else
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  if (errors >= 0) posix_spawn_file_actions_adddup2(&actions, errors, STDERR_FILENO);
  std::vector<char*> argv;
  argv.reserve(command.size() + 1);
  for (const std::string& word : command) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  // A child must receive the signals that end it, and the exit statuses of its own children.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none, to_default;
  ::sigemptyset(&none);
  ::sigemptyset(&to_default);
  ::sigaddset(&to_default, SIGCHLD);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &to_default);
  int flags = POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF;
  if (own_group) flags |= POSIX_SPAWN_SETPGROUP;
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes, static_cast<short>(flags));
  pid_t child = 0;
  const std::string path = absolute_path(), file = program_file(command[0], path);
  std::string variable = "PATH=" + path;
  const int failed = file.empty() ? ENOENT
                                  : ::posix_spawn(&child, file.c_str(), &actions, &attributes,
                                                  argv.data(), environment(variable).data());
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (failed != 0)
    throw Error(ErrorCode::kBuild, fmt::format("cannot run {}: {}", printable_name(command[0]),
                                               std::strerror(failed)));
  return child;
}

/// The exit status as a shell reports it. `signal` is the signal that ended the child, or 0.
int wait_for(pid_t child, std::uint64_t* resident_kb = nullptr, int* signal = nullptr) {
  int status = 0;
  rusage used{};
  pid_t ended = -1;
  do {
    ended = ::wait4(child, &status, 0, &used);
  } while (ended < 0 && errno == EINTR);
  if (ended < 0)  // SIGCHLD is ignored, so the system keeps no exit status
    throw Error(ErrorCode::kBuild,
                fmt::format("cannot wait for a child process: {}", std::strerror(errno)));
  if (resident_kb != nullptr) *resident_kb = static_cast<std::uint64_t>(used.ru_maxrss);
  if (signal != nullptr) *signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// Reads to the end of the stream. Calls `turn` after each read and every 200 ms.
std::string read_all(int fd, const std::function<void(std::string_view)>& turn) {
  std::string text;
  for (;;) {
    pollfd ready{fd, POLLIN, 0};
    const int events = ::poll(&ready, 1, 200);
    if (events > 0) {
      std::array<char, 4096> buffer{};
      const ssize_t n = ::read(fd, buffer.data(), buffer.size());
      if (n == 0 || (n < 0 && errno != EINTR)) return text;
      if (n > 0) text.append(buffer.data(), static_cast<std::size_t>(n));
    }
    turn(text);
  }
}

/// While an instance lives, terminating signals are noted instead. The last instance restores the
/// previous handlers. Ignored signals stay ignored.
class Signals {
 public:
  Signals() {
    const std::scoped_lock lock(mutex);
    if (users++ != 0) return;
    came = 0;
    for (std::size_t i = 0; i < kSignals.size(); ++i) {
      ::sigaction(kSignals[i], nullptr, &before[i]);
      if (before[i].sa_handler == SIG_IGN) continue;
      struct sigaction action {};
      action.sa_handler = [](int signal) { came = signal; };
      ::sigaction(kSignals[i], &action, nullptr);
    }
  }
  ~Signals() {
    const std::scoped_lock lock(mutex);
    if (--users != 0) return;
    for (std::size_t i = 0; i < kSignals.size(); ++i) {
      if (before[i].sa_handler != SIG_IGN) ::sigaction(kSignals[i], &before[i], nullptr);
    }
    if (const int signal = came.exchange(0)) ::raise(signal);
  }
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;
  [[nodiscard]] static int signal() { return came; }

 private:
  static constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};
  static inline std::mutex mutex;
  static inline int users = 0;
  static inline std::array<struct sigaction, kSignals.size()> before{};
  static inline std::atomic<int> came = 0;
  static_assert(std::atomic<int>::is_always_lock_free, "set in a signal handler");
};

/// Error kInterrupted for a signal that did not end this process; 0: none came.
void check_interrupted(int signal, const std::vector<std::string>& command) {
  if (signal == 0) return;
  throw Error(signal, fmt::format("ended by {} while {} ran", ::strsignal(signal),  // NOLINT
                                  printable_name(command[0])));
}

volatile pid_t forward_to = 0;

/// Forwards terminating signals to a child, which may have to clean up.
class Forwarding {
 public:
  /// Constructed before the child starts, so that no signal is lost.
  Forwarding() {
    sigset_t all;
    ::sigemptyset(&all);
    for (const int signal : kSignals) ::sigaddset(&all, signal);
    ::sigprocmask(SIG_BLOCK, &all, &mask_);
  }
  ~Forwarding() {
    if (!installed_) unblock();
    for (std::size_t i = 0; installed_ && i < kSignals.size(); ++i)
      ::sigaction(kSignals[i], &before_[i], nullptr);
  }
  Forwarding(const Forwarding&) = delete;
  Forwarding& operator=(const Forwarding&) = delete;
  void to(pid_t child) {
    forward_to = child;
    struct sigaction action {};
    action.sa_handler = [](int signal) { ::kill(forward_to, signal); };
    for (std::size_t i = 0; i < kSignals.size(); ++i) {
      ::sigaction(kSignals[i], nullptr, &before_[i]);
      if (before_[i].sa_handler != SIG_IGN) ::sigaction(kSignals[i], &action, nullptr);
    }
    installed_ = true;
    unblock();
  }

 private:
  void unblock() { ::sigprocmask(SIG_SETMASK, &mask_, nullptr); }

  static constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP, SIGQUIT};
  sigset_t mask_{};
  std::array<struct sigaction, kSignals.size()> before_{};
  bool installed_ = false;
};

/// Makes this process end with the signal when its parent ends.
void end_with(pid_t parent, int signal) {
  ::prctl(PR_SET_PDEATHSIG, signal);
  if (::getppid() != parent) std::raise(signal);
}

/// Runs `work` in the child. A byte on `done` tells the parent that it has not crashed.
void work_as_child(int done, pid_t parent, const std::function<void()>& work) {
  // SIGTERM lets the child remove its unfinished files.
  struct sigaction at_end {};
  ::sigaction(SIGTERM, nullptr, &at_end);
  end_with(parent, at_end.sa_handler == SIG_IGN ? SIGKILL : SIGTERM);
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  const auto tell = [done] { write_all(done, std::string_view("", 1)); };
  try {
    work();
  } catch (...) {
    tell();
    throw;
  }
  tell();
}

pid_t fork_process() {
  const pid_t child = ::fork();
  if (child < 0)
    throw Error(ErrorCode::kFile,
                fmt::format("cannot start a child process: {}", std::strerror(errno)));
  return child;
}

}  // namespace

bool write_all(int file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t n = ::write(file, text.data(), text.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

Result run(const std::vector<std::string>& command) {
  Result result;
  int signal = 0;
  {
    const Signals signals;
    const auto ends = new_pipe();
    const Descriptor from(ends[0]);
    Descriptor to(ends[1]);
    const pid_t child = start(command, -1, to.get(), to.get(), true);
    to.close();
    constexpr int kPatience = 5;
    int requests = 0;
    result.output = read_all(from.get(), [&](std::string_view) {
      if (Signals::signal() != 0) ::kill(-child, requests++ < kPatience ? SIGTERM : SIGKILL);
    });
    result.status = wait_for(child, &result.resident_kb);
    signal = Signals::signal();
  }
  check_interrupted(signal, command);
  return result;
}

Result run_isolated(const std::function<void(int out)>& work, std::optional<Seconds> limit) {
  const auto ends = new_pipe(ErrorCode::kFile);
  const Descriptor from(ends[0]);
  Descriptor to(ends[1]);
  const pid_t parent = ::getpid(), child = fork_process();
  if (child == 0) {
    end_with(parent, SIGKILL);
    ::close(from.get());
    work(to.get());
    ::_exit(0);
  }
  to.close();
  Result result;
  const auto began = std::chrono::steady_clock::now();
  result.output = read_all(from.get(), [&](std::string_view) {
    if (!limit || result.timed_out || std::chrono::steady_clock::now() - began < *limit) return;
    result.timed_out = true;
    ::kill(child, SIGKILL);
  });
  result.status = wait_for(child, &result.resident_kb);
  return result;
}

std::optional<ChildExit> continue_in_child(const std::function<void()>& work,
                                           const std::function<void(int errors)>& relay,
                                           bool forward) {
  const auto done = new_pipe(ErrorCode::kFile);
  Descriptor from_done(done[0]), to_done(done[1]);
  const auto errors = new_pipe(ErrorCode::kFile);
  Descriptor from(errors[0]), to(errors[1]);
  const pid_t parent = ::getpid();
  std::optional<Forwarding> forwarding;
  if (forward) forwarding.emplace();
  const pid_t child = fork_process();
  if (child == 0) {
    from_done.close();
    from.close();
    ::dup2(to.get(), STDERR_FILENO);
    to.close();
    forwarding.reset();
    work_as_child(to_done.get(), parent, work);
    return std::nullopt;
  }
  if (forwarding) forwarding->to(child);
  to_done.close();
  to.close();
  relay(from.get());
  char byte = 0;
  ssize_t told = 0;
  do {
    told = ::read(from_done.get(), &byte, 1);
  } while (told < 0 && errno == EINTR);
  ChildExit ended{.worked = told == 1};
  ended.status = wait_for(child, nullptr, &ended.signal);
  return ended;
}

Result run_watched(const std::vector<std::string>& command,
                   const std::function<void(Seconds, std::string_view)>& watch) {
  Result result;
  int signal = 0;
  {
    const Signals signals;
    const auto ends = new_pipe(), life = new_pipe();
    const Descriptor from(ends[0]);
    Descriptor to(ends[1]), input(life[0]), alive(life[1]);
    const pid_t child = start(command, input.get(), to.get(), to.get());
    to.close();
    input.close();
    const auto began = std::chrono::steady_clock::now();
    result.output = read_all(from.get(), [&](std::string_view so_far) {
      if (Signals::signal() != 0) alive.close();
      watch(std::chrono::steady_clock::now() - began, so_far);
    });
    result.status = wait_for(child);
    signal = Signals::signal();
  }
  check_interrupted(signal, command);
  return result;
}

Conversation::Conversation(const std::vector<std::string>& command) {
  const auto in = new_pipe(), out = new_pipe();
  const Descriptor input(in[0]), output(out[1]);
  to_ = in[1], from_ = out[0];
  try {
    child_ = start(command, input.get(), output.get(), -1);
  } catch (...) {
    ::close(to_), ::close(from_);
    throw;
  }
}

Conversation::~Conversation() {
  if (child_ >= 0) (void)wait();
}

void Conversation::write(std::string_view line) {
  write_all(to_, std::string(line) + '\n');
}

std::optional<std::string> Conversation::read() {
  for (;;) {
    if (const std::size_t end = unread_.find('\n'); end != std::string::npos) {
      std::string line = unread_.substr(0, end);
      unread_.erase(0, end + 1);
      return line;
    }
    std::array<char, 4096> buffer{};
    const ssize_t n = ::read(from_, buffer.data(), buffer.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return std::nullopt;
    unread_.append(buffer.data(), static_cast<std::size_t>(n));
  }
}

int Conversation::wait() {
  ::close(to_), ::close(from_);
  return wait_for(std::exchange(child_, -1));
}

}  // namespace cde::process
