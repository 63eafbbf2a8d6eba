// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "cde/wave/trace.hpp"

namespace cde::wave {

/// Where the simulation wrote no changes within a window, cut to the window. One that begins where
/// the window ends is left out.
[[nodiscard]] std::vector<Blackout> blackouts_in(const Trace& trace, std::uint64_t from,
                                                 std::uint64_t to);
/// How much of the time between two times that is.
[[nodiscard]] std::uint64_t dark_time(const std::vector<Blackout>& all, std::uint64_t from,
                                      std::uint64_t to);
/// Whether a time is in one: from its begin to just before its end.
[[nodiscard]] bool is_dark(const std::vector<Blackout>& all, std::uint64_t time);

/// Begins and ends of blackouts in the order of time, for those who write them again.
class BlackoutsIn {
 public:
  BlackoutsIn(const Trace& trace, std::uint64_t from, std::uint64_t to);
  /// Tells of each begin (false) and end (true) up to and with `time` that was not told yet. The
  /// end of one that lasts to the end of the window is not told.
  void until(std::uint64_t time, const std::function<void(std::uint64_t, bool)>& tell);

 private:
  struct Turn {
    std::uint64_t time;
    bool on;
  };
  std::vector<Turn> turns_;
  std::size_t next_ = 0;
};

}  // namespace cde::wave
