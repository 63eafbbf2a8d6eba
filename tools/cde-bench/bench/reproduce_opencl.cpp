// SPDX-License-Identifier: Apache-2.0
#include "bench/reproduce_opencl.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "bench/flight_rays.hpp"
#include "bench/measured.hpp"
#include "bench/opencl_figures.hpp"
#include "page/page.hpp"

namespace cde::cli {
namespace {

constexpr std::size_t kFreshOpenClRays = 16'384;

Entry opencl_entry(const std::string& name, const std::string& note, double kernel,
                   const Spread& spread) {
  return {.name = name,
          .source = Source::kOpenCl,
          .seconds = spread.median,
          .note = fmt::format("{}; the kernel alone {}", note, duration(kernel)),
          .spread = spread};
}

/// Measures frames: `frame` adds its seconds. The kernel's are a median, also.
std::pair<Spread, double> frames(const std::function<double(baseline::OpenClTimes&)>& frame) {
  std::vector<double> all, kernel;
  double sum = 0;
  for (bool first = true; first || more_samples(all.size(), sum); first = false) {
    baseline::OpenClTimes times;
    const double seconds = frame(times);
    if (first) continue;  // allocates and compiles
    all.push_back(seconds);
    kernel.push_back(times.kernel);
    sum += seconds;
  }
  return {spread_of(std::move(all)), spread_of(std::move(kernel)).median};
}

}  // namespace

OpenClRows::OpenClRows(const baseline::OpenClDevice& device, const Mesh& mesh)
    : device_(device),
      opencl_spheres_(std::make_unique<baseline::OpenClSpheres>(device)),
      fresh_(flight_rays(mesh, kFreshOpenClRays)),
      records_(reference_records(mesh, fresh_)) {
  std::vector<Triangle> triangles(mesh.faces.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) triangles[i] = mesh.triangle(i);
  opencl_ = std::make_unique<baseline::OpenClRays>(device, triangles);
}

void OpenClRows::figure5(Experiment& e, std::size_t count) {
  for (const Through through : {Through::kBruteForce, Through::kBvh}) {
    const OpenClSeries s =
        measure_opencl(*opencl_, through, fresh_, count, records_, device_.label());
    e.entries.push_back(opencl_entry(
        fmt::format("{}, {}", device_.short_label(), method_of(s)),
        through == Through::kBvh ? "BVH built and uploaded before" : "every pair, uploaded before",
        s.kernel.median, s.with_copies));
  }
}

void OpenClRows::figure6(Experiment& e, std::size_t first, std::span<const Triangle> moved,
                         std::span<const Ray> rays, std::span<const Record> records) {
  opencl_->upload(Through::kBruteForce);
  baseline::HitDifferences differences;
  const auto [spread, kernel] = frames([&](baseline::OpenClTimes& times) {
    const double moving = opencl_->move(first, moved);
    differences +=
        baseline::compare_hits(records, opencl_->cast(rays, Through::kBruteForce, &times));
    return moving + times.copies;
  });
  baseline::require_few(differences, device_.label());
  e.entries.push_back(opencl_entry(fmt::format("{}, brute force", device_.short_label()),
                                   "moved triangles uploaded, every pair", kernel, spread));
}

void OpenClRows::figure7(Experiment& e, std::span<const Sphere> spheres, std::uint64_t hits) {
  std::uint64_t found = 0;
  const auto [spread, kernel] = frames([&](baseline::OpenClTimes& times) {
    found = opencl_spheres_->overlaps(spheres, &times);
    return times.copies;
  });
  // Pairs that touch within rounding may differ, as for the other software.
  const std::uint64_t wrong = std::max(found, hits) - std::min(found, hits);
  if (wrong > 2 + hits / 1000)
    differs("overlaps of " + device_.label() + " and of the card", wrong, hits);
  e.entries.push_back(opencl_entry(device_.short_label(),
                                   "spheres uploaded, every pair counted only", kernel, spread));
}

}  // namespace cde::cli
