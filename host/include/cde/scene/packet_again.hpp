// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>

#include "cde/check/failure.hpp"
#include "cde/scene/player.hpp"

namespace cde {

/// The packet of a primary in a frame of a scene.
struct PacketAgain {
  const Scene& scene;
  const Plan& plan;
  const PlayOptions& options;
  std::uint32_t frame = 0;
  std::size_t query = 0;
  std::uint32_t primary = 0;
};
/// Plays the frames from `first` to that one on a card that writes waves of the packet. `sink`
/// takes all records of the query in the frame, and what it was comes back.
QueryFrame play_packet(const PacketAgain& packet, std::uint32_t first, const std::string& file,
                       const TraceOptions& which, const RecordSink& sink);

/// A record of a scene that differs.
struct RunFailure {
  const Scene& scene;
  const Plan& plan;
  PlayOptions options;      ///< as it was played
  std::uint32_t first = 0;  ///< frame that was played first
  std::uint32_t frame = 0;  ///< and the one that it is of
  std::size_t query = 0;
  Difference difference;
  std::string message, repeat;  ///< as the verb tells it, and its own command
};
/// The failure, whose rerun plays the record's packet in its frame alone. If that gives another
/// record, it plays all frames before. `run` and what it refers to must outlive the failure.
[[nodiscard]] Failure failure_of(const RunFailure& run);

}  // namespace cde
