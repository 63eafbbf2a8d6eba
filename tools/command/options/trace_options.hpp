// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "cde/card/trace.hpp"
#include "options/cli_fwd.hpp"

namespace cde::cli {

/// The options about waves of a verb that simulates.
struct TraceRequest {
  std::string file, window;
  std::vector<std::string> scopes;

  [[nodiscard]] bool wanted() const { return !file.empty(); }
  /// Error kUsage if the file's name does not end in .fst.
  void check() const;
  [[nodiscard]] TraceOptions options() const;
};

/// Prints that a signal stopped the run, and the time of the last waves.
void say_stopped(const std::string& file, std::optional<std::uint64_t> last);

/// --trace, --trace-window and --trace-scope; `what` is the help of --trace.
void add_trace_options(CLI::App& verb, TraceRequest& request, const std::string& what);

}  // namespace cde::cli
