// SPDX-License-Identifier: Apache-2.0
// cde wave tui: a viewer of waves on a terminal.
#include <csignal>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "cde/support/error.hpp"
#include "commands/commands.hpp"
#include "tui/tui_terminal.hpp"

namespace cde::wave {
namespace {

/// The first place of the cursor: the time of --around, else the failure, else the begin of the
/// window.
std::uint64_t first_cursor(const Request& r, Times& times, const Window& w) {
  if (!r.around.empty()) return times.parse(r.around);
  try {
    const std::uint64_t fail = times.parse("fail");
    if (fail >= w.from && fail <= w.to) return fail;
  } catch (const Error&) {
    // the file has no failure time
  }
  return w.from;
}

}  // namespace

int terminal_viewer(const Request& r) {
  tui::need_terminal();
  const bool utf8 = tui::locale_has_utf8();
  Trace trace(r.file);
  std::unique_ptr<Trace> other;
  if (!r.other.empty()) other = std::make_unique<Trace>(r.other);
  Times times(trace, r.clock);
  warn_if_cut(trace, times);
  if (other) warn_if_cut(*other, Times(*other, r.clock));
  const Window w = window(r, trace, times);
  tui::Begin begin{r.clock, r.default_form(), r.ascii || !utf8, {w.from, w.to}, 0, {}};
  begin.cursor = first_cursor(r, times, w);
  begin.views = r.words.empty() ? views(trace, "*", r.default_form()) : views(r, trace, 0);
  tui::Viewer viewer(trace, other.get(), std::move(begin));
  if (const int signal = tui::run(viewer); signal != 0) {
    // Ends by the same signal, as a caller expects.
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
  return 0;
}

}  // namespace cde::wave
