// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace cde::cli {

/// While it lives, a line on stderr says what is going on and for how long, from the first second
/// on; nothing unless stderr is a terminal. For what cannot say how far it is; what can has
/// Progress (output.hpp).
class Busy {
 public:
  explicit Busy(std::string what, bool quiet = false);
  ~Busy();
  Busy(const Busy&) = delete;
  Busy& operator=(const Busy&) = delete;

 private:
  void tell();
  std::string what_;
  std::mutex mutex_;
  std::condition_variable ended_;
  bool end_ = false;
  std::thread thread_;
};

}  // namespace cde::cli
