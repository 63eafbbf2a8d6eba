// SPDX-License-Identifier: Apache-2.0
#include "cde/support/progress.hpp"

#include <fmt/format.h>
#include <signal.h>

namespace cde {
namespace {

ProgressDisplay& display() {
  static ProgressDisplay set;
  return set;
}

}  // namespace

void set_progress_display(ProgressDisplay to) {
  display() = std::move(to);
}

Progress::Progress(std::string what, bool quiet)
    : what_(std::move(what)), shown_(!quiet && display() != nullptr) {}

Progress::~Progress() {
  if (drawn_) display()("");
}

void Progress::operator()(double share) {
  const auto now = Clock::now();
  if (!shown_ || now - start_ < std::chrono::seconds(1)) return;
  if (now - last_ < std::chrono::milliseconds(200)) return;
  last_ = now;
  drawn_ = true;
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  std::string line = fmt::format("{} {:3.0f} %, {:.0f} s", what_, 100 * share, elapsed);
  if (share > 0.001) line += fmt::format(", about {:.0f} s left", elapsed * (1 - share) / share);
  display()(line);
}

Busy::Busy(std::string what, bool quiet) : what_(std::move(what)) {
  if (quiet || display() == nullptr) return;
  // The thread that works handles signals.
  sigset_t all, before;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_BLOCK, &all, &before);
  thread_ = std::thread([this] { show(); });
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

Busy::~Busy() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    end_ = true;
  }
  ended_.notify_one();
  thread_.join();
}

void Busy::show() {
  std::unique_lock lock(mutex_);
  for (unsigned seconds = 1;; ++seconds) {
    if (ended_.wait_for(lock, std::chrono::seconds(1), [this] { return end_; })) {
      if (seconds > 1) display()("");
      return;
    }
    display()(fmt::format("{}, {} s", what_, seconds));
  }
}

}  // namespace cde
