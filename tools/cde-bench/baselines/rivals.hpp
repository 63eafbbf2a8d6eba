// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "cde/geometry/primitives.hpp"
#include "cde/mesh/mesh.hpp"

/// Software that `cde reproduce` measures beside the card, on one thread; the ray-triangle rivals
/// are in cde/rivals/baseline.hpp.
namespace cde::cli {

/// Spheres by component, for the kernels: plain arrays only, so that no inline function compiled
/// for another processor ends up in other code.
struct SphereArrays {
  const float *x, *y, *z, *r;
  std::size_t count;
};

/// Ordered pairs of spheres that overlap or touch, each sphere with itself included: every pair is
/// tested, and nothing is written but the number.
[[nodiscard]] std::uint64_t overlaps_scalar(const SphereArrays& spheres);
[[nodiscard]] std::uint64_t overlaps_avx2(const SphereArrays& spheres);  ///< needs AVX2

/// Embree 3 on a mesh: a bounding-volume hierarchy, robust mode, one ray at a time, one thread.
class EmbreeRival {
 public:
  /// Whether this program was built with Embree. Without it nothing else may be called.
  [[nodiscard]] static bool available();

  explicit EmbreeRival(const Mesh& mesh);
  ~EmbreeRival();
  EmbreeRival(const EmbreeRival&) = delete;
  EmbreeRival& operator=(const EmbreeRival&) = delete;

  /// Vertices from `first` on are at these places; the hierarchy follows.
  void move(std::size_t first, std::span<const Eigen::Vector3f> vertices);
  /// The nearest hit of every ray; +inf: none.
  [[nodiscard]] std::vector<float> cast(std::span<const Ray> rays) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cde::cli
