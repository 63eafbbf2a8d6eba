// SPDX-License-Identifier: Apache-2.0
// Runs a cast from its task to its outputs.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "cast/job.hpp"
#include "cast/picture.hpp"
#include "cde/io/record_file.hpp"
#include "cde/jobs/work_distributor.hpp"
#include "cde/support/error.hpp"
#include "output/streams.hpp"

namespace cde::cli {
namespace {

/// Casts the job's rays, in chunks if the options ask for that.
CastOutcome cast_rays(const CastTask& o, const CastJob& job, const std::string& what,
                      const RecordSink& take) {
  const bool distributed =
      o.partition > 1 || WorkDistributor::instance().is_chunked(o.distribution);
  return distributed ? distribute_rays(o, job, what, take) : cast_here(o, job, what, take);
}

/// The number of records, if the mode determines it.
std::optional<std::uint64_t> records_of(const CastJob& job) {
  if (job.mode == Mode::kHits) return std::nullopt;
  return job.rays.size() * (job.mode == Mode::kAll ? job.triangles : 1);
}

/// An array of records has the axes of the rays if each ray has one record.
RecordFormat format_of(const CastTask& o, const CastJob& job) {
  RecordFormat format = RecordFormat::of_cast(o.records, o.bits, o.fields);
  if (job.mode != Mode::kAll && job.mode != Mode::kHits) format.shape = job.shape;
  return format;
}

/// The second pass of a picture, to the sun. The totals include its cycles and records, but not its
/// hits.
void cast_shadows(const CastTask& o, CastPicture& picture, CastOutcome& all) {
  picture.look_at_sun([&](const CastJob& job, const RecordSink& take) {
    const CastOutcome sun = cast_rays(o, job, "casting shadows", take);
    all.counters += sun.counters;
    all.compared += sun.compared;
    all.matching += sun.matching;
    all.modelled_seconds += sun.modelled_seconds;
    all.simulation_seconds += sun.simulation_seconds;
    if (all.difference.empty()) all.difference = sun.difference;
  });
}

}  // namespace

void run_cast(const CastTask& asked) {
  check_distribution(asked);
  CastTask o = asked;
  CastJob job;
  if (WorkDistributor::instance().leads())
    job = job_of(o);
  else
    job.mode = o.request.mode;
  share_job(o, job);
  begin_distribution(o, job);
  if (!WorkDistributor::instance().leads() || WorkDistributor::instance().is_shard()) {
    (void)cast_rays(o, job, "casting", [](std::span<const Record>) {});
    return;
  }
  std::optional<CastPicture> picture;
  if (o.picture.any()) picture.emplace(o, job);
  std::optional<RecordFile> records;
  if (!o.records.empty())
    records.emplace(o.records, RecordText(format_of(o, job), &job.mesh, job.rays), records_of(job));
  CastOutcome result = cast_rays(o, job, "casting", [&](std::span<const Record> some) {
    if (records) records->add(some);
    if (picture) picture->add(some);
  });
  if (picture && result.difference.empty()) cast_shadows(o, *picture, result);
  if (result.difference.empty()) {  // with a wrong record no file and no picture is written
    if (picture) picture->write();
    if (records) records->commit();
  }
  if (o.json) print_json(summary_json(o, job, result));
  if (!o.quiet) print_summary(o, job, result);
  warn_of_misses(o, job, result);
  if (result.difference.empty()) return;
  throw Error(ErrorCode::kMismatch,
              result.difference + packed(o.bundle, o.quiet, failure_of(o, job, result)));
}

}  // namespace cde::cli
