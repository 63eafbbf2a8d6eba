// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "cde/bvh/node.hpp"
#include "cde/mesh/triangle_view.hpp"

namespace cde {

struct BvhOptions {
  unsigned leaf = 2;     ///< secondaries per leaf, 1 or 2
  unsigned threads = 0;  ///< 0: one per processor
};

/// A BVH over secondaries, eight wide, whose nodes have the card's format. A box contains
/// everything below it exactly, whatever rounding produced it. Thus a query that culls boxes
/// returns the same results as brute force.
class Bvh {
 public:
  /// Most levels of nodes: the depth of a card's stack.
  static constexpr unsigned kMostDepth = 16;

  /// The BVH of no secondaries.
  Bvh();

  /// Builds a binary BVH by binned surface area (Wald, IRT 2007) and collapses it to nodes of eight
  /// (Wald, Benthin, Boulos, IRT 2008). Where it would become deeper than kMostDepth it splits at
  /// medians. The result does not depend on the number of threads.
  /// Error kUsage: leaf is 0 or above 2. Error kBadInput, with the number: a box is empty, not
  /// finite or beyond 2^40, or a solid has a defect. Error kCapacity: more than 2^28 secondaries.
  [[nodiscard]] static Bvh build(std::span<const Eigen::AlignedBox3f> boxes,
                                 const BvhOptions& options = {});
  [[nodiscard]] static Bvh build(const TriangleView& triangles, const BvhOptions& options = {});
  [[nodiscard]] static Bvh build(std::span<const Sphere> spheres, const BvhOptions& options = {});
  [[nodiscard]] static Bvh build(std::span<const Aabb> boxes, const BvhOptions& options = {});
  [[nodiscard]] static Bvh build(std::span<const Obb> boxes, const BvhOptions& options = {});

  /// Builds a BVH of parts. `parts` holds the number of secondaries of each part, which are
  /// consecutive. Each part has its own BVH (parts()), and a top BVH is built over their boxes. A
  /// part's BVH thus stays good wherever the part moves. Function bvh_of() in board.hpp builds one
  /// from objects.
  /// Errors beside those above: kUsage if there is no part, a part is empty, or the parts do not
  /// add up. Error kCapacity for more than 32,768 parts. Messages about a box name its part.
  [[nodiscard]] static Bvh build(const TriangleView& triangles,
                                 std::span<const std::uint32_t> parts,
                                 const BvhOptions& options = {});
  [[nodiscard]] static Bvh build(std::span<const Sphere> spheres,
                                 std::span<const std::uint32_t> parts,
                                 const BvhOptions& options = {});
  [[nodiscard]] static Bvh build(std::span<const Aabb> boxes, std::span<const std::uint32_t> parts,
                                 const BvhOptions& options = {});
  [[nodiscard]] static Bvh build(std::span<const Obb> boxes, std::span<const std::uint32_t> parts,
                                 const BvhOptions& options = {});

  /// Refits the boxes after secondaries have moved; the topology stays. Errors as for build(), and
  /// kUsage if their number has changed.
  void refit(std::span<const Eigen::AlignedBox3f> boxes);
  void refit(const TriangleView& triangles);
  void refit(std::span<const Sphere> spheres);
  void refit(std::span<const Aabb> boxes);
  void refit(std::span<const Obb> boxes);

  /// The root first, each node before its descendants; at least one node.
  [[nodiscard]] std::span<const bvh::Node> nodes() const { return nodes_; }
  /// Nodes of a part, which are consecutive and exclude its root, and its number of secondaries.
  /// The parts fill nodes() and order() to their ends, one after another.
  struct Part {
    std::uint32_t first_node = 0, nodes = 0, secondaries = 0;
    bool operator==(const Part&) const = default;
  };
  /// The parts that it was built from, in their order.
  [[nodiscard]] std::span<const Part> parts() const { return parts_; }
  /// Index of the secondary in each slot.
  [[nodiscard]] std::span<const std::uint32_t> order() const { return order_; }
  /// Box of all secondaries; empty without any.
  [[nodiscard]] const Eigen::AlignedBox3f& box() const { return box_; }
  /// Number of levels of nodes.
  [[nodiscard]] unsigned depth() const { return depth_; }
  /// Expected visits of a random line that hits the root: nodes, and secondaries in the leaves it
  /// enters.
  struct Visits {
    double nodes = 0, secondaries = 0;
  };
  [[nodiscard]] Visits expected_visits() const;

  /// Writes a file that load() reads on any machine. Error kFile.
  void save(const std::filesystem::path& path) const;
  /// Error kFile, naming the file and the problem: not a BVH, another version, truncated, damaged
  /// (checksum), or not a tree. It cannot check that the boxes fit given secondaries; refit() makes
  /// them fit.
  [[nodiscard]] static Bvh load(const std::filesystem::path& path);

 private:
  friend class BvhBuilder;
  using BoxOf = std::function<Eigen::AlignedBox3f(std::size_t)>;
  [[nodiscard]] static Bvh build(std::size_t count, const BoxOf& box, const BvhOptions& options,
                                 unsigned depth);
  [[nodiscard]] static Bvh build(std::size_t count, const BoxOf& box,
                                 std::span<const std::uint32_t> parts, const BvhOptions& options);
  void refit(std::size_t count, const BoxOf& box);
  [[nodiscard]] static Bvh joined(std::span<const Bvh> bvhs);
  void add_part(const Bvh& bvh, std::size_t root);
  std::vector<bvh::Node> nodes_;
  std::vector<std::uint32_t> order_;
  std::vector<Part> parts_;
  Eigen::AlignedBox3f box_;
  unsigned depth_ = 1;
};

namespace bvh {

/// Checks that the nodes are a tree over `slots` slots. Returns its number of levels. Every node
/// must come after its only parent, and every slot must be in one leaf. The BVH must not be deeper
/// than Bvh::kMostDepth. Exponents must be in range, origins finite, and lower corners not above
/// upper ones. Error kBadInput, naming node and child.
unsigned check(std::span<const Node> nodes, std::size_t slots);

/// Error kBadInput unless the parts partition such a BVH: all descendants of a part's node belong
/// to the same part.
void check(std::span<const Node> nodes, std::size_t slots, std::span<const Bvh::Part> parts);

/// Sets the boxes of the node's children. Boxes of kNone are ignored. Boxes are within 2^40.
void set_boxes(Node& node, std::span<const Eigen::AlignedBox3f> children);

}  // namespace bvh
}  // namespace cde
