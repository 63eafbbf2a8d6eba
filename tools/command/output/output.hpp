// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

#include "cde/support/output_file.hpp"
#include "cde/support/progress.hpp"
#include "cde/support/shell_word.hpp"

/// Signals while files are written, and the terminal.
namespace cde::cli {

/// From now on SIGINT, SIGTERM and SIGHUP remove the files that are not finished, and end the
/// process.
void remove_unfinished_on_signals();

/// While it lives, the first SIGINT, SIGTERM or SIGHUP is only noted, so that what is done can be
/// written; a second one ends the process as without it. One at a time.
class Interrupts {
 public:
  Interrupts();
  ~Interrupts();
  Interrupts(const Interrupts&) = delete;
  Interrupts& operator=(const Interrupts&) = delete;

  /// The signal that came, or 0; stays after the object's end.
  [[nodiscard]] static int signal();
};

/// Rewrites the line of stderr, which is a terminal: cut where it would wrap, and names in it
/// printable. An empty text clears it.
void rewrite_line(std::string_view text);

/// Draws the progress of library tasks on stderr, if it is a terminal.
void show_progress_on_terminal();

/// Whether somebody looks at a stream: a terminal, but not the one that Open MPI puts between rank
/// 0 and where its output goes.
[[nodiscard]] bool on_terminal(int stream);

}  // namespace cde::cli
