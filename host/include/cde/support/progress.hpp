// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
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

/// The share of a task that is done. The line appears after one second, with the time left.
class Progress {
 public:
  explicit Progress(std::string what, bool quiet = false);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// `share` is from 0 to 1.
  void operator()(double share);

 private:
  using Clock = std::chrono::steady_clock;
  std::string what_;
  bool shown_, drawn_ = false;
  Clock::time_point start_ = Clock::now(), last_ = start_;
};

/// A task whose share is unknown. A thread shows its name and time, once per second.
class Busy {
 public:
  explicit Busy(std::string what, bool quiet = false);
  ~Busy();
  Busy(const Busy&) = delete;
  Busy& operator=(const Busy&) = delete;

 private:
  void show();
  std::string what_;
  std::mutex mutex_;
  std::condition_variable ended_;
  bool end_ = false;
  std::thread thread_;
};

}  // namespace cde
