// SPDX-License-Identifier: Apache-2.0
// Rays and BVH nodes in gates against the reference, bit by bit: one of each per cycle.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <deque>

#include "NodeBoxes.h"
#include "RayFrontLong.h"
#include "RayFrontShort.h"
#include "RayFrontSpheres.h"
#include "cde/bvh/bvh.hpp"
#include "cde/reference/pipes/ray_node.hpp"
#include "clocked.hpp"

namespace cde::testing {
namespace {

using Eigen::Vector3f;
using reference::RayFront;
using reference::RootBounds;

class Draw {
 public:
  float unit() { return static_cast<float>(dice_.below(1u << 24)) * 0x1p-23f - 1; }
  /// Values from 2^low to 2^high.
  float number(int low, int high) {
    return std::ldexp(unit(),
                      low + static_cast<int>(dice_.below(static_cast<unsigned>(high - low + 1))));
  }
  Vector3f vector(int low, int high) {
    return {number(low, high), number(low, high), number(low, high)};
  }
  /// A direction with zeros of either sign among its components.
  Vector3f direction() {
    Vector3f d = vector(-20, 20);
    for (float& x : d)
      if (dice_.once_in(6)) x = std::copysign(0.0f, x);
    if (d.isZero()) d.x() = -1;
    return d;
  }
  RootBounds<float> root() {
    const Vector3f a = vector(-10, 30), b = vector(-10, 30);
    return reference::root_bounds<float>(a.cwiseMin(b), a.cwiseMax(b));
  }
  bvh::Node node() {
    std::array<Eigen::AlignedBox3f, bvh::Node::kChildren> boxes;
    bvh::Node node;
    for (unsigned i = 0; i < boxes.size(); ++i) {
      if (!dice_.once_in(10)) node.set_child(i, static_cast<bvh::Child>(1 + dice_.below(3)));
      for (int corner = 0; corner < 2; ++corner) boxes[i].extend(vector(-10, 30));
    }
    bvh::set_boxes(node, boxes);
    return node;
  }
  Dice& dice() { return dice_; }

 private:
  Dice dice_;
};

std::uint32_t word(float x) {
  return std::bit_cast<std::uint32_t>(x);
}

/// Words of a ray's front as ray_front.sv gives them.
std::array<std::uint32_t, 9> words(const RayFront<float>& front) {
  std::array<std::uint32_t, 9> w{};
  for (unsigned k = 0; k < 3; ++k) {
    const int axis = static_cast<int>(k);
    w[k] = word(front.above[axis]);
    w[3 + k] = word(front.below[axis]);
    w[6 + k] = word(front.inverse[axis]);
  }
  return w;
}

template <class Module>
void test_rays(unsigned latency, Shape leaf = Shape::kTriangle) {
  Clocked<Module> module;
  Draw draw;
  std::deque<std::array<std::uint32_t, 9>> expected;
  unsigned infinite = 0;
  for (int clock = 0; clock < 20'000; ++clock) {
    const RootBounds<float> root = draw.root();
    const Vector3f o = draw.vector(-10, 38), d = draw.direction();
    for (unsigned k = 0; k < 3; ++k) {
      const int axis = static_cast<int>(k);
      module->a_i[k] = word(o[axis]);
      module->a_i[3 + k] = word(d[axis]);
      module->root_i[k] = word(root.lower[axis]);
      module->root_i[3 + k] = word(root.upper[axis]);
    }
    module->root_i[6] = word(root.margin);
    expected.push_back(words(reference::ray_front<float>(o, d, root, leaf)));
    infinite += std::isinf(std::bit_cast<float>(expected.back()[0]));
    module.clock();
    if (expected.size() < latency) continue;
    for (unsigned i = 0; i < 9; ++i)
      ASSERT_EQ(module->r_o[i], expected.front()[i]) << clock << ", word " << i;
    expected.pop_front();
  }
  // Only a BVH over spheres gives infinite bounds, for some rays.
  EXPECT_EQ(infinite > 100, leaf == Shape::kSphere);
  EXPECT_LT(infinite, 10'000u);
}

TEST(RayFront, Fronts_EqualTheReference) {
  test_rays<RayFrontShort>(7);                     // all operators take one cycle
  test_rays<RayFrontLong>(4 + 3 * 2 + 3 + 4 + 4);  // 4 add, 3 mul, 2 compare, 12 div
  test_rays<RayFrontSpheres>(9, Shape::kSphere);   // 3 mul
}

TEST(NodeBoxes, Boxes_EqualTheReference) {
  Clocked<NodeBoxes> module;
  Draw draw;
  struct Expected {
    bvh::Node node;
    std::array<std::uint32_t, 8> near, far;
  };
  std::deque<Expected> expected;
  constexpr unsigned kLatency = 2 * 3 + 2 * 2 + 2 * 1;  // as in CMakeLists.txt
  for (int clock = 0; clock < 20'000; ++clock) {
    const RayFront<float> ray =
        reference::ray_front<float>(draw.vector(-10, 38), draw.direction(), draw.root());
    Expected e{.node = draw.node(), .near = {}, .far = {}};
    const auto w = words(ray);
    std::copy(w.begin(), w.end(), &module->ray_i[0]);
    std::copy(e.node.words.begin(), e.node.words.end(), &module->node_i[0]);
    const auto front = reference::node_front(ray, e.node);
    for (unsigned i = 0; i < 8; ++i) {
      const auto s = reference::stretch(reference::axis_stretch(front, ray, e.node, i));
      e.near[i] = word(s.near), e.far[i] = word(s.far);
    }
    expected.push_back(e);
    module.clock();
    if (expected.size() < kLatency) continue;
    for (unsigned i = 0; i < 8; ++i) {
      ASSERT_EQ(module->near_o[i], expected.front().near[i]) << clock << ", child " << i;
      ASSERT_EQ(module->far_o[i], expected.front().far[i]) << clock << ", child " << i;
    }
    expected.pop_front();
  }
}

}  // namespace
}  // namespace cde::testing
