// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "cde/hierarchy/node.hpp"
#include "cde/mesh/triangle_view.hpp"

/// What a card's refit (rtl/hierarchy/refit.sv) makes of nodes whose triangles have moved, bit by
/// bit. Hierarchy::refit() keeps boxes beside the nodes, and these are a little tighter.
namespace cde::reference {

struct Refitted {
  std::vector<hierarchy::Node> nodes;
  /// The slot of a triangle with a coordinate that is no number or beyond 2^40, the first one met
  /// from the last node to the root. The node that it is below and those before it are as they
  /// were.
  std::optional<std::uint32_t> bad;
};

/// Boxes anew, from the last node to the first; which children a node has stays. Every child's box
/// contains its triangles, or the box_of() its node, exactly, whatever the triangles are:
///
/// - A leaf's box is the least and the largest of words.
/// - A node's origin is the lower corner of all children's boxes. With m the larger one of the
///   exponents of that corner and of the upper one, all corners become integers of 2^(m-24), a bit
///   more than the longest has, rounded to that side on which boxes grow, and differences of them
///   bytes, rounded likewise; a difference below zero, which no corner has, is zero. So containment
///   needs nothing of what is lost.
/// - It does not cost much either: only numbers below half of the larger end (M) lose something.
///   Then the node is longer than M / 2, a byte is 2^16 integers at least, and what is lost takes
///   no more than one byte more.
/// - Bytes are the finest that fit and are no finer than the integers, nor than 2^-80. The exponent
///   is 37 at most, also with what boxes grow by on the way to the root, two bytes a level at most.
/// - The box of a child that is a node is what its words say: box_of().
///
/// The two zeros are +0. Bytes of places without a child are 0. A node without children, which only
/// a tree of nothing has to have, stays as it is, and is the point of its origin to its parent.
/// Errors: kUsage if there are more or fewer triangles than slots, and as hierarchy::check.
[[nodiscard]] Refitted refit(std::span<const hierarchy::Node> nodes,
                             std::span<const std::uint32_t> order, const TriangleView& triangles);

/// From a node's origin to the largest of its children's upper corners, which is rounded up. It
/// contains the boxes of all of the children, as their bytes say them, exactly, and of the nodes
/// below them.
[[nodiscard]] Eigen::AlignedBox3f box_of(const hierarchy::Node& node);

}  // namespace cde::reference
