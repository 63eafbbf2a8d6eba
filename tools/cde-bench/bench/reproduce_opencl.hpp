// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "baselines/baseline_opencl.hpp"
#include "bench/reproduce.hpp"
#include "cde/mesh/mesh.hpp"
#include "cde/query/record.hpp"

namespace cde::cli {

/// Rows of an OpenCL device in the figures of `cde reproduce`. Times are medians of wall time, with
/// copies of queries and answers. Error kMismatch if the device finds other hits.
class OpenClRows {
 public:
  OpenClRows(const baseline::OpenClDevice& device, const Mesh& mesh);

  /// `count` new rays in each frame, by brute force and through a BVH that was built before.
  void figure5(Experiment& e, std::size_t count);
  /// The triangles from `first` on move and are uploaded; then all are tested by brute force.
  void figure6(Experiment& e, std::size_t first, std::span<const Triangle> moved,
               std::span<const Ray> rays, std::span<const Record> records);
  /// All spheres are uploaded, and every pair is tested. `hits`: overlaps that the card found.
  void figure7(Experiment& e, std::span<const Sphere> spheres, std::uint64_t hits);

 private:
  baseline::OpenClDevice device_;
  std::unique_ptr<baseline::OpenClRays> opencl_;
  std::unique_ptr<baseline::OpenClSpheres> opencl_spheres_;
  std::vector<Ray> fresh_;
  std::vector<Record> records_;  ///< of fresh_
};

}  // namespace cde::cli
