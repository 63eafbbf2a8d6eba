// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "tui/tui_viewer.hpp"

namespace cde::wave::tui {

/// The terminal as it is before a full-screen program begins; puts it back if that ends without.
class Terminal {
 public:
  /// Of a process that only waits for the one that draws.
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  /// Modes, cursor and screen, whatever they are now.
  void restore() const;

 private:
  struct Modes;
  std::unique_ptr<Modes> modes_;
};

/// Whether characters are UTF-8 here, by the locale, which is taken over.
[[nodiscard]] bool locale_has_utf8();

/// Shows the viewer until it ends: 0, or the signal that ended it. Error kUsage if stdin or stdout
/// is no terminal, or one that is not known.
[[nodiscard]] int run(Viewer& viewer);
/// Error kUsage if stdin or stdout is no terminal.
void need_terminal();

}  // namespace cde::wave::tui
