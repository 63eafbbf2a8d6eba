// SPDX-License-Identifier: Apache-2.0
#include "cast/task.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "cast/picture.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/io/rays_csv.hpp"
#include "cde/io/record_file.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/output_file.hpp"
#include "cde/support/suffix.hpp"
#include "options/typed.hpp"

namespace cde::cli {
namespace {

RaySource source_of(const CastWords& w) {
  RaySource s;
  s.file = w.rays_file;
  for (const std::string& text : w.rays)
    s.given.push_back(parse_ray(text, "--ray " + printable_name(text)));
  if (!w.camera.empty()) s.camera = parse_camera(w.camera);
  if (!w.grid.empty()) s.grid = parse_resolution(w.grid, "--grid");
  if (!w.size.empty()) s.size = parse_resolution(w.size);
  const std::string extension = std::filesystem::path(w.mesh).extension().string();
  const bool is_gltf = extension == ".glb" || extension == ".gltf";  // y is up in glTF
  s.up = w.up == "auto" ? (is_gltf ? 'y' : 'z') : w.up.front();
  s.up_is_asked = is_gltf || w.up != "auto";
  if (!w.renders && !s.listed() && !s.camera && !s.grid && !s.size)
    throw_usage(
        fmt::format("rays are missing: --ray, --rays, --camera or --grid; `cde render {}` draws "
                    "the mesh",
                    printable_name(w.mesh)));
  return s;
}

CastRequest request_of(const CastWords& w) {
  CastRequest r;
  r.mode = *mode_named(w.mode);
  r.algorithm = *algorithm_named(w.algorithm);
  r.arithmetic = w.arithmetic == "rtl" ? Arithmetic::kRtl : Arithmetic::kHost;
  r.format = FpFormat::parse(w.format);
  r.box = w.box;
  r.trace = w.trace.wanted();
  if (w.lanes != "auto") r.lanes = static_cast<unsigned>(std::stoul(w.lanes));
  if (w.bvh != 0) r.bvh = w.bvh > 0;
  r.parts = w.partition > 1;
  r.exact_card = w.exact;
  r.device = w.device.chosen();
  return r;
}

/// Whether --output of `cde render` names its picture, not records.
bool output_is_picture(const CastWords& w) {
  return w.renders && suffix_of(w.records).text == ".png";
}

PictureFiles picture_of(const CastWords& w) {
  PictureFiles p{w.shaded, w.depth, w.normals, w.indices, w.shadows};
  if (output_is_picture(w)) {
    if (!p.shaded.empty())
      throw_usage("--output and --shaded both name the picture; --output may name records");
    p.shaded = w.records;
  }
  if (w.renders && !p.any()) {
    p.shows_itself = true;
    p.shaded = own_picture_name(w.mesh);
  }
  if (p.shadows && p.shaded.empty()) throw_usage("--shadows needs --shaded");
  return p;
}

/// Refuses options that would have no effect.
void check_options(const CastWords& w, const CastTask& t) {
  struct OfRecords {
    const char* option;
    bool given;
  };
  if (t.records.empty())
    for (const OfRecords& o :
         {OfRecords{"--bits", w.bits}, OfRecords{"--fields", !w.fields.empty()},
          OfRecords{"--inside", w.inside}})
      if (o.given) throw_usage(fmt::format("{} needs --output", o.option));
  t.bundle.check(t.check, "--no-check");
  if (w.checks.starts_with("rays:") && w.bvh < 0) cannot_combine("--check=" + w.checks, "--no-bvh");
  if (t.trace.wanted() && t.boards > 1)
    cannot_combine("--trace", "--boards", "waves can show only one card");
  if (t.request.mode != Mode::kOccluded) return;
  if (w.bvh < 0) cannot_combine("--mode occluded", "--no-bvh");
  if (std::any_of(t.fields.begin(), t.fields.end(),
                  [](const std::string& f) { return f != "inside"; }))
    cannot_combine("--fields", "--mode occluded", "this mode does not return the triangle");
}

}  // namespace

const char* name_of(Arithmetic arithmetic) {
  return arithmetic == Arithmetic::kRtl ? "rtl" : "host";
}

CastTask task_of(const CastWords& w) {
  CastTask t;
  t.verb = w.renders ? "render" : "cast";
  t.mesh = w.mesh;
  t.source.file = w.rays_file;
  t.request = request_of(w);
  t.picture = picture_of(w);
  t.records = output_is_picture(w) ? "" : w.records, t.fields = w.fields, t.bits = w.bits;
  if (w.inside && std::find(t.fields.begin(), t.fields.end(), "inside") == t.fields.end())
    t.fields.push_back("inside");
  // Without --output, records of at most so many --ray go to stdout.
  constexpr std::size_t kFewRays = 16;
  const bool few = w.rays_file.empty() && !w.rays.empty() && w.rays.size() <= kFewRays;
  if (t.records.empty() && !w.renders && !w.json && (few || w.inside)) t.records = "-";
  t.trace = w.trace, t.bundle = w.bundle, t.distribution = w.distribution;
  t.boards = w.boards, t.partition = w.partition;
  t.timeout = w.timeout, t.deadline = w.deadline;
  t.json = w.json, t.quiet = w.quiet;
  t.check = w.checks != "false";
  if (t.check && w.checks != "true") t.brute_force_rays = parse_check(w.checks);
  check_files(t);
  check_options(w, t);
  t.trace.check();
  check_picture_names(t.picture);
  (void)RecordFormat::of_cast(t.records, t.bits, t.fields);
  t.source = source_of(w);
  return t;
}

void check_files(const CastTask& t, const std::vector<std::string>& more) {
  std::vector<FileUse> inputs = {{"MESH", t.mesh}, {"--rays", t.source.file}};
  for (const auto& file : more) inputs.push_back({"MESH", file});
  WorkDistributor::instance().add_inputs(inputs);
  check_outputs(std::vector<FileUse>{{"-o", t.records},
                                     {"--image", t.picture.depth},
                                     {"--shaded", t.picture.shaded},
                                     {"--normals", t.picture.normals},
                                     {"--indices", t.picture.indices},
                                     {"--trace", t.trace.file},
                                     {"--resume", t.distribution.resume},
                                     {"--json", t.json ? "-" : ""}},
                inputs);
}

}  // namespace cde::cli
