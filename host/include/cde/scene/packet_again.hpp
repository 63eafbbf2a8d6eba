// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>

#include "cde/check/failure.hpp"
#include "cde/scene/scene_runner.hpp"

namespace cde {

/// The packet of a primary in a frame of a scene.
struct PacketAgain {
  const Scene& scene;
  const Plan& plan;
  const RunnerOptions& options;
  std::uint32_t frame = 0;
  std::size_t query = 0;
  std::uint32_t primary = 0;
};
/// Runs the frames from `first` to that one on a card that writes waves of the packet. `sink`
/// receives all records of the query in that frame. Returns the query's figures.
QueryFrame run_packet(const PacketAgain& packet, std::uint32_t first, const std::string& file,
                      const TraceOptions& which, const RecordSink& sink);

/// A record of a scene that differs from the reference.
struct RunFailure {
  const Scene& scene;
  const Plan& plan;
  RunnerOptions options;    ///< as in the run
  std::uint32_t first = 0;  ///< first frame of the run
  std::uint32_t frame = 0;  ///< frame of the record
  std::size_t query = 0;
  Difference difference;
  std::string message, repeat;  ///< message of the verb; its own command
};
/// The failure. Its rerun first runs the record's packet alone in its frame. If that gives another
/// record, it runs all earlier frames as well. `run` and what it refers to must outlive the
/// failure.
[[nodiscard]] Failure failure_of(const RunFailure& run);

}  // namespace cde
