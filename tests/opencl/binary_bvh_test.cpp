// SPDX-License-Identifier: Apache-2.0
// The binary BVH of the OpenCL baseline: every triangle is in one leaf, inside all boxes above it.
#include <gtest/gtest.h>

#include <vector>

#include "baselines/binary_bvh.hpp"
#include "expect_error.hpp"
#include "hard_rays.hpp"

namespace cde::testing {
namespace {

using baseline::BinaryBvh;
using baseline::BinaryNode;

Eigen::AlignedBox3f box_of(const BinaryNode& n, int side) {
  const auto corner = [&](int end) {
    return Eigen::Vector3f(n.x[2 * side + end], n.y[2 * side + end], n.z[2 * side + end]);
  };
  return {corner(0), corner(1)};
}

/// Walks the BVH and counts how often each triangle is in a leaf.
class Walk {
 public:
  Walk(const BinaryBvh& bvh, const std::vector<Triangle>& triangles)
      : seen(triangles.size()), bvh_(bvh), triangles_(triangles) {
    visit(0, {bvh.box}, 1);
  }
  std::vector<unsigned> seen;
  unsigned levels = 0;
  std::size_t nodes = 0;

 private:
  void visit(std::size_t node, std::vector<Eigen::AlignedBox3f> above, unsigned level) {
    ASSERT_LT(node, bvh_.nodes.size());
    ASSERT_LE(level, BinaryBvh::kMostLevels);
    ++nodes;
    levels = std::max(levels, level);
    for (int side = 0; side < 2; ++side) {
      const std::uint32_t child = bvh_.nodes[node].child[side], at = child / 8, count = child % 8;
      above.push_back(box_of(bvh_.nodes[node], side));
      if (count == 0) {
        visit(at, above, level + 1);
      } else {
        EXPECT_LE(count, BinaryBvh::kLeaf);
        for (std::uint32_t i = at; i < at + count; ++i) leaf(bvh_.order.at(i), above);
      }
      above.pop_back();
    }
  }
  void leaf(std::uint32_t triangle, const std::vector<Eigen::AlignedBox3f>& above) {
    ++seen.at(triangle);
    const Triangle& t = triangles_[triangle];
    for (const Eigen::AlignedBox3f& box : above)
      for (const Eigen::Vector3f& v : {t.v0, t.v1, t.v2}) EXPECT_TRUE(box.contains(v));
  }
  const BinaryBvh& bvh_;
  const std::vector<Triangle>& triangles_;
};

class BinaryBvhScenes : public ::testing::TestWithParam<hard::Case> {};
INSTANTIATE_TEST_SUITE_P(Scenes, BinaryBvhScenes, ::testing::ValuesIn(hard::kScenes),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_P(BinaryBvhScenes, Triangles_AreInOneLeafInsideTheirBoxes) {
  const std::vector<Triangle> triangles = GetParam().make();
  const BinaryBvh bvh = BinaryBvh::build(triangles);
  const Walk walk(bvh, triangles);
  // The children of the root over one triangle are the same leaf.
  const unsigned times = triangles.size() == 1 ? 2 : 1;
  for (const unsigned seen : walk.seen) EXPECT_EQ(seen, times);
  EXPECT_EQ(walk.levels, bvh.levels);
  EXPECT_EQ(walk.nodes, bvh.nodes.size());
}

TEST(BinaryBvh, EqualTriangles_AreDividedAtMedians) {
  const std::vector<Triangle> triangles(1000, Triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const BinaryBvh bvh = BinaryBvh::build(triangles);
  const Walk walk(bvh, triangles);
  EXPECT_EQ(walk.seen, std::vector<unsigned>(1000, 1));
  EXPECT_LE(bvh.levels, 9u);
}

/// Each split by area takes one triangle off, so that only the limit of levels keeps the depth.
TEST(BinaryBvh, GrowingTriangles_StayWithinTheStack) {
  std::vector<Triangle> triangles;
  for (int i = -120; i <= 40; ++i) {
    const float size = std::ldexp(1.0f, i);
    triangles.push_back({{size, 0, 0}, {size, size, 0}, {size, 0, size}});
  }
  const BinaryBvh bvh = BinaryBvh::build(triangles);
  const Walk walk(bvh, triangles);
  EXPECT_EQ(walk.seen, std::vector<unsigned>(triangles.size(), 1));
  EXPECT_GT(bvh.levels, 16u);
}

TEST(BinaryBvh, NoTriangles_AreRefused) {
  expect_error(ErrorCode::kBadInput, "no triangles", [] { (void)BinaryBvh::build({}); });
}

}  // namespace
}  // namespace cde::testing
