// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cde/card/board.hpp"
#include "cde/hierarchy/hierarchy.hpp"
#include "cde/image/camera.hpp"
#include "cde/mesh/mesh.hpp"
#include "cde/scene/plan.hpp"
#include "ranks/dealing.hpp"
#include "verbs/bundle.hpp"
#include "verbs/clock_target.hpp"
#include "verbs/trace_options.hpp"

/// The parts of `cde cast`: what was asked, what is cast, and what came of it.
namespace cde::cli {

struct CastOptions {
  std::string mesh, rays_file, camera, grid, size, records, depth, shaded, normals, indices;
  TraceRequest trace;
  BundleRequest bundle;
  DealOptions deal;
  std::vector<std::string> rays;
  std::vector<std::string> fields;  ///< more columns of the records
  std::string mode = "nearest", arithmetic = "host", algorithm = "moller", lanes = "auto", up = "z",
              format = "fp32";
  unsigned boards = 1;
  unsigned partition = 1;  ///< parts of the mesh, each on a card of its own
  ClockOptions clock;
  std::string clock_is;  ///< where the clock is from
  double timeout = 3600;
  std::uint64_t deadline = 0;
  bool box = true, json = false, check = true, bits = false, quiet = false, shadows = false;
  bool exact = false;             ///< no built card stands in
  int bvh = 0;                    ///< through a hierarchy: 1 yes, -1 no, 0 where it is worth it
  std::string checks = "true";    ///< as it was asked for: true, false, rays:N
  std::uint64_t swept_rays = 64;  ///< that are held against all triangles where a hierarchy is

  /// Nothing but the mesh is said: a picture is what the help promises.
  bool shows_itself = false;

  [[nodiscard]] bool wants_picture() const {
    return !depth.empty() || !shaded.empty() || !normals.empty() || !indices.empty();
  }
  /// Also the one that is made where nothing is asked for.
  [[nodiscard]] bool makes_picture() const { return wants_picture() || shows_itself; }
};

/// Rays, and the picture they make if they are one.
struct CastJob {
  Mesh mesh = {};  ///< of a partitioned one only rank 0 has all, and only if files are made of it
  std::uint64_t triangles = 0;   ///< of all of it
  std::string fingerprint = {};  ///< its name, and of all of it, where the run is dealt
  std::map<unsigned, std::shared_ptr<const CastJob>> parts =
      {};  ///< those that this process has, each a job of its own without rays
  std::vector<Ray> listed = {};  ///< or a picture's, which are made packet by packet
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

/// The job's rays on cards of its configuration, every record compared if `check`; `take` gets them
/// in the order of one card. `what` is what the progress says.
[[nodiscard]] CastOutcome cast_rays(const CastOptions& options, const CastJob& job,
                                    const std::string& what, const RecordSink& take);

/// The job's card, with its mesh.
[[nodiscard]] Board card_of(const CastOptions& options, const CastJob& job);
/// Some rays on it; numbers of records count from the first of them.
[[nodiscard]] CastOutcome cast_on(Board& board, const CastOptions& options, const CastJob& job,
                                  Mode mode, const RayView& rays,
                                  const std::function<void(double)>& progress,
                                  const RecordSink& take);

/// What modelled times of several cards have between these and the outputs.
inline constexpr const char* kNetwork = "records over one link of 10 Gbit/s, 50 us";

/// The job for all ranks: rank 0 has all of it, the others what they need to take part.
void share_job(const CastOptions& options, CastJob& job);
/// Begins a run that is dealt in chunks, once there is a job.
void begin_dealt(const CastOptions& options, const CastJob& job);
/// cast_rays in chunks. On other ranks than 0, and in a shard, the outcome is without records.
[[nodiscard]] CastOutcome deal_rays(const CastOptions& options, const CastJob& job,
                                    const std::string& what, const RecordSink& take);

/// Packs the record that differs, from the packet that it is of, cast again.
void bundle_cast(Bundle& bundle, const CastOptions& options, const CastJob& job,
                 const CastOutcome& outcome);

}  // namespace cde::cli
