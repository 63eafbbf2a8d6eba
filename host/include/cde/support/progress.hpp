// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <condition_variable>
#include <functional>
#include <string>
#include <string_view>
#include <thread>

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

/// How far a task is, how long it has taken, and how long it will take. A thread shows it once per
/// second, after the first second. If tasks are nested, it shows the innermost task.
class Progress {
 public:
  explicit Progress(std::string what, bool quiet = false);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// The share that is done, from 0 to 1: the time left is that of the rest at the pace so far.
  /// Until the first share above 0 the line has only the time that has passed.
  void operator()(double share);
  /// The share, and the step that begins now.
  void operator()(double share, std::string step);
  /// The step that begins now, of a task that usually takes so many seconds.
  void usual(double seconds, std::string step);

 private:
  void show();
  [[nodiscard]] double elapsed() const;
  [[nodiscard]] std::string line() const;

  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::string what_, step_;
  double share_ = 0, seconds_ = 0;  ///< 0: unknown. Seconds: of the whole task
  bool end_ = false;
  std::condition_variable ended_;
  std::thread thread_;
};

}  // namespace cde
