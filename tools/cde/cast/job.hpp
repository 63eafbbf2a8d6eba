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
#include "cde/bvh/bvh.hpp"
#include "cde/card/board.hpp"
#include "cde/image/camera.hpp"
#include "cde/mesh/mesh.hpp"
#include "cde/scene/plan.hpp"

/// The rays of a cast, its card, and its outcome.
namespace cde::cli {

/// Mesh, rays and card of a cast.
struct CastJob {
  Mesh mesh =
      {};  ///< if partitioned, only rank 0 has all of it, and only if fields or pictures need it
  std::uint64_t triangles = 0;  ///< of the whole mesh
  Eigen::AlignedBox3f bounds = {};
  std::string fingerprint = {};  ///< of the whole mesh, with its name, if the run is distributed
  std::map<unsigned, std::shared_ptr<const CastJob>> parts =
      {};                        ///< parts in this process, each a job without rays
  std::vector<Ray> listed = {};  ///< or empty: a picture's rays are made packet by packet
  std::optional<std::vector<std::uint64_t>> shape = {};  ///< axes of listed rays from an array
  RayView rays = {};
  std::optional<Resolution> picture = {};
  Mode mode = Mode::kNearest;
  BoardConfig config = {};                      ///< with traversal units if rays traverse a BVH
  std::shared_ptr<const Bvh> bvh = {};          ///< of the mesh; null if none is built
  std::optional<BuiltCard> stands_in_for = {};  ///< the planned card that `config` replaces
};

struct CastOutcome {
  Counters counters;
  std::uint64_t hits = 0, compared = 0, matching = 0, upload_cycles = 0;
  std::uint64_t brute_force_rays = 0;          ///< rays that were also checked by brute force
  std::string difference;                      ///< about the first record that does not match
  std::optional<Difference> first_difference;  ///< the same as data
  double modelled_seconds = 0;                 ///< of the passes, on the slowest card
  double simulation_seconds = 0;
  std::string model;
  std::uint64_t config_hash = 0;
};

/// Thrown if a signal stops a cast with waves. The waves until then are kept.
struct CastStopped {
  std::optional<std::uint64_t> last = {};  ///< time of the waves, ps
};

/// The job's card, with the mesh uploaded.
[[nodiscard]] Board card_of(const CastTask& task, const CastJob& job);
/// Casts the job's rays on cards of this process. Every record is compared if the task says so.
/// `take` gets the records in the order of one card.
[[nodiscard]] CastOutcome cast_here(const CastTask& task, const CastJob& job,
                                    const std::string& what, const RecordSink& take);
/// Casts some rays on a card. The numbers in their records count from the first of them.
[[nodiscard]] CastOutcome cast_on(Board& board, const CastTask& task, const CastJob& job, Mode mode,
                                  const RayView& rays, const std::function<void(double)>& progress,
                                  const RecordSink& take);

/// For modelled times of several cards: the network between the cards and the outputs.
inline constexpr const char* kNetwork = "records over one link of 10 Gbit/s, 50 us";

/// Shares the job with all ranks. Rank 0 has all of it, the others what they need.
void share_job(const CastTask& task, CastJob& job);
/// Error kUsage if an option cannot be combined with a run in chunks.
void check_distribution(const CastTask& task);
/// Begins a run in chunks, once there is a job.
void begin_distribution(const CastTask& task, const CastJob& job);
/// Casts the rays in chunks. On ranks other than 0, and in a shard, the outcome has no records.
[[nodiscard]] CastOutcome distribute_rays(const CastTask& task, const CastJob& job,
                                          const std::string& what, const RecordSink& take);

/// The differing record as a failure. Its rerun casts the record's packet again. `task` and `job`
/// must outlive the failure.
[[nodiscard]] Failure failure_of(const CastTask& task, const CastJob& job,
                                 const CastOutcome& outcome);

/// Mesh, rays, card and BVH of a task. Messages go to stderr unless the task is quiet.
[[nodiscard]] CastJob job_of(const CastTask& task);

/// Runs a task: casts, draws, writes files, prints the summary. Error kMismatch if a record
/// differs.
void run_cast(const CastTask& task);

/// The summary of a cast as JSON; print_summary prints it on stderr.
[[nodiscard]] nlohmann::ordered_json summary_json(const CastTask& task, const CastJob& job,
                                                  const CastOutcome& outcome);
void print_summary(const CastTask& task, const CastJob& job, const CastOutcome& outcome);
/// Warns if no ray hit, with the places of mesh and rays.
void warn_of_misses(const CastTask& task, const CastJob& job, const CastOutcome& outcome);

}  // namespace cde::cli
