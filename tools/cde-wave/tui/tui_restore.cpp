// SPDX-License-Identifier: Apache-2.0
// Restores a terminal that a full-screen program left changed.
#define NCURSES_NOMACROS 1
#include <curses.h>
#include <fcntl.h>
#include <termios.h>
#include <unistd.h>

#include <cstdio>
#include <string>

#include "cde/support/process.hpp"
#include "tui/tui_terminal.hpp"
// Included last, because its macros have common names.
#include <term.h>

namespace cde::wave::tui {
namespace {

std::string collected;

int collect(int c) {
  collected.push_back(static_cast<char>(c));
  return c;
}

}  // namespace

struct Terminal::Modes {
  termios modes{};
  bool known = false;
};

Terminal::Terminal() : modes_(std::make_unique<Modes>()) {
  modes_->known = ::isatty(STDOUT_FILENO) != 0 && ::tcgetattr(STDOUT_FILENO, &modes_->modes) == 0;
}
Terminal::~Terminal() = default;

void Terminal::restore() const {
  if (!modes_->known) return;
  ::tcsetattr(STDOUT_FILENO, TCSANOW, &modes_->modes);
  int error = 0;
  if (::setupterm(nullptr, STDOUT_FILENO, &error) != OK) return;
  collected.clear();
  for (const char* const name : {"sgr0", "rmkx", "cnorm", "rmcup"}) {
    const char* const text = ::tigetstr(name);
    if (text != nullptr && text != reinterpret_cast<const char*>(-1)) ::tputs(text, 1, collect);
  }
  // Opened again, because a terminal that is stopped (^S) would make the writer wait.
  const int terminal = ::open("/proc/self/fd/1", O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  if (terminal < 0) return;
  process::write_all(terminal, collected);
  ::close(terminal);
}

}  // namespace cde::wave::tui
