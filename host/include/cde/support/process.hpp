// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Child processes without a shell.
namespace cde::process {

struct Result {
  int status = 0;  ///< exit status, 128 + signal if a signal ended it
  std::string output;
  std::uint64_t resident_kb = 0;  ///< peak memory
  bool timed_out = false;         ///< ended because its time was over
};

/// Runs a program found through PATH (or given with a slash) and waits for it. `output` is what it
/// wrote to stdout and stderr; stdin is empty. Error kBuild if it cannot be started.
[[nodiscard]] Result run(const std::vector<std::string>& command);

using Seconds = std::chrono::duration<double>;

/// Runs code that may crash or run for ever in a child process, a copy of this one, which ends with
/// this one. `work` writes its answer to the descriptor; a return from it is exit status 0.
/// Result::output is the answer. A child that runs longer than `limit` is killed. Error kFile if no
/// process can be made.
[[nodiscard]] Result isolated(const std::function<void(int out)>& work,
                              std::optional<Seconds> limit = {});

/// How a child of continue_in_child ended.
struct Ended {
  int status = 0;       ///< exit status, 128 + signal if a signal ended it
  int signal = 0;       ///< that ended it; 0: none
  bool worked = false;  ///< `work` came to its end, or threw
};

/// Runs `work` in a child process, a copy of this one, which then goes on in place of it: there
/// this returns nothing, or throws, as `work` does. Here `relay` gets the descriptor that the
/// child's stderr is read from, and how the child ended is returned. `forward`: signals that end a
/// process are for the child, which this process outlives. Error kFile if no process can be made.
[[nodiscard]] std::optional<Ended> continue_in_child(const std::function<void()>& work,
                                                     const std::function<void(int errors)>& relay,
                                                     bool forward);

/// Writes all of it; false if the reader takes no more.
bool write_all(int file, std::string_view text);

/// Runs a program as `run` does that may run long, and that ends when its stdin does: with this
/// process, whatever ends that, and on SIGINT, SIGTERM or SIGHUP unless they are ignored. Such a
/// signal takes its course here once the program is gone; where it does not end the process, error
/// kInterrupted. `watch` is called about five times a second with the time and the output so far.
[[nodiscard]] Result attend(const std::vector<std::string>& command,
                            const std::function<void(Seconds, std::string_view)>& watch);

/// A child that answers line by line on its stdin and stdout; its stderr is this process's. A child
/// that still runs at the end of this object loses its stdin, and is waited for.
class Conversation {
 public:
  /// Error kBuild if the program cannot be started.
  explicit Conversation(const std::vector<std::string>& command);
  ~Conversation();
  Conversation(const Conversation&) = delete;
  Conversation& operator=(const Conversation&) = delete;

  /// Sends a line. What a child that has ended does not read is lost.
  void write(std::string_view line);
  /// The next line, without its end; nothing once the child has closed its stdout.
  [[nodiscard]] std::optional<std::string> read();
  /// Closes the child's stdin and waits for its exit status, 128 + signal if a signal ended it.
  int wait();

 private:
  int to_ = -1, from_ = -1, child_ = -1;
  std::string unread_;
};

}  // namespace cde::process
