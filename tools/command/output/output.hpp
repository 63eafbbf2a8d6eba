// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

#include "cde/support/output_file.hpp"
#include "cde/support/progress.hpp"
#include "cde/support/shell_word.hpp"

/// Signals while files are written, and the terminal.
namespace cde::cli {

/// From now on SIGINT, SIGTERM, SIGHUP and SIGXCPU remove the unfinished files and end the process.
void remove_unfinished_on_signals();

/// While an object lives, the first SIGINT, SIGTERM or SIGHUP is only noted, so that finished work
/// can be written. A second one ends the process as usual. So do stdout and stderr if they then
/// take no output for half a second. At most one object may live at a time.
class Interrupts {
 public:
  Interrupts();
  ~Interrupts();
  Interrupts(const Interrupts&) = delete;
  Interrupts& operator=(const Interrupts&) = delete;

  /// The signal that came, or 0. The value stays after the object's end.
  [[nodiscard]] static int signal();
};

/// Rewrites the current line of stderr, which is a terminal. The text is cut where it would wrap,
/// and names in it are made printable. An empty text clears the line.
void rewrite_line(std::string_view text);

/// Draws the progress of library tasks on stderr, if it is a terminal.
void show_progress_on_terminal();

/// Whether a stream is a terminal that a person reads. The pseudo-terminal that Open MPI gives rank
/// 0 does not count.
[[nodiscard]] bool on_terminal(int stream);

}  // namespace cde::cli
