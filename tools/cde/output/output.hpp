// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <string>
#include <string_view>

#include "cde/support/output_file.hpp"

/// Signals while files are written, and progress on a terminal.
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

/// One line on stderr that is rewritten in place, from the first second on; nothing unless stderr
/// is a terminal. For what can say how far it is; what cannot has Busy (busy.hpp).
class Progress {
 public:
  explicit Progress(std::string what, bool quiet = false);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void operator()(double share);

 private:
  using Clock = std::chrono::steady_clock;
  std::string what_;
  bool shown_, drawn_ = false;
  Clock::time_point start_ = Clock::now(), last_ = start_;
};

/// Whether somebody looks at a stream: a terminal, but not the one that Open MPI puts between rank
/// 0 and where its output goes.
[[nodiscard]] bool on_terminal(int stream);

/// A word as a shell reads it back.
[[nodiscard]] std::string shell_word(const std::string& word);

}  // namespace cde::cli
