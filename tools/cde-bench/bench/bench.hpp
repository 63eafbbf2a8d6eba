// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "cde/mesh/mesh.hpp"
#include "cde/model/device.hpp"

/// Sections of `cde bench`. Each measures, prints its table (streams.hpp), and returns its figures.
namespace cde::cli {

struct BenchOptions {
  bool quick = false;     ///< only default models, small scenes
  bool full = false;      ///< up to 10 million triangles, and models that take long to build
  bool markdown = false;  ///< section effects: prints the table of docs/tables/effects.md
  Device device = default_device();
  std::optional<Mesh> mesh;   ///< section gpu; empty: a terrain
  std::string opencl_device;  ///< number or part of the name; empty: a GPU if there is one
  bool needs_opencl = false;  ///< section gpu: a missing OpenCL device is an error
};

nlohmann::ordered_json bench_rays(const BenchOptions& options);
nlohmann::ordered_json bench_bus(const BenchOptions& options);
nlohmann::ordered_json bench_fp(const BenchOptions& options);
nlohmann::ordered_json bench_pairs(const BenchOptions& options);
nlohmann::ordered_json bench_effects(const BenchOptions& options);
nlohmann::ordered_json bench_bvh(const BenchOptions& options);
nlohmann::ordered_json bench_gpu(const BenchOptions& options);
nlohmann::ordered_json bench_waves(const BenchOptions& options);

/// Prints the OpenCL devices and returns their figures. Error kUsage without any.
nlohmann::ordered_json list_opencl_devices();

/// Processor time of this thread and of the process, in seconds.
[[nodiscard]] double thread_seconds();

}  // namespace cde::cli
