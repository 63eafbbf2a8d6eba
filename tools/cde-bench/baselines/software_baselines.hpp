// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "cde/geometry/primitives.hpp"
#include "cde/mesh/mesh.hpp"

/// Software baselines of `cde reproduce`, on one thread. Those for ray-triangle are in
/// baselines/baseline.hpp.
namespace cde::cli {

/// Spheres by component, for the kernels. It has only plain arrays, so that no inline function that
/// was compiled for a specific processor is linked into other code.
struct SphereArrays {
  const float *x, *y, *z, *r;
  std::size_t count;
};

/// The number of ordered pairs of spheres that overlap or touch, including each sphere with itself.
/// Every pair is tested, and only the number is written.
[[nodiscard]] std::uint64_t overlaps_scalar(const SphereArrays& spheres);
[[nodiscard]] std::uint64_t overlaps_avx2(const SphereArrays& spheres);  ///< the same; needs AVX2

/// Embree 3 on a mesh: a BVH in robust mode, one ray at a time, one thread.
class EmbreeBaseline {
 public:
  /// Whether this program was built with Embree. Otherwise no other function may be called.
  [[nodiscard]] static bool available();

  explicit EmbreeBaseline(const Mesh& mesh);
  ~EmbreeBaseline();
  EmbreeBaseline(const EmbreeBaseline&) = delete;
  EmbreeBaseline& operator=(const EmbreeBaseline&) = delete;

  /// Moves the vertices from `first` on to these places, and refits the BVH.
  void move(std::size_t first, std::span<const Eigen::Vector3f> vertices);
  /// T of the nearest hit of every ray; +inf without a hit.
  [[nodiscard]] std::vector<float> cast(std::span<const Ray> rays) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cde::cli
