// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "baselines/baseline_opencl.hpp"
#include "baselines/hit_differences.hpp"
#include "bench/measured.hpp"
#include "cde/mesh/triangle_view.hpp"
#include "cde/query/record.hpp"

/// Measures the OpenCL baseline on one device. `cde bench gpu` prints all figures; other sections
/// and `cde reproduce` have a row of them.
namespace cde::cli {

/// Casts of the same number of rays, in seconds per cast.
struct OpenClSeries {
  Through through = Through::kBvh;
  std::size_t rays = 0;
  Spread kernel;       ///< the kernels alone, by profiling events
  Spread with_copies;  ///< wall time: rays to the device, kernels, hits to the host
  Spread with_upload;  ///< wall time: the same after the upload of all triangles, and of the BVH
  baseline::HitDifferences differences;  ///< in all casts
};

/// Casts `size` rays again and again, in turn other ones of `rays`, and compares the hits with
/// `records` of all rays. Error kMismatch if more than 1 ray in 50 differs.
[[nodiscard]] OpenClSeries measure_opencl(baseline::OpenClRays& opencl, Through through,
                                          std::span<const Ray> rays, std::size_t size,
                                          std::span<const Record> records, const std::string& name);

/// Records of mode nearest by the mirror reference, with the box rule.
[[nodiscard]] std::vector<Record> reference_records(const TriangleView& triangles,
                                                    std::span<const Ray> rays);

/// The device of rows beside other baselines: the one that --opencl-device names, else the first
/// GPU. Nothing without a GPU. Error kUsage if the named device does not exist.
[[nodiscard]] std::optional<baseline::OpenClDevice> opencl_for_rows(const std::string& words);

/// "brute force" or "BVH".
[[nodiscard]] const char* method_of(const OpenClSeries& series);

/// A row of `cde bench rays` and `cde bench bvh`.
void show_opencl_row(const baseline::OpenClDevice& device, const OpenClSeries& series);

[[nodiscard]] nlohmann::ordered_json opencl_device_json(const baseline::OpenClDevice& device);
[[nodiscard]] nlohmann::ordered_json series_json(const OpenClSeries& series);
/// A device and its series, under the keys "opencl_device" and "casts".
[[nodiscard]] nlohmann::ordered_json opencl_row_json(const baseline::OpenClDevice& device,
                                                     std::span<const OpenClSeries> series);

}  // namespace cde::cli
