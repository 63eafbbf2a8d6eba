// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "tui/tui_viewer.hpp"

namespace cde::wave::tui {

/// Saves the state of the terminal before a full-screen program begins, and can restore it.
class Terminal {
 public:
  /// For a process that waits for the process that draws.
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  /// Restores modes, cursor and screen from any state.
  void restore() const;

 private:
  struct Modes;
  std::unique_ptr<Modes> modes_;
};

/// Sets the locale's character type. Returns whether it is UTF-8.
[[nodiscard]] bool locale_has_utf8();

/// Shows the viewer until it ends. Returns 0, or the signal that ended it. Error kUsage if stdin or
/// stdout is not a terminal, or its kind is unknown.
[[nodiscard]] int run(Viewer& viewer);
/// Error kUsage if stdin or stdout is not a terminal.
void need_terminal();

}  // namespace cde::wave::tui
