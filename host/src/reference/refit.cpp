// SPDX-License-Identifier: Apache-2.0
#include "cde/reference/refit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>

#include "cde/bvh/bvh.hpp"
#include "cde/support/error.hpp"

namespace cde::reference {
namespace {

using bvh::Child;
using bvh::Node;
using Eigen::AlignedBox3f;

/// An fp32 number as mantissa 2^(exponent - 151), with one bit below fp32's.
struct Number {
  std::int64_t mantissa;
  int exponent;
};
Number number(float x) {
  const auto word = std::bit_cast<std::uint32_t>(x);
  const auto field = static_cast<int>(word >> 23 & 0xff);
  const std::int64_t size = (word & 0x7fffff) | (field != 0 ? 0x800000 : 0);
  return {2 * (word >> 31 != 0 ? -size : size), std::max(field, 1)};
}

// Divides by 2^shift and rounds down, also below zero.
std::int64_t floored(std::int64_t x, int shift) {
  return x >> std::min(shift, 62);
}
std::int64_t ceiled(std::int64_t x, int shift) {
  return -floored(-x, shift);
}

/// x 2^(exponent - 151), rounded up to fp32. The exponent is at least 54.
float rounded_up(std::int64_t x, int exponent) {
  if (x == 0) return 0;
  const std::uint64_t size = static_cast<std::uint64_t>(x < 0 ? -x : x);
  const int more = std::bit_width(size) - 24;  // excess bits over a mantissa
  std::uint64_t mantissa = size;
  if (more < 0) mantissa <<= -more;
  if (more > 0) mantissa = static_cast<std::uint64_t>(x < 0 ? -ceiled(x, more) : ceiled(x, more));
  // A mantissa of 2^24 carries into the exponent.
  const auto word = (static_cast<std::uint64_t>(exponent + more - 2) << 23) + mantissa;
  return std::bit_cast<float>(static_cast<std::uint32_t>(word) | (x < 0 ? 0x80000000u : 0));
}

/// One axis of a node: converts coordinates to bytes from its origin and exponent.
class Axis {
 public:
  Axis(float lower, float upper)
      : most_(std::max(number(lower).exponent, number(upper).exponent)),
        down_(down(lower)),
        up_(up(lower)) {
    const std::int64_t length = up(upper) - down_;
    while (ceiled(length, shift_) > 255) ++shift_;
    shift_ = std::max(shift_, Node::kLeastExponent - (most_ - 151));
  }
  [[nodiscard]] int exponent() const { return most_ - 151 + shift_; }
  [[nodiscard]] std::uint8_t lower(float corner) const {
    return static_cast<std::uint8_t>(
        floored(std::max<std::int64_t>(down(corner) - up_, 0), shift_));
  }
  [[nodiscard]] std::uint8_t upper(float corner) const {
    return static_cast<std::uint8_t>(ceiled(up(corner) - down_, shift_));
  }

 private:
  [[nodiscard]] std::int64_t down(float x) const {
    return floored(number(x).mantissa, most_ - number(x).exponent);
  }
  [[nodiscard]] std::int64_t up(float x) const {
    return ceiled(number(x).mantissa, most_ - number(x).exponent);
  }
  int most_, shift_ = 0;
  std::int64_t down_, up_;  // the origin, rounded down and up
};

void set_boxes(Node& node, const std::array<AlignedBox3f, Node::kChildren>& boxes) {
  AlignedBox3f all;
  for (unsigned i = 0; i < boxes.size(); ++i)
    if (node.child(i) != Child::kNone) all.extend(boxes[i]);
  if (all.isEmpty()) return;
  node.set_origin(all.min() + Eigen::Vector3f::Zero());  // -0 becomes +0
  for (int k = 0; k < 3; ++k) {
    const Axis axis(all.min()[k], all.max()[k]);
    node.set_exponent(k, axis.exponent());
    for (unsigned i = 0; i < boxes.size(); ++i) {
      const bool there = node.child(i) != Child::kNone;
      node.set_corner(false, i, k, there ? axis.lower(boxes[i].min()[k]) : 0);
      node.set_corner(true, i, k, there ? axis.upper(boxes[i].max()[k]) : 0);
    }
  }
}

}  // namespace

AlignedBox3f box_of(const Node& node) {
  AlignedBox3f box;
  for (int k = 0; k < 3; ++k) {
    std::uint8_t most = 0;
    for (unsigned i = 0; i < Node::kChildren; ++i)
      if (node.child(i) != Child::kNone) most = std::max(most, node.upper(i, k));
    const Number origin = number(node.origin()[k]);
    const int byte_exponent = node.exponent(k) + 134;  // its mantissa is at most 2^17
    const int exponent = std::max(origin.exponent, byte_exponent);
    const std::int64_t sum = ceiled(origin.mantissa, exponent - origin.exponent) +
                             ceiled(std::int64_t{most} << 17, exponent - byte_exponent);
    box.min()[k] = node.origin()[k];
    box.max()[k] = rounded_up(sum, exponent);
  }
  return box;
}

Refitted refit(std::span<const Node> nodes, std::span<const std::uint32_t> order,
               const TriangleView& triangles) {
  if (triangles.size() != order.size())
    throw Error(ErrorCode::kUsage,
                fmt::format("{} triangles for a BVH of {}", triangles.size(), order.size()));
  (void)bvh::check(nodes, order.size());
  Refitted refitted{{nodes.begin(), nodes.end()}, {}};
  for (std::size_t n = nodes.size(); n-- > 0;) {
    Node& node = refitted.nodes[n];
    std::array<AlignedBox3f, Node::kChildren> boxes;
    for (unsigned i = 0; i < boxes.size(); ++i) {
      const std::uint32_t place = node.place(i);
      if (node.child(i) == Child::kNode) boxes[i] = box_of(refitted.nodes[place]);
      for (std::uint32_t s = place; s < place + slots_of(node.child(i)); ++s) {
        const Triangle t = triangles[order[s]];
        for (const Eigen::Vector3f& v : {t.v0, t.v1, t.v2}) {
          if (!(v.array().abs() <= 0x1p40f).all()) {
            refitted.bad = s;
            return refitted;
          }
          boxes[i].extend(v);
        }
      }
    }
    set_boxes(node, boxes);
  }
  return refitted;
}

}  // namespace cde::reference
