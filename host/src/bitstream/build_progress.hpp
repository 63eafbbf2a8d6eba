// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <optional>
#include <string>
#include <string_view>

#include "cde/support/progress.hpp"

namespace cde {

/// Tells on stderr that a bitstream is built, in which phase, and for how long: as Progress where
/// that has a display, else a line as each phase begins. Private to the library.
class BuildProgress {
 public:
  /// `usual`: seconds that such builds take.
  BuildProgress(const std::string& what, double usual);
  /// With what the builder has printed so far.
  void operator()(std::chrono::duration<double> elapsed, std::string_view printed);
  void end(bool built);

  /// Whether any of these tells anything; a bitstream that cannot be built is an Error all the
  /// same.
  static void set_quiet(bool quiet);
  [[nodiscard]] static bool quiet();

  /// What the builder printed, without the lines that tell its phases.
  [[nodiscard]] static std::string without_phases(std::string_view printed);

 private:
  std::string phase_;
  double usual_;
  std::optional<Progress> line_;
  std::chrono::duration<double> elapsed_{};
};

}  // namespace cde
