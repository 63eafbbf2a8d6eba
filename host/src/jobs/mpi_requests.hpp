// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <mpi.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <thread>

namespace cde::mpi {

/// Open MPI waits by asking again and again, which takes a core from whoever computes on it.
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

/// Numbers at the head of a message, the same on all machines of a run: they have one version of
/// one program.
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
