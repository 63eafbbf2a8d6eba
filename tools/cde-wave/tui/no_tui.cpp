// SPDX-License-Identifier: Apache-2.0
// Replaces the viewer in a build without ncurses.
#include "cde/support/error.hpp"
#include "commands/commands.hpp"
#include "tui/tui_terminal.hpp"

namespace cde::wave {

// No modes to restore: without the viewer the terminal is never changed.
struct tui::Terminal::Modes {};
tui::Terminal::Terminal() = default;
tui::Terminal::~Terminal() = default;
void tui::Terminal::restore() const {}

int terminal_viewer(const Request&) {
  throw Error(ErrorCode::kUsage,
              "cde wave tui: this program was built without ncurses; install libncurses-dev and "
              "build cde-wave again");
}

}  // namespace cde::wave
