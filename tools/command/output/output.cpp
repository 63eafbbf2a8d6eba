// SPDX-License-Identifier: Apache-2.0
#include "output/output.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <csignal>
#include <cstdlib>
#include <cstring>

#include "cde/support/message.hpp"

namespace cde::cli {
namespace {

constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};

/// Whether output would wait: the stream is a terminal that is stopped (^S), or a full pipe.
bool waits(int stream) {
  pollfd one{stream, POLLOUT, 0};
  return ::poll(&one, 1, 0) == 0;
}

extern "C" void remove_unfinished(int signal) {
  OutputFile::remove_unfinished();
  // After ^C and a line of progress.
  if (::isatty(STDERR_FILENO) != 0 && !waits(STDERR_FILENO)) (void)!::write(STDERR_FILENO, "\n", 1);
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

/// A signal that was ignored when the program started (nohup, a shell's `&`) stays ignored.
void handle(int signal, void (*handler)(int)) {
  if (std::signal(signal, handler) == SIG_IGN) std::signal(signal, SIG_IGN);
}

void install_removal() {
  static const bool installed = [] {
    for (const int signal : kSignals) handle(signal, remove_unfinished);
    handle(SIGXCPU, remove_unfinished);
    return true;
  }();
  (void)installed;
}

volatile std::sig_atomic_t noted = 0;

/// SIGALRM comes once after so many microseconds.
void alarm_after(suseconds_t time) {
  const itimerval once{{}, {0, time}};
  ::setitimer(ITIMER_REAL, &once, nullptr);
}

constexpr suseconds_t kPatience = 500'000;

/// After the first signal, the process goes on as long as stdout and stderr take output.
extern "C" void end_if_output_waits(int) {
  if (waits(STDOUT_FILENO) || waits(STDERR_FILENO))
    remove_unfinished(noted);
  else
    alarm_after(kPatience);
}

extern "C" void note(int signal) {
  noted = signal;
  for (const int other : kSignals) handle(other, remove_unfinished);
  std::signal(SIGALRM, end_if_output_waits);
  alarm_after(kPatience);
}

}  // namespace

void rewrite_line(std::string_view text) {
  winsize size{};
  const std::size_t width =
      ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20 ? size.ws_col : 80;
  std::string line = printable_name(text);
  if (line.size() >= width) {
    std::size_t end = width - 4;
    while (end > 0 && (static_cast<unsigned char>(line[end]) & 0xC0) == 0x80) --end;  // whole UTF-8
    line = line.substr(0, end) + "...";
  }
  // Not with log(), which would print control characters as text.
  std::fputs(("\r\033[K" + line).c_str(), stderr);
  std::fflush(stderr);
}

void remove_unfinished_on_signals() {
  install_removal();
}

Interrupts::Interrupts() {
  install_removal();
  for (const int signal : kSignals) handle(signal, note);
}

Interrupts::~Interrupts() {
  for (const int signal : kSignals) handle(signal, remove_unfinished);
}

int Interrupts::signal() {
  return noted;
}

void show_progress_on_terminal() {
  if (::isatty(STDERR_FILENO) != 0) set_progress_display(rewrite_line);
}

bool on_terminal(int stream) {
  return ::isatty(stream) != 0 && std::getenv("OMPI_COMM_WORLD_SIZE") == nullptr;
}

}  // namespace cde::cli
