// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cast/task.hpp"
#include "cde/card/board.hpp"
#include "cde/hierarchy/hierarchy.hpp"
#include "cde/image/camera.hpp"
#include "cde/mesh/mesh.hpp"
#include "cde/scene/plan.hpp"

/// The rays of a cast, the card that they go to, and what came of it.
namespace cde::cli {

/// Rays, and the picture they make if they are one.
struct CastJob {
  Mesh mesh = {};  ///< of a partitioned one only rank 0 has all, and only if files are made of it
  std::uint64_t triangles = 0;  ///< of all of it
  Eigen::AlignedBox3f bounds = {};
  std::string fingerprint = {};  ///< its name, and of all of it, where the run is dealt
  std::map<unsigned, std::shared_ptr<const CastJob>> parts =
      {};  ///< those that this process has, each a job of its own without rays
  std::vector<Ray> listed = {};  ///< or a picture's, which are made packet by packet
  std::optional<std::vector<std::uint64_t>> shape = {};  ///< of the listed ones, from an array
  RayView rays = {};
  std::optional<Resolution> picture = {};
  Mode mode = Mode::kNearest;
  BoardConfig config = {};  ///< with node units if rays go through a hierarchy
  std::shared_ptr<const Hierarchy> hierarchy = {};  ///< of the mesh, as far as it has been built
  std::optional<BuiltCard> stands_in_for = {};      ///< the card that `config` is used instead of
};

struct CastOutcome {
  Counters counters;
  std::uint64_t hits = 0, compared = 0, matching = 0, upload_clocks = 0;
  std::uint64_t swept_rays = 0;  ///< whose records in the hierarchy were held against all triangles
  std::string difference;        ///< of the first record that does not match
  std::optional<Difference> first_difference;  ///< the same as data
  double modelled_seconds = 0;                 ///< of the passes, on the card that takes longest
  double simulation_seconds = 0;
  std::string bitstream;
  std::uint64_t config_hash = 0;
};

/// A cast with waves was stopped by a signal; the waves until then are kept.
struct CastStopped {};

/// The job's card, with its mesh.
[[nodiscard]] Board card_of(const CastTask& task, const CastJob& job);
/// The job's rays on cards of this process, every record compared if `check`; `take` gets them in
/// the order of one card.
[[nodiscard]] CastOutcome cast_here(const CastTask& task, const CastJob& job,
                                    const std::string& what, const RecordSink& take);
/// Some rays on a card; numbers of records count from the first of them.
[[nodiscard]] CastOutcome cast_on(Board& board, const CastTask& task, const CastJob& job, Mode mode,
                                  const RayView& rays, const std::function<void(double)>& progress,
                                  const RecordSink& take);

/// What modelled times of several cards have between these and the outputs.
inline constexpr const char* kNetwork = "records over one link of 10 Gbit/s, 50 us";

/// The job for all ranks: rank 0 has all of it, the others what they need to take part.
void share_job(const CastTask& task, CastJob& job);
/// Error kUsage if a run that is dealt in chunks cannot have an option.
void check_dealt(const CastTask& task);
/// Begins a run that is dealt in chunks, once there is a job.
void begin_dealt(const CastTask& task, const CastJob& job);
/// cast_rays in chunks. On other ranks than 0, and in a shard, the outcome is without records.
[[nodiscard]] CastOutcome deal_rays(const CastTask& task, const CastJob& job,
                                    const std::string& what, const RecordSink& take);

/// The record that differs as a failure; its rerun casts the record's packet again. `task` and
/// `job` must outlive it.
[[nodiscard]] Failure failure_of(const CastTask& task, const CastJob& job,
                                 const CastOutcome& outcome);

/// Mesh, rays, card and hierarchy of a task. Messages go to stderr unless it is quiet.
[[nodiscard]] CastJob job_of(const CastTask& task);

/// Runs a task: casts, draws, writes, prints. Error kMismatch if a record differs.
void run_cast(const CastTask& task);

/// The summary of a cast: as JSON, and on stderr.
[[nodiscard]] nlohmann::ordered_json summary_json(const CastTask& task, const CastJob& job,
                                                  const CastOutcome& outcome);
void print_summary(const CastTask& task, const CastJob& job, const CastOutcome& outcome);
/// Where mesh and rays are, if no ray hit.
void warn_of_misses(const CastTask& task, const CastJob& job, const CastOutcome& outcome);

}  // namespace cde::cli
