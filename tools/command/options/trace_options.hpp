// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "cde/card/trace.hpp"
#include "options/cli_fwd.hpp"

namespace cde::cli {

/// What verbs that simulate are asked about waves.
struct TraceRequest {
  std::string file, window;
  std::vector<std::string> scopes;

  [[nodiscard]] bool wanted() const { return !file.empty(); }
  /// Error kUsage if the name of the file is not that of waves.
  void check() const;
  [[nodiscard]] TraceOptions options() const;
};

/// Says that a signal stopped the run, and until when there are waves.
void say_stopped(const std::string& file);

/// --trace, --trace-window and --trace-scope; `what` is the help of --trace.
void add_trace_options(CLI::App& verb, TraceRequest& request, const std::string& what);

}  // namespace cde::cli
