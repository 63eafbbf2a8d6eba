// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "cde/card/board.hpp"
#include "cde/card/fault.hpp"

/// Applies faults at their time. Private to the scene runner.
namespace cde::scene_runner {

class Faults {
 public:
  Faults(Board& board, std::vector<ScheduledFault> all)
      : board_(&board), all_(std::move(all)), done_(all_.size(), false) {}

  /// Starts the bus faults of a frame.
  void start(std::uint32_t frame);
  /// Flips the DDR bits of a frame, whose passes read this many words. Error kUsage if that is too
  /// few.
  void flip(std::uint32_t frame, std::uint64_t words);

  [[nodiscard]] const std::vector<bool>& done() const { return done_; }

 private:
  void flip(const ScheduledFault& fault, std::uint64_t stream, std::uint64_t words);
  Board* board_;
  std::vector<ScheduledFault> all_;
  std::vector<bool> done_;
};

}  // namespace cde::scene_runner
