// SPDX-License-Identifier: Apache-2.0
#include "bitstream/build_progress.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <utility>

namespace cde {
namespace {

constexpr std::string_view kPhase = "phase ";  // of verilator/bitstream
constexpr const char* kAdvice = "first use of this configuration, kept for the next time";

std::atomic<bool> silent{false};

/// To stderr, which may be closed or full: that is no reason to end.
void print(const std::string& text) {
  if (silent) return;
  std::fputs(text.c_str(), stderr);
  std::fflush(stderr);
}

/// As much as fits into a line of the terminal: one that wraps could not be rewritten.
std::string fitted(std::string text) {
  winsize size{};
  const std::size_t width =
      ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20 ? size.ws_col : 80;
  if (text.size() >= width) text = text.substr(0, width - 4) + "...";
  return text;
}

}  // namespace

BuildProgress::BuildProgress(std::string what)
    : what_(std::move(what)), terminal_(::isatty(STDERR_FILENO) != 0) {
  print(fmt::format("cde: building bitstream {} ({})\n", what_, kAdvice));
}

void BuildProgress::operator()(std::chrono::duration<double> elapsed, std::string_view printed) {
  elapsed_ = elapsed;
  std::string phase = phase_;
  while (!printed.empty()) {
    const std::string_view line = printed.substr(0, printed.find('\n'));
    if (line.size() == printed.size()) break;  // not yet whole
    if (line.starts_with(kPhase)) phase = line.substr(kPhase.size());
    printed.remove_prefix(line.size() + 1);
  }
  const bool another = std::exchange(phase_, phase) != phase;
  if (phase_.empty()) return;
  if (terminal_)
    print(fmt::format("\r\033[K{}",
                      fitted(fmt::format("cde: {:.0f} s, {}", elapsed.count(), phase_))));
  else if (another)
    print(fmt::format("cde: {:.0f} s, {}\n", elapsed.count(), phase_));
}

void BuildProgress::set_quiet(bool quiet) {
  silent = quiet;
}

bool BuildProgress::quiet() {
  return silent;
}

void BuildProgress::end(bool built) {
  if (terminal_) print("\r\033[K");
  if (built) print(fmt::format("cde: built in {:.0f} s\n", elapsed_.count()));
}

std::string BuildProgress::without_phases(std::string_view printed) {
  std::string rest;
  while (!printed.empty()) {
    const std::size_t end = std::min(printed.find('\n'), printed.size() - 1) + 1;
    const std::string_view line = printed.substr(0, end);
    if (!line.starts_with(kPhase)) rest += line;
    printed.remove_prefix(end);
  }
  return rest;
}

}  // namespace cde
