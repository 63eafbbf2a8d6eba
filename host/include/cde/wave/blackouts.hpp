// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "cde/wave/trace.hpp"

namespace cde::wave {

/// Times within a window for which the simulation wrote no changes, clipped to the window. A
/// blackout that begins at the end of the window is left out.
[[nodiscard]] std::vector<Blackout> blackouts_in(const Trace& trace, std::uint64_t from,
                                                 std::uint64_t to);
/// Total length of the blackouts between two times.
[[nodiscard]] std::uint64_t dark_time(const std::vector<Blackout>& all, std::uint64_t from,
                                      std::uint64_t to);
/// Whether a time is in a blackout: from its begin to just before its end.
[[nodiscard]] bool is_dark(const std::vector<Blackout>& all, std::uint64_t time);

/// Begins and ends of blackouts in the order of time, for writers of other files.
class BlackoutsIn {
 public:
  BlackoutsIn(const Trace& trace, std::uint64_t from, std::uint64_t to);
  /// Reports each begin (false) and end (true) up to and including `time` that was not reported
  /// yet. The end of a blackout that lasts to the end of the window is not reported.
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
