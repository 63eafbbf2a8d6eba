// SPDX-License-Identifier: Apache-2.0
// cde bench gpu: rays against a mesh on an OpenCL device, by brute force and through a BVH.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

#include "bench/bench.hpp"
#include "bench/flight_rays.hpp"
#include "bench/opencl_figures.hpp"
#include "cde/mesh/mesh.hpp"
#include "cde/mesh/terrain.hpp"
#include "cde/support/columns.hpp"
#include "cde/support/error.hpp"
#include "cde/support/progress.hpp"
#include "output/streams.hpp"
#include "page/page.hpp"

namespace cde::cli {
namespace {

using baseline::OpenClDevice;
using baseline::OpenClRays;
using nlohmann::ordered_json;

/// Without --full, brute force is not run if its casts would take longer than this, in seconds.
constexpr double kMostSeconds = 60;
constexpr unsigned kCasts = 10;

struct OpenClFigures {
  OpenClDevice device;
  Mesh mesh;
  OpenClRays::BvhFacts bvh;
  std::vector<OpenClSeries> series;
  /// Numbers of rays for which brute force was not run, with estimated seconds of one cast.
  std::vector<std::pair<std::size_t, double>> not_run;
};

std::vector<std::size_t> sizes_of(const BenchOptions& o) {
  if (o.quick) return {1, 256, 4096};
  return {1, 256, 4096, 65'536, 1'048'576};
}

std::vector<Triangle> triangles_in(const Mesh& mesh) {
  std::vector<Triangle> triangles(mesh.faces.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) triangles[i] = mesh.triangle(i);
  return triangles;
}

OpenClFigures measure(const BenchOptions& o, const OpenClDevice& device) {
  OpenClFigures f;
  f.device = device;
  if (o.mesh)
    f.mesh = *o.mesh;
  else
    f.mesh = o.quick ? make_terrain({.quads_x = 80, .quads_y = 80}) : make_terrain({});
  const std::vector<std::size_t> sizes = sizes_of(o);
  Progress progress("gpu");
  progress(0, "the reference");
  const std::vector<Ray> rays = flight_rays(f.mesh, sizes.back());
  const std::vector<Record> records = reference_records(f.mesh, rays);
  progress(0.1, "the BVH");
  OpenClRays opencl(device, triangles_in(f.mesh));
  f.bvh = opencl.bvh();
  double done = 0, per_ray = 0;
  for (const std::size_t size : sizes) {
    for (const Through through : {Through::kBruteForce, Through::kBvh}) {
      progress(0.2 + 0.8 * done++ / static_cast<double>(2 * sizes.size()),
               fmt::format("{} rays", size));
      const double estimate = per_ray * static_cast<double>(size);
      if (through == Through::kBruteForce && !o.full && kCasts * estimate > kMostSeconds) {
        f.not_run.emplace_back(size, estimate);
        continue;
      }
      f.series.push_back(measure_opencl(opencl, through, rays, size, records, device.label()));
      if (through == Through::kBruteForce)
        per_ray = f.series.back().kernel.median / static_cast<double>(size);
    }
  }
  return f;
}

std::string with_range(const Spread& x) {
  return fmt::format("{} ({} to {})", duration(x.median), duration(x.tenth), duration(x.ninetieth));
}

void show_device(const OpenClDevice& d) {
  print_figure("{:<22} {}: platform {}, driver {}, {}, {} compute units\n",
               fmt::format("OpenCL device {}", d.number), d.label(), d.platform, d.driver,
               d.version, d.compute_units);
}

void show(const OpenClFigures& f) {
  print_figure("\n");
  show_device(f.device);
  print_figure(
      "{}, {} triangles; BVH: {} nodes, {} levels, {:.1f} bytes per triangle, built in {} by one "
      "thread\nmedian of nine casts or more (10th to 90th of 100); the kernel by its profiling "
      "events, the rest in wall time\n",
      f.mesh.name, f.mesh.faces.size(), f.bvh.nodes, f.bvh.levels,
      static_cast<double>(f.bvh.bytes) / static_cast<double>(f.mesh.faces.size()),
      duration(f.bvh.build_seconds));
  Columns table{.heads = {"rays", "method", "kernel", "with copies", "with upload of triangles",
                          "rays/s with copies", "differences"},
                .gap = 2,
                .left = {false, true, true, true, true, false, true}};
  for (const OpenClSeries& s : f.series)
    table.lines.push_back(
        {fmt::to_string(s.rays), method_of(s), with_range(s.kernel), with_range(s.with_copies),
         with_range(s.with_upload),
         fmt::format("{:.3g} M", 1e-6 * static_cast<double>(s.rays) / s.with_copies.median),
         fmt::format("{} of {}", s.differences.compared - s.differences.equal(),
                     s.differences.compared)});
  print_figure("{}", table.text());
  for (const OpenClSeries& s : f.series)
    if (s.differences.equal() != s.differences.compared)
      print_figure("differences, {} rays by {}: {}\n", s.rays, method_of(s), s.differences.text());
  for (const auto& [rays, seconds] : f.not_run)
    print_figure("{} rays by brute force: not run, about {} per cast (--full runs it)\n", rays,
                 duration(seconds));
  if (!f.device.is_gpu())
    print_figure("This device is no GPU, so these are no figures of a GPU.\n");
}

ordered_json json_of(const OpenClFigures& f) {
  ordered_json j = {{"mesh", f.mesh.name},  {"triangles", f.mesh.faces.size()},
                    {"nodes", f.bvh.nodes}, {"levels", f.bvh.levels},
                    {"bytes", f.bvh.bytes}, {"build_seconds", f.bvh.build_seconds}};
  j.update(opencl_row_json(f.device, f.series));
  j["not_run"] = ordered_json::array();
  for (const auto& [rays, seconds] : f.not_run)
    j["not_run"].push_back(
        {{"through", "brute_force"}, {"rays", rays}, {"estimated_seconds", seconds}});
  return j;
}

}  // namespace

ordered_json list_opencl_devices() {
  ordered_json list = ordered_json::array();
  for (const OpenClDevice& device : baseline::opencl_devices()) {
    show_device(device);
    list.push_back(opencl_device_json(device));
  }
  return list;
}

ordered_json bench_gpu(const BenchOptions& o) {
  std::optional<OpenClDevice> device;
  try {
    device = baseline::choose_opencl_device(baseline::opencl_devices(), o.opencl_device);
  } catch (const Error& e) {
    if (o.needs_opencl) throw;
    print_figure("\ngpu: not measured, {}\n", e.what());
    return nullptr;
  }
  const OpenClFigures figures = measure(o, *device);
  show(figures);
  return json_of(figures);
}

}  // namespace cde::cli
