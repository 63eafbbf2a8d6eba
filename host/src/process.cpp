#include "process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "cde/error.hpp"

extern char** environ;

namespace cde::process {

Result run(const std::vector<std::string>& command, bool with_errors,
           const std::function<void(std::chrono::duration<double>)>& tick) {
  int pipe[2];
  if (::pipe2(pipe, O_CLOEXEC) != 0) {
    throw Error(ErrorCode::kBuild, fmt::format("pipe: {}", std::strerror(errno)));
  }
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, pipe[1], STDOUT_FILENO);
  if (with_errors) posix_spawn_file_actions_adddup2(&actions, pipe[1], STDERR_FILENO);
  std::vector<char*> argv;
  argv.reserve(command.size() + 1);
  for (const std::string& word : command) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  pid_t child = 0;
  const int failed = ::posix_spawnp(&child, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(pipe[1]);
  if (failed != 0) {
    ::close(pipe[0]);
    throw Error(ErrorCode::kBuild,
                fmt::format("cannot run {}: {}", command[0], std::strerror(failed)));
  }

  Result result;
  const auto start = std::chrono::steady_clock::now();
  for (;;) {
    pollfd ready{pipe[0], POLLIN, 0};
    const int events = ::poll(&ready, 1, 200);
    if (tick) tick(std::chrono::steady_clock::now() - start);
    if (events == 0 || (events < 0 && errno == EINTR)) continue;
    char buffer[4096];
    const ssize_t n = ::read(pipe[0], buffer, sizeof buffer);
    if (n > 0) {
      result.output.append(buffer, static_cast<std::size_t>(n));
    } else if (n == 0 || errno != EINTR) {
      break;
    }
  }
  ::close(pipe[0]);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

}  // namespace cde::process
