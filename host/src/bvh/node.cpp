// SPDX-License-Identifier: Apache-2.0
// Child boxes in bytes, rounded outwards, and the check that nodes form a tree.
#include "cde/bvh/node.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "cde/bvh/bvh.hpp"
#include "cde/support/error.hpp"

namespace cde::bvh {
namespace {

/// a - b of floats, exactly: the nearest double and the remainder.
struct Difference {
  double nearest, rest;
};
Difference difference(float a, float b) {
  const double x = a, y = -static_cast<double>(b);  // the error-free sum of two doubles (Knuth)
  const double sum = x + y, z = sum - x;
  return {sum, (x - (sum - z)) + (y - z)};
}

/// The distance from origin up to a corner in units of 2^exponent, rounded away from the box. The
/// corner is not below the origin.
double units(bool upper, float corner, float origin, int exponent) {
  const Difference d = difference(corner, origin);
  const double length = std::ldexp(d.nearest, -exponent);
  if (upper) return std::ceil(length) + (std::ceil(length) == length && d.rest > 0 ? 1 : 0);
  return std::floor(length) - (std::floor(length) == length && d.rest < 0 ? 1 : 0);
}

}  // namespace

void set_boxes(Node& node, std::span<const Eigen::AlignedBox3f> children) {
  Eigen::AlignedBox3f all;
  for (unsigned i = 0; i < children.size(); ++i)
    if (node.child(i) != Child::kNone) all.extend(children[i]);
  if (all.isEmpty()) return;
  node.set_origin(all.min());
  for (int k = 0; k < 3; ++k) {
    int exponent = Node::kLeastExponent;
    while (units(true, all.max()[k], all.min()[k], exponent) > 255) {
      // The first step nearly reaches the exponent. Rounding up may need one more.
      const double length = static_cast<double>(all.max()[k]) - all.min()[k];
      exponent = std::max(exponent + 1, std::ilogb(length) - 7);
    }
    node.set_exponent(k, exponent);
    for (unsigned i = 0; i < children.size(); ++i) {
      if (node.child(i) == Child::kNone) continue;
      for (const bool upper : {false, true}) {
        const float corner = upper ? children[i].max()[k] : children[i].min()[k];
        node.set_corner(upper, i, k,
                        static_cast<std::uint8_t>(units(upper, corner, all.min()[k], exponent)));
      }
    }
  }
}

namespace {

/// Checks all nodes in order and marks every child and slot that it meets.
class Check {
 public:
  Check(std::span<const Node> nodes, std::size_t slots)
      : nodes_(nodes), levels_(nodes.size(), 0), filled_(slots, false) {
    if (nodes.empty()) throw Error(ErrorCode::kBadInput, "a BVH without a root");
    levels_[0] = 1;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      if (levels_[n] == 0) fail(n, "has no parent");
      depth_ = std::max(depth_, levels_[n]);
      look_at(n);
    }
    for (std::size_t s = 0; s < slots; ++s)
      if (!filled_[s]) throw Error(ErrorCode::kBadInput, fmt::format("slot {} is in no leaf", s));
  }
  [[nodiscard]] unsigned depth() const { return depth_; }

 private:
  [[noreturn]] static void fail(std::size_t node, const std::string& what) {
    throw Error(ErrorCode::kBadInput, fmt::format("node {} {}", node, what));
  }

  void look_at(std::size_t n) {
    const Node& node = nodes_[n];
    if (!node.origin().allFinite()) fail(n, "has an origin that is not finite");
    for (int k = 0; k < 3; ++k)
      if (node.exponent(k) < Node::kLeastExponent || node.exponent(k) > Node::kMostExponent)
        fail(n, fmt::format("has exponent {}; expected {} to {}", node.exponent(k),
                            Node::kLeastExponent, Node::kMostExponent));
    for (unsigned i = 0; i < Node::kChildren; ++i) {
      if (node.child(i) == Child::kNone) continue;
      for (int k = 0; k < 3; ++k)
        if (node.lower(i, k) > node.upper(i, k))
          fail(n, fmt::format("child {}: its lower corner is above its upper one", i));
      if (node.child(i) == Child::kNode)
        below(n, i, node.place(i));
      else
        leaf(n, i, node.place(i), slots_of(node.child(i)));
    }
  }

  void below(std::size_t n, unsigned i, std::uint32_t child) {
    if (child >= nodes_.size()) fail(n, fmt::format("child {}: there is no node {}", i, child));
    if (child <= n) fail(n, fmt::format("child {}: node {} does not follow its parent", i, child));
    if (levels_[child] != 0)
      fail(n, fmt::format("child {}: node {} already has a parent", i, child));
    levels_[child] = levels_[n] + 1;
    if (levels_[child] > Bvh::kMostDepth)
      fail(n, fmt::format("child {} is deeper than {} levels", i, Bvh::kMostDepth));
  }

  void leaf(std::size_t n, unsigned i, std::uint32_t slot, unsigned count) {
    for (std::uint32_t s = slot; s < slot + count; ++s) {
      if (s >= filled_.size()) fail(n, fmt::format("child {}: there is no slot {}", i, s));
      if (filled_[s]) fail(n, fmt::format("child {}: slot {} is also in another leaf", i, s));
      filled_[s] = true;
    }
  }

  std::span<const Node> nodes_;
  std::vector<unsigned> levels_;
  std::vector<bool> filled_;
  unsigned depth_ = 0;
};

}  // namespace

unsigned check(std::span<const Node> nodes, std::size_t slots) {
  return Check(nodes, slots).depth();
}

void check(std::span<const Node> nodes, std::size_t slots, std::span<const Bvh::Part> parts) {
  if (parts.empty()) return;
  std::size_t node = parts.front().first_node, slot = 0;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const auto fail = [k](const std::string& what) {
      throw Error(ErrorCode::kBadInput, fmt::format("part {} {}", k, what));
    };
    const std::size_t nodes_end = node + parts[k].nodes, slots_end = slot + parts[k].secondaries;
    if (node == 0 || parts[k].first_node != node) fail("does not follow the part before it");
    if (nodes_end > nodes.size() || slots_end > slots) fail("exceeds the nodes or slots");
    for (std::size_t n = node; n < nodes_end; ++n) {
      for (unsigned i = 0; i < Node::kChildren; ++i) {
        const std::size_t place = nodes[n].place(i), count = slots_of(nodes[n].child(i));
        if (nodes[n].child(i) == Child::kNode
                ? place < node || place >= nodes_end
                : count != 0 && (place < slot || place + count > slots_end))
          fail(fmt::format("has another part's node or slot in node {}", n));
      }
    }
    node = nodes_end;
    slot = slots_end;
  }
  if (node != nodes.size() || slot != slots)
    throw Error(ErrorCode::kBadInput, "the parts do not cover all nodes and slots");
}

}  // namespace cde::bvh
