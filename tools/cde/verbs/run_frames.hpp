// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "cde/jobs/work_distributor.hpp"
#include "cde/scene/scene.hpp"
#include "cde/scene/scene_runner.hpp"
#include "verbs/run_records.hpp"

/// Frames of `cde run` as text: records and JSON.
namespace cde::cli {

/// The entry of a frame in run.json.
[[nodiscard]] nlohmann::ordered_json frame_json(const Scene& scene, std::uint32_t frame,
                                                double wall_seconds,
                                                const std::vector<std::string>& files,
                                                const std::vector<QueryFrame>& answers);

/// The command that simulates a frame again.
[[nodiscard]] std::string repeat_of(const Scene& scene, std::uint32_t frame, Check check);
/// The message about a query whose records differ from the reference.
[[nodiscard]] std::string mismatch_text(const Scene& scene, std::uint32_t frame, std::size_t query,
                                        const QueryFrame& answer, const std::string& repeat,
                                        bool faults);

/// Frames that ranks or shards share.
struct DistributedFrames {
  const Scene& scene;
  const Plan& plan;
  Check check = Check::kAll;
  RecordFiles files = RecordFiles::kTables;
  std::uint32_t first = 0, last = 0;
  double timeout = 3600;
  std::uint64_t deadline = 0;
};
/// Takes the frames in order: JSON and, by query, the text of the records.
using FrameSink = std::function<void(std::uint32_t frame, const nlohmann::ordered_json& json,
                                     const std::vector<std::string>& records)>;

/// Begins a shared run with one chunk per frame (WorkDistributor::begin).
void begin_frames(const DistributionOptions& options, const DistributedFrames& frames, bool quiet);
/// Runs WorkDistributor::run_part on the frames. Error kMismatch if a record differs from the
/// reference.
[[nodiscard]] bool distribute_frames(const DistributedFrames& frames, const FrameSink& take);

}  // namespace cde::cli
