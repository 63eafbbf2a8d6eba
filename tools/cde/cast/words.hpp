// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "cde/jobs/work_distributor.hpp"
#include "options/cli_fwd.hpp"
#include "options/device_options.hpp"
#include "options/trace_options.hpp"
#include "program/pack_failure.hpp"

/// The options of `cde cast` and `cde render` as typed. Only task.cpp reads them.
namespace cde::cli {

struct CastWords {
  std::string mesh, rays_file, camera, grid, size, records, depth, shaded, normals, indices;
  TraceRequest trace;
  BundleRequest bundle;
  DistributionOptions distribution;
  std::vector<std::string> rays, fields;
  bool inside = false;
  std::string mode = "nearest", arithmetic = "host", algorithm = "watertight", lanes = "auto",
              up = "auto", format = "fp32", checks = "true";
  unsigned boards = 1, partition = 1;
  DeviceWords device;
  double timeout = 3600;
  std::uint64_t deadline = 0;
  bool box = true, json = false, bits = false, quiet = false, shadows = false, exact = false;
  int bvh = 0;  ///< 1: --bvh, -1: --no-bvh
  bool renders = false;
};

/// Adds the options of `cde cast` to `verb`. They write into `words`, which must outlive `verb`.
void add_cast_options(CLI::App& verb, CastWords& words);
/// Adds the options of `cde render`, likewise.
void add_render_options(CLI::App& verb, CastWords& words);

/// The number of rays of --check=rays:N. Error kUsage.
[[nodiscard]] std::uint64_t parse_check(const std::string& text);

}  // namespace cde::cli
