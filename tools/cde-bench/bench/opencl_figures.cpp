// SPDX-License-Identifier: Apache-2.0
#include "bench/opencl_figures.hpp"
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include "cde/bvh/bvh.hpp"
#include "cde/reference/traversal.hpp"
#include "cde/support/error.hpp"
#include "output/streams.hpp"
#include "page/page.hpp"

namespace cde::cli {

using baseline::OpenClDevice;
using baseline::OpenClRays;
using nlohmann::ordered_json;

OpenClSeries measure_opencl(OpenClRays& opencl, Through through, std::span<const Ray> rays,
                            std::size_t size, std::span<const Record> records,
                            const std::string& name) {
  OpenClSeries series;
  series.through = through, series.rays = size;
  std::vector<double> kernel, copies, upload;
  double sum = 0;
  for (std::size_t call = 0; call == 0 || more_samples(kernel.size(), sum); ++call) {
    const double uploaded = opencl.upload(through);
    baseline::OpenClTimes times;
    const std::vector<baseline::ClosestHit> hits =
        opencl.cast(turn_of(rays, size, call), through, &times);
    series.differences +=
        baseline::compare_hits(records.subspan(call % (rays.size() / size) * size, size), hits);
    if (call == 0) continue;  // the first cast also allocates and compiles
    kernel.push_back(times.kernel);
    copies.push_back(times.copies);
    upload.push_back(uploaded + times.copies);
    sum += upload.back();
  }
  baseline::require_few(series.differences, name);
  series.kernel = spread_of(std::move(kernel));
  series.with_copies = spread_of(std::move(copies));
  series.with_upload = spread_of(std::move(upload));
  return series;
}

std::vector<Record> reference_records(const TriangleView& triangles, std::span<const Ray> rays) {
  const Bvh bvh = Bvh::build(triangles);
  reference::Traversal traversal(triangles, bvh);
  std::vector<Record> records;
  records.reserve(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i)
    records.push_back(traversal.trace(rays[i], static_cast<std::uint32_t>(i), Mode::kNearest)[0]);
  return records;
}

std::optional<OpenClDevice> opencl_for_rows(const std::string& words) {
  if (!words.empty()) return baseline::choose_opencl_device(baseline::opencl_devices(), words);
  try {
    const OpenClDevice first = baseline::choose_opencl_device(baseline::opencl_devices(), "");
    return first.is_gpu() ? std::optional(first) : std::nullopt;
  } catch (const Error&) {
    return std::nullopt;  // no OpenCL, no platform or no device
  }
}

const char* method_of(const OpenClSeries& series) {
  return series.through == Through::kBvh ? "BVH" : "brute force";
}

void show_opencl_row(const OpenClDevice& device, const OpenClSeries& s) {
  print_figure("  {}, {}, {} rays: kernel {}, with copies {}, with upload of triangles {}; {}\n",
               device.label(), method_of(s), s.rays, duration(s.kernel.median),
               duration(s.with_copies.median), duration(s.with_upload.median),
               s.differences.text());
}

ordered_json opencl_device_json(const OpenClDevice& d) {
  return {{"name", d.name},
          {"kind", d.kind},
          {"platform", d.platform},
          {"driver", d.driver},
          {"opencl_version", d.version},
          {"compute_units", d.compute_units},
          {"bit_exact", d.is_exact()}};
}

ordered_json series_json(const OpenClSeries& s) {
  const baseline::HitDifferences& d = s.differences;
  return {{"through", s.through == Through::kBvh ? "bvh" : "brute_force"},
          {"rays", s.rays},
          {"kernel_seconds", s.kernel.median},
          {"seconds_with_copies", s.with_copies.median},
          {"seconds_with_upload", s.with_upload.median},
          {"spread_kernel", spread_json(s.kernel)},
          {"spread_copies", spread_json(s.with_copies)},
          {"spread_upload", spread_json(s.with_upload)},
          {"records_compared", d.compared},
          {"records_matching", d.equal()},
          {"extra_hits", d.extra_hits},
          {"missed_hits", d.missed_hits},
          {"other_t", d.other_t},
          {"other_triangles", d.other_triangles},
          {"rounded_t", d.rounded_t}};
}

ordered_json opencl_row_json(const OpenClDevice& device, std::span<const OpenClSeries> series) {
  ordered_json j = {{"opencl_device", opencl_device_json(device)},
                    {"casts", ordered_json::array()}};
  for (const OpenClSeries& s : series) j["casts"].push_back(series_json(s));
  return j;
}

}  // namespace cde::cli
