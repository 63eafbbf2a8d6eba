// SPDX-License-Identifier: Apache-2.0
#include "output/busy.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>

#include "output/output.hpp"

namespace cde::cli {

Busy::Busy(std::string what, bool quiet) : what_(std::move(what)) {
  if (quiet || ::isatty(STDERR_FILENO) == 0) return;
  // Signals are for the thread that works.
  sigset_t all, before;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_BLOCK, &all, &before);
  thread_ = std::thread([this] { tell(); });
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

void Busy::tell() {
  std::unique_lock lock(mutex_);
  for (unsigned seconds = 1;; ++seconds) {
    if (ended_.wait_for(lock, std::chrono::seconds(1), [this] { return end_; })) {
      if (seconds > 1) rewrite_line("");
      return;
    }
    rewrite_line(fmt::format("{}, {} s", what_, seconds));
  }
}

}  // namespace cde::cli
