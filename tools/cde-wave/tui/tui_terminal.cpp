// SPDX-License-Identifier: Apache-2.0
// The viewer on a terminal, with ncurses.
#include "tui/tui_terminal.hpp"

#define NCURSES_NOMACROS 1
#include <curses.h>
#include <langinfo.h>
#include <poll.h>
#include <sys/types.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <clocale>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cwchar>
#include <string>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "options/help.hpp"
#include "output/output.hpp"

namespace cde::wave::tui {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kFrame{40};
constexpr int kIdle = 500;  ///< milliseconds
constexpr short kCursorPair = 8, kSecondPair = 9, kDiffersPair = 10, kTitlePair = 11;
constexpr wint_t kSuspend = 26, kRedraw = 12;

struct Look {
  short colour;  ///< 0: the terminal's own colour
  attr_t attributes;
};

Look look_of(Ink ink) {
  switch (ink) {
    case Ink::kFaint:
      return {0, A_DIM};
    case Ink::kTitle:
    case Ink::kStatus:
      return {0, A_REVERSE};
    case Ink::kRuler:
      return {COLOR_CYAN, A_NORMAL};
    case Ink::kOther:
      return {COLOR_MAGENTA, A_NORMAL};
    case Ink::kValue:
    case Ink::kBusy:
      return {COLOR_YELLOW, A_NORMAL};
    case Ink::kWave:
      return {COLOR_GREEN, A_NORMAL};
    case Ink::kBus:
      return {COLOR_CYAN, A_NORMAL};
    case Ink::kUnknown:
      return {COLOR_RED, A_NORMAL};
    case Ink::kError:
      return {COLOR_RED, A_BOLD};
    case Ink::kHeading:
      return {0, A_BOLD};
    case Ink::kPlain:
    case Ink::kName:
      break;
  }
  return {0, A_NORMAL};
}

/// The ncurses screen. The terminal shows it while the object lives.
class Screen {
 public:
  Screen() : screen_(::newterm(nullptr, stdout, stdin)) {
    if (screen_ == nullptr) {
      const char* const name = std::getenv("TERM");  // NOLINT(concurrency-mt-unsafe)
      throw Error(ErrorCode::kUsage, "TERM is " + in_quotes(name ? name : "") +
                                         "; this kind of terminal is not known here");
    }
    // Control-C is a key. As a signal it would also end the waiting process.
    ::raw();
    ::noecho();
    ::nonl();
    ::keypad(stdscr, TRUE);
    ::nodelay(stdscr, TRUE);
    ::set_escdelay(50);
    colours_ = cli::may_colour(STDOUT_FILENO) && ::has_colors() && ::start_color() == OK;
    if (!colours_) return;
    const short ground = ::use_default_colors() == OK ? -1 : COLOR_BLACK;
    for (short c = 1; c < 8; ++c) ::init_pair(c, c, ground);
    ::init_pair(kCursorPair, COLOR_BLACK, COLOR_YELLOW);
    ::init_pair(kSecondPair, COLOR_BLACK, COLOR_MAGENTA);
    ::init_pair(kDiffersPair, COLOR_WHITE, COLOR_RED);
    ::init_pair(kTitlePair, COLOR_WHITE, COLOR_BLUE);
  }
  ~Screen() {
    // Clears the screen, for terminals without a second screen.
    ::werase(stdscr);
    ::wrefresh(stdscr);
    ::endwin();
    ::delscreen(screen_);
  }
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  void show(const Canvas& canvas) {
    for (std::size_t row = 0; row < canvas.rows(); ++row) {
      ::wmove(stdscr, static_cast<int>(row), 0);
      for (std::size_t at = 0; at < canvas.columns();) {
        const Style style = canvas.at(row, at).style;
        std::wstring text;
        for (; at < canvas.columns() && canvas.at(row, at).style == style; ++at) {
          const auto c = static_cast<wchar_t>(canvas.at(row, at).c);
          if (c != 0) text.push_back(::wcwidth(c) < 0 ? L'?' : c);
        }
        take(style);
        ::waddnwstr(stdscr, text.c_str(), static_cast<int>(text.size()));
      }
    }
    const bool caret = canvas.caret_column < canvas.columns();
    ::curs_set(caret ? 1 : 0);
    if (caret)
      ::wmove(stdscr, static_cast<int>(canvas.caret_row), static_cast<int>(canvas.caret_column));
    ::wrefresh(stdscr);
  }
  static void redraw() { ::clearok(stdscr, TRUE); }

 private:
  void take(const Style& style) const {
    Look look = look_of(style.ink);
    attr_t attributes = look.attributes;
    short pair = look.colour;
    if (style.chosen) attributes |= A_REVERSE;
    if (style.differs) attributes |= A_BOLD | (colours_ ? 0 : A_UNDERLINE);
    if (colours_) {
      if (style.ink == Ink::kTitle || style.ink == Ink::kStatus) {
        pair = kTitlePair;
        attributes = A_BOLD;
      }
      if (style.differs) pair = kDiffersPair;
      if (style.second) pair = kSecondPair;
      if (style.cursor) pair = kCursorPair;
    } else {
      pair = 0;
      if (style.cursor || style.second) attributes |= A_REVERSE;
      if (style.second) attributes |= A_UNDERLINE;
    }
    ::wattr_set(stdscr, attributes, pair, nullptr);
  }

  SCREEN* screen_;
  bool colours_ = false;
};

Key key_of(int kind, wint_t c) {
  if (kind != KEY_CODE_YES) {
    if (c == L'\r') return key::kEnter;
    if (c == 127 || c == 8) return key::kBackspace;
    return static_cast<Key>(c);
  }
  switch (c) {
    case KEY_UP:
      return key::kUp;
    case KEY_DOWN:
      return key::kDown;
    case KEY_LEFT:
      return key::kLeft;
    case KEY_RIGHT:
      return key::kRight;
    case KEY_SLEFT:
      return key::kShiftLeft;
    case KEY_SRIGHT:
      return key::kShiftRight;
    case KEY_HOME:
      return key::kHome;
    case KEY_END:
      return key::kEnd;
    case KEY_PPAGE:
      return key::kPageUp;
    case KEY_NPAGE:
      return key::kPageDown;
    case KEY_DC:
      return key::kDelete;
    case KEY_BACKSPACE:
      return key::kBackspace;
    case KEY_ENTER:
      return key::kEnter;
    case KEY_F(1):
      return key::kF1;
    default:
      return key::kOther;
  }
}

void fit(Viewer& viewer) {
  viewer.resize(static_cast<std::size_t>(::getmaxx(stdscr)),
                static_cast<std::size_t>(::getmaxy(stdscr)));
}

/// Stops the whole process group, as control-Z does. After a resume the function continues.
void suspend() {
  ::endwin();
  ::kill(0, SIGTSTP);
  ::wrefresh(stdscr);
}

/// Takes all pending keys. Returns false to end the viewer.
bool take_keys(Viewer& viewer, bool& any) {
  wint_t c = 0;
  for (int kind = ::wget_wch(stdscr, &c); kind != ERR; kind = ::wget_wch(stdscr, &c)) {
    any = true;
    if (kind == KEY_CODE_YES && c == KEY_RESIZE) {
      fit(viewer);
      Screen::redraw();
    } else if (kind != KEY_CODE_YES && c == kRedraw) {
      Screen::redraw();
    } else if (kind != KEY_CODE_YES && c == kSuspend) {
      suspend();
    } else if (!viewer.press(key_of(kind, c))) {
      return false;
    }
  }
  return true;
}

}  // namespace

bool locale_has_utf8() {
  // Only LC_CTYPE: numbers do not depend on the locale.
  return std::setlocale(LC_CTYPE, "") != nullptr &&  // NOLINT(concurrency-mt-unsafe)
         std::string(::nl_langinfo(CODESET)) == "UTF-8";
}

void need_terminal() {
  for (const auto& [stream, name] : {std::pair{STDIN_FILENO, "stdin"}, {STDOUT_FILENO, "stdout"}})
    if (::isatty(stream) == 0)
      throw Error(ErrorCode::kUsage,
                  std::string("cde wave tui needs a terminal, but ") + name +
                      " is none; use cde wave show for text, or cde wave serve for a page");
}

int run(Viewer& viewer) {
  const cli::Interrupts interrupts;
  Screen screen;
  fit(viewer);
  pollfd input{STDIN_FILENO, POLLIN, 0};
  for (unsigned empty = 0; empty < 100;) {
    const auto begin = Clock::now();
    bool more = true;
    // Work that takes less than a frame is drawn together. Keys come first.
    while ((more = viewer.work()) && Clock::now() - begin < kFrame && ::poll(&input, 1, 0) == 0) {
    }
    screen.show(viewer.draw());
    // The timeout lets a signal that arrived just before take effect without a key.
    const int ready = ::poll(&input, 1, more ? 0 : kIdle);
    if (cli::Interrupts::signal() != 0) return cli::Interrupts::signal();
    if (ready > 0 && (input.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0) return SIGHUP;
    bool any = false;
    if (!take_keys(viewer, any)) return 0;
    // A terminal that has closed is readable, but has no data.
    empty = ready > 0 && !any ? empty + 1 : 0;
  }
  return SIGHUP;
}

}  // namespace cde::wave::tui
