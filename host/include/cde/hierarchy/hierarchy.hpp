// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "cde/hierarchy/node.hpp"
#include "cde/mesh/triangle_view.hpp"

namespace cde {

struct HierarchyOptions {
  unsigned leaf = 2;     ///< secondaries a leaf, 1 or 2
  unsigned threads = 0;  ///< 0: as many as there are processors
};

/// A tree of boxes over secondaries, eight wide, whose nodes are those of the card. Boxes contain
/// what is below them exactly, whatever they were rounded from: a query that leaves out boxes it
/// cannot meet answers as one of all secondaries.
class Hierarchy {
 public:
  /// Levels of nodes at most, which is what a card's stack is for.
  static constexpr unsigned kMostDepth = 16;

  /// None: of no secondaries.
  Hierarchy();

  /// By binned surface area (Wald, IRT 2007), two wide, of which each node of eight is collapsed
  /// (Wald, Benthin, Boulos, IRT 2008); split at medians where a tree of kMostDepth would not hold
  /// it otherwise. The same for every number of threads. Errors: kUsage (a leaf of 0 or more than
  /// 2), kBadInput (a box that is empty, not finite or beyond 2^40, or a solid with a defect, by
  /// its number), kCapacity (more than 2^28 secondaries).
  [[nodiscard]] static Hierarchy build(std::span<const Eigen::AlignedBox3f> boxes,
                                       const HierarchyOptions& options = {});
  [[nodiscard]] static Hierarchy build(const TriangleView& triangles,
                                       const HierarchyOptions& options = {});
  [[nodiscard]] static Hierarchy build(std::span<const Sphere> spheres,
                                       const HierarchyOptions& options = {});
  [[nodiscard]] static Hierarchy build(std::span<const Aabb> boxes,
                                       const HierarchyOptions& options = {});
  [[nodiscard]] static Hierarchy build(std::span<const Obb> boxes,
                                       const HierarchyOptions& options = {});

  /// One of parts, which have so many of the secondaries one behind the other: a tree each
  /// (parts()), below one over their boxes, so that each stays a good one wherever it goes.
  /// hierarchy_of() in board.hpp makes one of objects. Errors beside those above: kUsage if there
  /// is no part, one is empty, or they are not all secondaries; kCapacity for more than 32,768;
  /// what is said of a box names its part.
  [[nodiscard]] static Hierarchy build(const TriangleView& triangles,
                                       std::span<const std::uint32_t> parts,
                                       const HierarchyOptions& options = {});
  [[nodiscard]] static Hierarchy build(std::span<const Sphere> spheres,
                                       std::span<const std::uint32_t> parts,
                                       const HierarchyOptions& options = {});
  [[nodiscard]] static Hierarchy build(std::span<const Aabb> boxes,
                                       std::span<const std::uint32_t> parts,
                                       const HierarchyOptions& options = {});
  [[nodiscard]] static Hierarchy build(std::span<const Obb> boxes,
                                       std::span<const std::uint32_t> parts,
                                       const HierarchyOptions& options = {});

  /// Boxes anew for secondaries that have moved; the tree stays. Error kUsage if there are more or
  /// fewer, and as build().
  void refit(std::span<const Eigen::AlignedBox3f> boxes);
  void refit(const TriangleView& triangles);
  void refit(std::span<const Sphere> spheres);
  void refit(std::span<const Aabb> boxes);
  void refit(std::span<const Obb> boxes);

  /// The root first, and each node before those below it; one node at least.
  [[nodiscard]] std::span<const hierarchy::Node> nodes() const { return nodes_; }
  /// A part's nodes but for its root, which lie together, and how many secondaries it has. Those of
  /// all parts fill nodes() and order() to their ends, one behind the other.
  struct Part {
    std::uint32_t first_node = 0, nodes = 0, secondaries = 0;
    bool operator==(const Part&) const = default;
  };
  /// Those that it was built of, in their order.
  [[nodiscard]] std::span<const Part> parts() const { return parts_; }
  /// Which secondary is in each slot.
  [[nodiscard]] std::span<const std::uint32_t> order() const { return order_; }
  /// Of all secondaries; empty without.
  [[nodiscard]] const Eigen::AlignedBox3f& box() const { return box_; }
  /// Levels of nodes.
  [[nodiscard]] unsigned depth() const { return depth_; }
  /// What a random line that meets the root is expected to visit: nodes, and secondaries of leaves
  /// that it enters.
  struct Visits {
    double nodes = 0, secondaries = 0;
  };
  [[nodiscard]] Visits expected_visits() const;

  /// A file that load() reads on any machine. Error kFile.
  void save(const std::filesystem::path& path) const;
  /// Error kFile, which names the file and what is wrong with it: not a hierarchy, of another
  /// version, cut off, damaged (a checksum), or not a tree. Whether boxes are those of some
  /// secondaries it cannot say: refit() makes them so.
  [[nodiscard]] static Hierarchy load(const std::filesystem::path& path);

 private:
  friend class HierarchyBuilder;
  using BoxOf = std::function<Eigen::AlignedBox3f(std::size_t)>;
  [[nodiscard]] static Hierarchy build(std::size_t count, const BoxOf& box,
                                       const HierarchyOptions& options, unsigned depth);
  [[nodiscard]] static Hierarchy build(std::size_t count, const BoxOf& box,
                                       std::span<const std::uint32_t> parts,
                                       const HierarchyOptions& options);
  void refit(std::size_t count, const BoxOf& box);
  [[nodiscard]] static Hierarchy joined(std::span<const Hierarchy> trees);
  void add_part(const Hierarchy& tree, std::size_t root);
  std::vector<hierarchy::Node> nodes_;
  std::vector<std::uint32_t> order_;
  std::vector<Part> parts_;
  Eigen::AlignedBox3f box_;
  unsigned depth_ = 1;
};

namespace hierarchy {

/// Levels of the nodes. Error kBadInput, which names node and child, unless they are a tree over
/// `slots` slots: every node behind its parent and below one parent, every slot in one leaf, no
/// deeper than Hierarchy::kMostDepth, with exponents in range, origins finite and no lower corner
/// above its upper one.
unsigned check(std::span<const Node> nodes, std::size_t slots);

/// Error kBadInput unless the parts are those of such a tree: what is below a node of a part is of
/// the same one.
void check(std::span<const Node> nodes, std::size_t slots, std::span<const Hierarchy::Part> parts);

/// Gives the node the children's boxes; those of kNone are not looked at. Boxes are within 2^40.
void set_boxes(Node& node, std::span<const Eigen::AlignedBox3f> children);

}  // namespace hierarchy
}  // namespace cde
