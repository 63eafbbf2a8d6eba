// SPDX-License-Identifier: Apache-2.0
#include "output/streams.hpp"
#include <nlohmann/json.hpp>

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <new>

#include "cde/support/error.hpp"
#include "cde/support/output_file.hpp"
#include "cde/support/progress.hpp"

namespace cde::cli {
namespace {

bool pipe_signal_ignored = false;

/// A handler, not SIG_IGN: child processes then get the default action again.
extern "C" void note_broken_pipe(int) {}

void write(std::string_view text) {
  clear_progress();
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
    throw StdoutError(errno);
}

void flush_stdout() {
  if (!std::cout.fail() && std::ferror(stdout) == 0)
    errno = 0;  // otherwise errno already has the reason
  if (!std::cout.flush() || std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
    throw StdoutError(errno != 0 ? errno : EIO);
}

}  // namespace

void warn(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) log("cde: warning: {}\n", shortened(warning));
}

void prepare_streams() {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(fd, F_GETFD) >= 0) continue;
    // open() takes the lowest free descriptor, which is this one. Errors show at the first read or
    // write.
    (void)!::open("/dev/null", fd == STDOUT_FILENO ? O_RDONLY : O_WRONLY);
  }
  std::signal(SIGCHLD, SIG_DFL);  // ignored, the system would keep no exit status of a child
  if (std::signal(SIGPIPE, note_broken_pipe) == SIG_IGN) {
    pipe_signal_ignored = true;
    std::signal(SIGPIPE, SIG_IGN);
  }
}

int exit_status_of(const std::function<int()>& work,
                   const std::function<void(const std::string&)>& complain) {
  try {
    const int status = work();
    flush_stdout();
    return status;
  } catch (const StdoutError& e) {
    if (e.number() == EPIPE && !pipe_signal_ignored) {
      std::signal(SIGPIPE, SIG_DFL);
      std::raise(SIGPIPE);
    }
    complain(e.what());
    return 2;
  } catch (const Error& e) {
    complain(e.what());
    return exit_status(e);
  } catch (const std::bad_alloc&) {
    complain("out of memory");
    return 2;
  } catch (const std::exception& e) {
    complain(fmt::format("internal error: {}", e.what()));
    return 2;
  }
}

void print(std::string_view text) {
  write(printable(text));
}

void print_json(const nlohmann::ordered_json& json, int indent) {
  write(json_text(json, indent) + "\n");
}

}  // namespace cde::cli
