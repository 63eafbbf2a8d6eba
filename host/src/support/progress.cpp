// SPDX-License-Identifier: Apache-2.0
#include "cde/support/progress.hpp"

#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <mutex>
#include <utility>
#include <vector>

namespace cde {
namespace {

ProgressDisplay& display() {
  static ProgressDisplay set;
  return set;
}

std::mutex mutex;                    // guards all tasks, which share the line
std::vector<const Progress*> tasks;  // visible tasks, innermost last
bool drawn = false;                  // whether a line is on the display

void clear() {
  if (std::exchange(drawn, false)) display()("");
}

std::string time_text(double seconds) {
  return seconds < 120 ? fmt::format("{:.0f} s", seconds) : fmt::format("{:.0f} min", seconds / 60);
}

}  // namespace

void set_progress_display(ProgressDisplay to) {
  display() = std::move(to);
}

bool has_progress_display() {
  return display() != nullptr;
}

void clear_progress() {
  const std::lock_guard lock(mutex);
  clear();
}

Progress::Progress(std::string what, bool quiet) : what_(std::move(what)) {
  if (quiet || display() == nullptr) return;
  const std::lock_guard lock(mutex);
  tasks.push_back(this);
  // The working thread handles signals, not the display thread.
  sigset_t all, before;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_BLOCK, &all, &before);
  thread_ = std::thread([this] { run_display(); });
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

Progress::~Progress() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex);
    end_ = true;
    std::erase(tasks, this);
    clear();
  }
  ended_.notify_one();
  thread_.join();
}

void Progress::operator()(double share) {
  if (!thread_.joinable()) return;
  const std::lock_guard lock(mutex);
  if (share == share_) return;
  share_ = std::min(share, 1.0);
  seconds_ = share_ > 0.001 ? elapsed() / share_ : 0;
}

void Progress::operator()(double share, std::string step) {
  {
    const std::lock_guard lock(mutex);
    step_ = std::move(step);
  }
  (*this)(share);
}

void Progress::expect(double seconds, std::string step) {
  const std::lock_guard lock(mutex);
  seconds_ = seconds;
  step_ = std::move(step);
}

double Progress::elapsed() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

std::string Progress::line() const {
  std::string text = what_;
  if (!step_.empty()) text += ", " + step_;
  text += share_ > 0 ? fmt::format(" {:3.0f} %, ", 100 * share_) : ", ";
  text += time_text(elapsed());
  if (elapsed() < seconds_) text += fmt::format(", about {} left", time_text(seconds_ - elapsed()));
  return text;
}

void Progress::run_display() {
  std::unique_lock lock(mutex);
  while (!ended_.wait_for(lock, std::chrono::seconds(1), [this] { return end_; })) {
    if (tasks.back() != this) continue;
    drawn = true;
    display()(line());
  }
}

}  // namespace cde
