// SPDX-License-Identifier: Apache-2.0
// Primaries and BVH nodes in gates against the reference, bit by bit: one of each per cycle.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <deque>

#include "NodeBoxes.h"
#include "RayFrontLong.h"
#include "RayFrontShort.h"
#include "RayFrontSpheres.h"
#include "cde/bvh/bvh.hpp"
#include "cde/reference/integer_node.hpp"
#include "cde/reference/pipes/solid_node.hpp"
#include "clocked.hpp"

namespace cde::testing {
namespace {

using Eigen::Vector3f;
using reference::IntegerRay;
using reference::RootBounds;
using reference::SolidFront;

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
std::array<std::uint32_t, 9> words(const IntegerRay& front) {
  std::array<std::uint32_t, 9> w{};
  for (unsigned k = 0; k < 3; ++k) {
    const int axis = static_cast<int>(k);
    w[k] = word(front.o[axis]);
    w[3 + k] = word(front.margin[axis]);
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
    expected.push_back(words(reference::integer_ray(o, d, root, leaf)));
    infinite += std::isinf(std::bit_cast<float>(expected.back()[3]));
    module.clock();
    if (expected.size() < latency) continue;
    for (unsigned i = 0; i < 9; ++i)
      ASSERT_EQ(module->r_o[i], expected.front()[i]) << clock << ", word " << i;
    expected.pop_front();
  }
  // Only a BVH over spheres gives infinite margins, for some rays.
  EXPECT_EQ(infinite > 100, leaf == Shape::kSphere);
  EXPECT_LT(infinite, 10'000u);
}

TEST(RayFront, Fronts_EqualTheReference) {
  test_rays<RayFrontShort>(7);                     // all operators take one cycle
  test_rays<RayFrontLong>(4 + 3 * 2 + 3 + 4 + 3);  // 4 add, 3 mul, 2 compare, 12 div
  test_rays<RayFrontSpheres>(11, Shape::kSphere);  // 3 mul
}

TEST(NodeBoxes, Boxes_EqualTheReference) {
  Clocked<NodeBoxes> module;
  Draw draw;
  struct Expected {
    std::array<std::uint32_t, 24> above, below;
  };
  std::deque<Expected> expected;
  constexpr unsigned kLatency = 2 * 3;  // as in CMakeLists.txt
  for (int clock = 0; clock < 20'000; ++clock) {
    const Vector3f a = draw.vector(-10, 38), b = draw.vector(-10, 38);
    const SolidFront<float> solid{a.cwiseMax(b), a.cwiseMin(b)};
    const bvh::Node node = draw.node();
    for (unsigned k = 0; k < 3; ++k) {
      module->solid_i[k] = word(solid.upper[static_cast<int>(k)]);
      module->solid_i[3 + k] = word(solid.lower[static_cast<int>(k)]);
    }
    std::copy(node.words.begin(), node.words.end(), &module->node_i[0]);
    const auto front = reference::solid_node(solid, node);
    Expected e{};
    for (unsigned i = 0; i < 8; ++i) {
      const auto axes = reference::axis_distances(front, node, i);
      for (unsigned k = 0; k < 3; ++k) {
        e.above.at(8 * k + i) = word(axes.above[static_cast<int>(k)]);
        e.below.at(8 * k + i) = word(axes.below[static_cast<int>(k)]);
      }
    }
    expected.push_back(e);
    module.clock();
    if (expected.size() < kLatency) continue;
    for (unsigned w = 0; w < 24; ++w) {
      ASSERT_EQ(module->above_o[w], expected.front().above.at(w)) << clock << ", word " << w;
      ASSERT_EQ(module->below_o[w], expected.front().below.at(w)) << clock << ", word " << w;
    }
    expected.pop_front();
  }
}

}  // namespace
}  // namespace cde::testing
