// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <condition_variable>
#include <functional>
#include <string>
#include <string_view>
#include <thread>

/// @file
/// How far a long task is. The library draws nothing itself: a program sets a display.
namespace cde {

/// Shows one line of text in place of the line before; an empty text clears it.
using ProgressDisplay = std::function<void(std::string_view)>;
/// Sets the display of this process; without one, progress is not shown. Call it before threads
/// start.
void set_progress_display(ProgressDisplay display);
[[nodiscard]] bool has_progress_display();
/// Clears the line before other text is printed. It comes back within a second.
void clear_progress();

/// Shows how far a task is, its time so far, and its time left. A thread updates the line once per
/// second, after the first second. For nested tasks it shows the innermost one.
class Progress {
 public:
  explicit Progress(std::string what, bool quiet = false);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Sets the share that is done, from 0 to 1. The time left assumes that the rest goes at the pace
  /// so far. Until the first share above 0 the line shows only the elapsed time.
  void operator()(double share);
  /// Sets the share, and names the step that begins now.
  void operator()(double share, std::string step);
  /// Names the step that begins now, for a task that usually takes this many seconds.
  void expect(double seconds, std::string step);

 private:
  void run_display();
  [[nodiscard]] double elapsed() const;
  [[nodiscard]] std::string line() const;

  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::string what_, step_;
  double share_ = 0, seconds_ = 0;  ///< 0: unknown. Seconds are for the whole task
  bool end_ = false;
  std::condition_variable ended_;
  std::thread thread_;
};

}  // namespace cde
