// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

/// Child processes without a shell. Private to the library.
namespace cde::process {

struct Result {
  int status = 0;  ///< exit status, 128 + signal if a signal ended it
  std::string output;
};

/// Runs a program found through PATH (or given with a slash) and waits for it. `output` is what it
/// wrote to stdout and stderr; stdin is empty. Error kBuild if it cannot be started.
[[nodiscard]] Result run(const std::vector<std::string>& command);

using Seconds = std::chrono::duration<double>;

/// The same for a program that may run long, and that ends when its stdin does: with this process,
/// whatever ends that, and on SIGINT, SIGTERM or SIGHUP unless they are ignored. Such a signal
/// takes its course here once the program is gone; where it does not end the process, error
/// kInterrupted. `watch` is called about five times a second with the time and the output so far.
[[nodiscard]] Result attend(const std::vector<std::string>& command,
                            const std::function<void(Seconds, std::string_view)>& watch);

}  // namespace cde::process
