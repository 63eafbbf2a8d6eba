// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <mpi.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <thread>

namespace cde::mpi {

/// Open MPI busy-waits, which takes a core away from computation. This class sleeps between polls.
class Patience {
 public:
  void wait() {
    std::this_thread::sleep_for(pause_);
    if (pause_ < kLongest) pause_ *= 2;
  }
  void reset() { pause_ = kShortest; }

 private:
  static constexpr std::chrono::microseconds kShortest{20}, kLongest{1000};
  std::chrono::microseconds pause_ = kShortest;
};

inline void finish(MPI_Request& request) {
  Patience patience;
  for (int done = 0; MPI_Test(&request, &done, MPI_STATUS_IGNORE), done == 0;) patience.wait();
}

/// Puts a number at the head of a message. All machines of a run have the same version of the same
/// program, so the layout is the same.
template <class T>
void put_number(std::string& to, T number) {
  to.append(reinterpret_cast<const char*>(&number), sizeof number);
}
template <class T>
T take_number(const std::string& from, std::size_t at) {
  T number{};
  std::char_traits<char>::copy(reinterpret_cast<char*>(&number), from.data() + at, sizeof number);
  return number;
}

}  // namespace cde::mpi
