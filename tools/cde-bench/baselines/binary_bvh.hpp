// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "cde/geometry/primitives.hpp"

namespace cde::baseline {

/// A node with two children. The kernel (opencl_queries.cl) reads it as four vectors of four words.
/// An axis has low and high of the first box, then low and high of the second box. A child is its
/// number * 8 + count: count 0 is a node, otherwise a leaf with so many places of `order`.
struct BinaryNode {
  float x[4], y[4], z[4];
  std::uint32_t child[2];
  std::uint32_t unused[2];
};

/// A BVH of two children per node over triangles. It is a software baseline, independent of
/// cde::Bvh. Boxes are exact: they have corners of triangles.
struct BinaryBvh {
  /// Most triangles per leaf, and most levels: the kernel's stack.
  static constexpr unsigned kLeaf = 4, kMostLevels = 64;

  std::vector<BinaryNode> nodes;     ///< the root first
  std::vector<std::uint32_t> order;  ///< index of the triangle in each place
  Eigen::AlignedBox3f box;           ///< box of all triangles
  unsigned levels = 0;               ///< levels of nodes

  /// Splits by binned surface area (Wald, IRT 2007), on one thread. Below 32 levels it splits at
  /// medians. Error kBadInput without triangles, kCapacity for more than 2^28.
  [[nodiscard]] static BinaryBvh build(std::span<const Triangle> triangles);
};

}  // namespace cde::baseline
