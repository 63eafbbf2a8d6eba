// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// @file
/// Child processes without a shell.
namespace cde::process {

struct Result {
  int status = 0;  ///< exit status, 128 + signal if a signal ended it
  std::string output;
  std::uint64_t resident_kb = 0;  ///< peak memory
  bool timed_out = false;         ///< killed at its time limit
};

/// Runs a program and waits for it. The program is found through the absolute entries of PATH
/// unless its name has a slash. The program gets these entries alone. Result::output holds its
/// stdout and stderr; its stdin is empty. Error kBuild if it cannot be started. SIGINT, SIGTERM and
/// SIGHUP, unless ignored, end the program and its descendants. Then the signal takes its usual
/// effect on this process. If that does not end this process: error kInterrupted.
[[nodiscard]] Result run(const std::vector<std::string>& command);

using Seconds = std::chrono::duration<double>;

/// Runs code that may crash or never end in a child process, which is a copy of this one and ends
/// with it. `work` writes its answer to the descriptor, and Result::output returns it. If `work`
/// returns, the exit status is 0. A child that runs longer than `limit` is killed. Error kFile if
/// no process can be created.
[[nodiscard]] Result run_isolated(const std::function<void(int out)>& work,
                                  std::optional<Seconds> limit = {});

/// How a child of continue_in_child ended.
struct ChildExit {
  int status = 0;       ///< exit status, 128 + signal if a signal ended it
  int signal = 0;       ///< the signal that ended it; 0: none
  bool worked = false;  ///< `work` returned or threw
};

/// Runs `work` in a child process, a copy of this one, which continues in its place. In the child
/// this returns nothing, or throws what `work` throws. In the parent `relay` gets the descriptor
/// from which the child's stderr is read, and this returns how the child ended. With `forward`,
/// signals that end a process are passed to the child, which this process outlives. Error kFile if
/// no process can be created.
[[nodiscard]] std::optional<ChildExit> continue_in_child(
    const std::function<void()>& work, const std::function<void(int errors)>& relay, bool forward);

/// Writes all of the text. False if the reader takes no more.
bool write_all(int file, std::string_view text);

/// Runs a long program as `run` does. The program must end when its stdin closes: it closes when
/// this process ends, and on SIGINT, SIGTERM or SIGHUP unless these are ignored. After the program
/// has ended, the signal takes its usual effect on this process. If that does not end this process:
/// error kInterrupted. `watch` is called about five times per second with the time and the output
/// so far.
[[nodiscard]] Result run_watched(const std::vector<std::string>& command,
                                 const std::function<void(Seconds, std::string_view)>& watch);

/// A child that answers line by line on its stdin and stdout. Its stderr is this process's. The
/// destructor closes the stdin of a running child and waits for it.
class Conversation {
 public:
  /// Error kBuild if the program cannot be started.
  explicit Conversation(const std::vector<std::string>& command);
  ~Conversation();
  Conversation(const Conversation&) = delete;
  Conversation& operator=(const Conversation&) = delete;

  /// Sends a line. It is lost if the child has ended.
  void write(std::string_view line);
  /// The next line, without its line end; nothing once the child has closed its stdout.
  [[nodiscard]] std::optional<std::string> read();
  /// Closes the child's stdin and waits for its exit status, 128 + signal if a signal ended it.
  int wait();

 private:
  int to_ = -1, from_ = -1, child_ = -1;
  std::string unread_;
};

}  // namespace cde::process
