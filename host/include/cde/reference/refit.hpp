// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "cde/bvh/node.hpp"
#include "cde/mesh/triangle_view.hpp"

/// @file
/// Refit of a card (rtl/bvh/refit.sv) for moved triangles, bit-exact. Bvh::refit() also keeps the
/// exact boxes, so its nodes are slightly tighter.
namespace cde::reference {

struct Refitted {
  std::vector<bvh::Node> nodes;
  /// Slot of the first bad triangle, in the order from the last node to the root. A bad triangle
  /// has a coordinate that is not a number or beyond 2^40. Its node and those before it are
  /// unchanged.
  std::optional<std::uint32_t> bad;
};

/// Refits the boxes from the last node to the first; the topology stays. Each child's box contains
/// its triangles, or box_of() its node, exactly, whatever the triangles are:
///
/// - A leaf's box is the minimum and the maximum of words.
/// - A node's origin is the lower corner of all children's boxes. Let m be the larger exponent of
///   that corner and of the upper one. All corners become integers in units of 2^(m-24), one bit
///   more than the longest needs, rounded so that boxes grow. Their differences become bytes,
///   rounded likewise. A negative difference, which no corner has, becomes zero. So containment
///   does not depend on the lost bits.
/// - Little is lost: only numbers below half of the larger end (M) lose bits. Then the node is
///   longer than M / 2, a byte has at least 2^16 integers, and the loss costs at most one byte
///   more.
/// - The byte unit is the finest that fits and is no finer than the integers, nor than 2^-80. Its
///   exponent is at most 37, even with the growth of boxes on the way to the root, at most two
///   bytes per level.
/// - The box of a child that is a node follows from its words: box_of().
///
/// Both zeros become +0. Bytes of missing children are 0. A node without children, which only an
/// empty BVH needs, stays unchanged. To its parent it is the point of its origin. Error kUsage if
/// the numbers of triangles and slots differ; others as for bvh::check.
[[nodiscard]] Refitted refit(std::span<const bvh::Node> nodes, std::span<const std::uint32_t> order,
                             const TriangleView& triangles);

/// The box from a node's origin to the largest of its children's upper corners, rounded up. It
/// contains exactly the boxes of all children, as given by their bytes, and of the nodes below
/// them.
[[nodiscard]] Eigen::AlignedBox3f box_of(const bvh::Node& node);

}  // namespace cde::reference
