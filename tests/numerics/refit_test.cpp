// SPDX-License-Identifier: Apache-2.0
// The result of a card's refit, in exact integers: boxes contain their triangles, and are not much
// larger. bvh_test.cpp tests records of rays against such a BVH.
#include "cde/reference/refit.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <boost/multiprecision/cpp_int.hpp>
#include <numeric>

#include "cde/mesh/terrain.hpp"
#include "cde/support/error.hpp"
#include "refit_scenes.hpp"
#include "rewritten.hpp"

namespace cde::testing {
namespace {

using bvh::Child;
using bvh::Node;
using Eigen::AlignedBox3f;
using Integer = boost::multiprecision::cpp_int;

/// In units of 2^-149: every fp32 number is an integer.
Integer exact(float x) {
  const auto word = std::bit_cast<std::uint32_t>(x);
  const unsigned field = word >> 23 & 0xff;
  const Integer size = Integer((word & 0x7fffff) | (field != 0 ? 0x800000 : 0))
                       << (std::max(field, 1u) - 1);
  return word >> 31 != 0 ? Integer(-size) : size;
}
Integer unit(const Node& node, int axis) {
  return Integer(1) << (node.exponent(axis) + 149);
}
Integer side(const Node& node, bool upper, unsigned child, int axis) {
  const unsigned q = upper ? node.upper(child, axis) : node.lower(child, axis);
  return exact(node.origin()[axis]) + q * unit(node, axis);
}

/// Checks that child i contains its triangles, with less than two bytes of excess.
void expect_child(const Node& node, unsigned i, int axis, const Integer& low, const Integer& high) {
  const Integer origin = exact(node.origin()[axis]), byte = unit(node, axis);
  ASSERT_LE(side(node, false, i, axis), low);
  ASSERT_GE(side(node, true, i, axis), high);
  ASSERT_LE(node.lower(i, axis), node.upper(i, axis));
  ASSERT_LT(low - side(node, false, i, axis), 2 * byte) << "too wide by two bytes";
  ASSERT_LT(side(node, true, i, axis) - high, 2 * byte) << "too wide by two bytes";
  ASSERT_GE(low, origin);
}

void expect_axis(const std::vector<Node>& nodes, const Node& node, int axis,
                 const std::vector<AlignedBox3f>& boxes) {
  Integer low, high;
  bool some = false, at_origin = false;
  float reach = 0;
  for (unsigned i = 0; i < Node::kChildren; ++i) {
    if (node.child(i) == Child::kNone) continue;
    const Integer l = exact(boxes[i].min()[axis]), h = exact(boxes[i].max()[axis]);
    expect_child(node, i, axis, l, h);
    if (::testing::Test::HasFatalFailure()) return;
    low = some ? std::min(low, l) : l;
    high = some ? std::max(high, h) : h;
    some = true;
    at_origin = at_origin || (node.lower(i, axis) == 0 && l == exact(node.origin()[axis]));
    reach = std::max({reach, std::abs(boxes[i].min()[axis]), std::abs(boxes[i].max()[axis])});
    if (node.child(i) != Child::kNode) continue;
    // The bounds from that node's own bytes.
    const Node& below = nodes[node.place(i)];
    for (unsigned k = 0; k < Node::kChildren; ++k) {
      if (below.child(k) == Child::kNone) continue;
      ASSERT_LE(side(node, false, i, axis), side(below, false, k, axis));
      ASSERT_GE(side(node, true, i, axis), side(below, true, k, axis));
    }
  }
  if (!some) return;
  ASSERT_TRUE(at_origin) << "no child starts at the origin";
  // No smaller unit would do, unless it is finer than the numbers or the smallest exponent.
  const int finest = std::max(Node::kLeastExponent, std::max(std::ilogb(reach), -126) - 24);
  ASSERT_GE(node.exponent(axis), finest);
  ASSERT_LE(node.exponent(axis), 37);
  if (node.exponent(axis) > finest) {
    ASSERT_GT(high - low, 126 * unit(node, axis)) << "a smaller unit would suffice";
  }
}

void expect_sound(const std::vector<Node>& nodes, const std::vector<std::uint32_t>& order,
                  const Triangles& triangles) {
  (void)bvh::check(nodes, order.size());
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const Node& node = nodes[n];
    std::vector<AlignedBox3f> boxes(Node::kChildren);
    for (unsigned i = 0; i < Node::kChildren; ++i) {
      if (node.child(i) == Child::kNode) boxes[i] = reference::box_of(nodes[node.place(i)]);
      for (std::uint32_t s = node.place(i); s < node.place(i) + slots_of(node.child(i)); ++s) {
        const Triangle& t = triangles[order[s]];
        boxes[i].extend(t.v0).extend(t.v1).extend(t.v2);
      }
    }
    for (int k = 0; k < 3; ++k) {
      SCOPED_TRACE(fmt::format("node {}, axis {}", n, k));
      expect_axis(nodes, node, k, boxes);
      if (::testing::Test::HasFatalFailure()) return;
    }
  }
}

TEST(Refit, Boxes_ContainTheirTriangles) {
  RefitDice dice(1);
  for (const RefitScene& scene : kRefitScenes) {
    SCOPED_TRACE(scene.name);
    for (const std::size_t count : {1, 2, 9, 17, 300, 3000}) {
      const Triangles triangles = scene.make(count, dice);
      for (const unsigned leaf : {1u, 2u}) {
        const Bvh bvh = Bvh::build(triangles, {.leaf = leaf});
        const auto refitted = reference::refit(bvh.nodes(), bvh.order(), triangles);
        ASSERT_FALSE(refitted.bad);
        expect_sound(refitted.nodes, {bvh.order().begin(), bvh.order().end()}, triangles);
        if (::testing::Test::HasFatalFailure()) return;
      }
    }
  }
}

/// BVHs over other triangles, so that nodes have any size anywhere.
TEST(Refit, BoxesOfAnyBvh_ContainTheirTriangles) {
  RefitDice dice(2);
  for (int i = 0; i < 300; ++i) {
    const RandomBvh bvh = random_bvh(1 + dice.below(60), dice);
    const auto which = dice.below(static_cast<unsigned>(std::size(kRefitScenes)));
    const Triangles triangles = kRefitScenes[which].make(bvh.slots, dice);
    std::vector<std::uint32_t> order(bvh.slots);
    std::iota(order.begin(), order.end(), 0u);
    SCOPED_TRACE(fmt::format("BVH {} of {}", i, kRefitScenes[which].name));
    const auto refitted = reference::refit(bvh.nodes, order, triangles);
    ASSERT_FALSE(refitted.bad);
    expect_sound(refitted.nodes, order, triangles);
    if (::testing::Test::HasFatalFailure()) return;
  }
}

TEST(Refit, SecondRefit_ChangesNothing) {
  RefitDice dice(3);
  for (const RefitScene& scene : kRefitScenes) {
    const Triangles triangles = scene.make(500, dice);
    const Bvh bvh = Bvh::build(triangles);
    const auto once = reference::refit(bvh.nodes(), bvh.order(), triangles);
    EXPECT_EQ(reference::refit(once.nodes, bvh.order(), triangles).nodes, once.nodes);
  }
}

TEST(Refit, EmptyBvh_StaysEmpty) {
  const auto refitted = reference::refit(Bvh().nodes(), {}, Triangles{});
  EXPECT_TRUE(std::ranges::equal(refitted.nodes, Bvh().nodes()));
  EXPECT_FALSE(refitted.bad);
}

/// Boxes are built from boxes of bytes, so rays visit more nodes than in a new BVH.
TEST(Refit, RefittedBvh_CostsFewMoreVisits) {
  const Mesh mesh = make_terrain();
  Triangles triangles;
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) triangles.push_back(mesh.triangle(i));
  RefitDice dice(4);
  const std::pair<const char*, Triangles> scenes[] = {
      {"terrain", triangles},
      {"needles", kRefitScenes[2].make(20'000, dice)},
      {"far away", kRefitScenes[10].make(20'000, dice)}};
  for (const auto& [name, all] : scenes) {
    const Bvh fresh = Bvh::build(all);
    const auto nodes = reference::refit(fresh.nodes(), fresh.order(), all).nodes;
    const auto before = fresh.expected_visits();
    const auto after = rewritten(fresh, nodes, fresh.box()).expected_visits();
    fmt::print("{}: nodes {:.3f}, before {:.3f}; secondaries {:.3f}, before {:.3f}\n", name,
               after.nodes, before.nodes, after.secondaries, before.secondaries);
    EXPECT_LT(after.nodes, 1.03 * before.nodes) << name;
    EXPECT_LT(after.secondaries, 1.03 * before.secondaries) << name;
  }
}

TEST(Refit, TriangleWithoutABox_IsNamed) {
  RefitDice dice(5);
  const Triangles good = kRefitScenes[1].make(100, dice);
  const Bvh bvh = Bvh::build(good);
  for (const float x : {std::nanf(""), INFINITY, -INFINITY, 0x1.000002p40f, -0x1.000002p40f}) {
    for (const std::uint32_t slot : {0u, 41u, 99u}) {
      Triangles bad = good;
      bad[bvh.order()[slot]].v2.y() = x;
      const auto refitted = reference::refit(bvh.nodes(), bvh.order(), bad);
      ASSERT_TRUE(refitted.bad);
      EXPECT_EQ(*refitted.bad, slot);
      EXPECT_EQ(refitted.nodes[0], bvh.nodes()[0]);
    }
  }
  try {
    (void)reference::refit(bvh.nodes(), bvh.order(), Triangles(99));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::kUsage);
    EXPECT_STREQ(e.what(), "99 triangles for a BVH of 100");
  }
}

}  // namespace
}  // namespace cde::testing
