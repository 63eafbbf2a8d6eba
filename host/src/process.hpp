#pragma once
#include <chrono>
#include <functional>
#include <string>
#include <vector>

/// Child processes without a shell. Private to the library.
namespace cde::process {

struct Result {
  int status = 0;  ///< exit status, 128 + signal if a signal ended it
  std::string output;
};

/// Runs a program found through PATH (or given with a slash) and waits for it. `output` is what it
/// wrote to stdout, and to stderr if `with_errors`; stdin is empty. `tick` is called about five
/// times a second with the time so far. Error kBuild if it cannot be started.
[[nodiscard]] Result run(const std::vector<std::string>& command, bool with_errors,
                         const std::function<void(std::chrono::duration<double>)>& tick = {});

}  // namespace cde::process
