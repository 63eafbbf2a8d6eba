// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <optional>
#include <string>
#include <string_view>

#include "cde/support/progress.hpp"

namespace cde {

/// Reports on stderr that a simulation model is built, its phase, and the elapsed time. Uses
/// Progress if that has a display; else prints a line per phase. Private to the library.
class BuildProgress {
 public:
  /// `usual`: seconds that such a build takes.
  BuildProgress(const std::string& what, double usual);
  /// Updates with the builder's output so far.
  void operator()(std::chrono::duration<double> elapsed, std::string_view printed);
  void end(bool built);

  /// Whether progress is silent. Build failures are still an Error.
  static void set_quiet(bool quiet);
  [[nodiscard]] static bool quiet();

  /// The builder's output without its phase lines.
  [[nodiscard]] static std::string without_phases(std::string_view printed);

 private:
  std::string phase_;
  double usual_;
  std::optional<Progress> line_;
  std::chrono::duration<double> elapsed_{};
};

}  // namespace cde
