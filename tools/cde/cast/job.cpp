// SPDX-License-Identifier: Apache-2.0
// Makes rays, a card and a BVH from a task.
#include "cast/job.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iostream>

#include "cast/picture.hpp"
#include "cde/io/rays.hpp"
#include "cde/mesh/terrain.hpp"
#include "cde/support/counted.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/progress.hpp"
#include "output/plan_output.hpp"
#include "output/streams.hpp"

namespace cde::cli {
namespace {

void collect_rays(const RaySource& source, CastJob& job) {
  if (!source.listed()) return aim(source, job);
  if (!source.file.empty()) {
    RayList list = source.file == "-" ? read_rays(std::cin, "stdin") : read_rays(source.file);
    job.listed = std::move(list.rays);
    if (source.given.empty()) job.shape = std::move(list.shape);
  }
  job.listed.insert(job.listed.end(), source.given.begin(), source.given.end());
  job.rays = job.listed;
  if (job.rays.empty())
    throw Error(
        ErrorCode::kBadInput,
        fmt::format("{}: no rays", source.file == "-" ? "stdin" : printable_name(source.file)));
}

/// In fp32, a mesh may have coordinates that the card flags as bad: a warning. In another format
/// they are an error before any work starts.
void check_mesh(const Mesh& mesh, const std::string& what, FpFormat format) {
  const auto why = out_of_range(mesh, what, format);
  if (why && format != FpFormat{}) throw Error(ErrorCode::kBadInput, *why);
  if (why) warn({*why});
  if (const auto flat = without_area(mesh, what)) warn({*flat});
}

/// A mesh that stands on y = 0 and reaches to both sides of z = 0 was made with y up.
void warn_of_side(const CastTask& t, const Mesh& mesh) {
  if (t.source.up_is_asked || !t.picture.any() || t.source.listed() || t.source.camera) return;
  const Eigen::AlignedBox3f box = bounds(mesh);
  const float size = box.sizes().maxCoeff(), little = 0.01f * size, much = 0.1f * size;
  if (std::abs(box.min().y()) <= little && box.max().y() > much && box.min().z() < -much &&
      box.max().z() > much)
    warn(
        {fmt::format("{}: stands on y = 0 and reaches to both sides of z = 0; it seems to lie on "
                     "its side; try --up y",
                     printable_name(t.mesh))});
}

void check_rays(const CastJob& job) {
  if (job.config.format == FpFormat{}) return;
  for (std::size_t i = 0; i < job.rays.size(); ++i)
    if (const auto why = defect(job.rays[i], job.config.format))
      throw Error(ErrorCode::kBadInput, fmt::format("ray {}: {}", i, *why));
}

void check_size(const CastTask& t, const CastJob& job) {
  const std::uint64_t slots = BoardConfig{}.ddr_slots;
  if (t.partition > job.triangles)
    throw Error(ErrorCode::kUsage,
                fmt::format("--partition {}: {} has {}", t.partition, printable_name(t.mesh),
                            counted(job.triangles, "triangle")));
  if (job.triangles > std::uint64_t{t.partition} * slots)
    throw Error(ErrorCode::kCapacity,
                fmt::format("{}: {} triangles do not fit into the card's DDR, which holds {}; "
                            "split the mesh with --partition",
                            printable_name(t.mesh), job.triangles, slots));
}

CastPlan planned(const CastTask& t, const CastRequest& request, const CastJob& job) {
  try {
    const Progress busy("building a BVH", t.quiet || job.config.traversal_units == 0);
    return plan_cast(request, job.mesh, job.rays.size());
  } catch (const Error& e) {
    // Other errors come from the search for a simulation model.
    if (e.code() != ErrorCode::kBadInput && e.code() != ErrorCode::kCapacity) throw;
    throw Error(e.code(),
                fmt::format("{}: cannot build a BVH: {}", printable_name(t.mesh), e.what()));
  }
}

}  // namespace

CastJob job_of(const CastTask& t) {
  CastJob job;
  job.mode = t.request.mode;
  job.config.format = t.request.format;
  {
    const Progress busy("loading " + printable_name(t.mesh), t.quiet);
    job.mesh = load_mesh_or_builtin(t.mesh);
  }
  job.triangles = job.mesh.faces.size();
  job.bounds = bounds(job.mesh);
  std::vector<std::string> named;
  for (const auto& file : job.mesh.files) named.push_back(file.string());
  check_files(t, named);
  warn(job.mesh.warnings);
  check_mesh(job.mesh, printable_name(t.mesh), job.config.format);
  warn_of_side(t, job.mesh);
  job.config.traversal_units = may_traverse(t.request, job.triangles) ? 2 : 0;
  collect_rays(t.source, job);
  check_rays(job);
  check_size(t, job);
  CastPlan plan = planned(t, t.request, job);
  if (!plan.warning.empty())
    log("cde: warning: {}: {}; every ray is tested with every triangle\n", printable_name(t.mesh),
        plan.warning);
  if (!plan.bvh && job.config.traversal_units != 0 && job.picture && !t.source.size &&
      !t.source.grid) {
    // With brute force the picture is smaller.
    job.config.traversal_units = 0;
    aim(t.source, job);
    CastRequest request = t.request;
    request.bvh = false;
    plan = planned(t, request, job);
  }
  job.config = plan.card, job.bvh = plan.bvh, job.stands_in_for = plan.stands_in_for;
  if (job.stands_in_for && !t.quiet)
    log("cde: {}\n", stand_in_text(job.config, *job.stands_in_for));
  return job;
}

}  // namespace cde::cli
