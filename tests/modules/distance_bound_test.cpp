// SPDX-License-Identifier: Apache-2.0
// The box rule of triangles, boxes and solids in hardware, part by part. Pipe results are so rarely
// below the bound that tests of pairs alone do not reach it.
#include <gtest/gtest.h>

#include <bit>
#include <random>

#include "DistanceAtLeastGates.h"
#include "DistanceAtLeastHost.h"
#include "DistanceBoundAabb.h"
#include "DistanceBoundObb.h"
#include "DistanceBoundObbs.h"
#include "DistanceBoundSphere.h"
#include "DistanceBoundSphereGates.h"
#include "DistanceBoundTriangle.h"
#include "SolidFrontAabb.h"
#include "SolidFrontObb.h"
#include "SolidFrontObbGates.h"
#include "SolidFrontSphere.h"
#include "SolidFrontTriangle.h"
#include "cde/reference/pipes/solid_node.hpp"
#include "clocked.hpp"
#include "hard_solids.hpp"

namespace cde::testing {
namespace {

using namespace hard;

constexpr unsigned kCycles = 60;  // longer than the latency of every module
std::uint32_t word(float x) {
  return std::bit_cast<std::uint32_t>(x);
}

/// A solid against a triangle, or against another `First`.
template <class Module, class Solid, class First = Triangle>
void expect_bounds(std::size_t count) {
  Clocked<Module> module;
  for (const Case& c : kScenes) {
    SCOPED_TRACE(c.name);
    const TriangleScene scene = c.make();
    Solids draws(scene, 9);
    const auto all = [&] {
      if constexpr (std::is_same_v<First, Triangle>)
        return scene;
      else
        return obbs_of(scene);
    }();
    for (std::size_t i = 0; i < count; ++i) {
      const Solid solid = draws.draw<Solid>(i);
      const First& t = all[i * 31 % all.size()];
      const auto a = to_words(t);
      const auto b = to_words(solid);
      for (unsigned w = 0; w < a.size(); ++w) module->a_i[w] = word(a[w]);
      for (unsigned w = 0; w < b.size(); ++w) module->b_i[w] = word(b[w]);
      for (unsigned clock = 0; clock < kCycles; ++clock) module.clock();
      ASSERT_EQ(module->bound_o, word(reference::distance_bound<float>(t, solid))) << text(solid);
    }
  }
}

TEST(DistanceBound, Bounds_EqualTheReference) {
  expect_bounds<DistanceBoundSphere, Sphere>(200);
  expect_bounds<DistanceBoundObb, Obb>(200);
  expect_bounds<DistanceBoundSphereGates, Sphere>(50);
  expect_bounds<DistanceBoundObbs, Obb, Obb>(50);
  expect_bounds<DistanceBoundAabb, Aabb>(50);
  expect_bounds<DistanceBoundTriangle, Triangle>(50);
}

template <class Module>
void expect_at_least() {
  Clocked<Module> module;
  std::mt19937 bits(7);
  constexpr std::uint32_t kSpecial[] = {0, 0x8000'0000, 1, 0x3f80'0000, 0xbf80'0000, 0x7f80'0000};
  const auto any = [&] {
    return std::bit_cast<float>(
        bits() % 3 == 0 ? kSpecial[bits() % 6]
                        : static_cast<std::uint32_t>(bits() & 0x8fff'ffffu) | 0x3000'0000u);
  };
  unsigned held = 0;
  for (unsigned i = 0; i < 5000; ++i) {
    reference::Outcome<float> pipe;
    pipe.t = std::abs(any());
    pipe.f = pipe.t == 0 || bits() % 2 == 0;
    const float bound = any();
    for (int k = 0; k < 3; ++k) pipe.cp[k] = any(), pipe.n[k] = any();
    module->bound_i = word(bound);
    module->f_i = pipe.f ? ~0u : 0;
    module->t_i = word(pipe.t);
    for (int k = 0; k < 3; ++k)
      module->cp_i[k] = word(pipe.cp[k]), module->n_i[k] = word(pipe.n[k]);
    for (unsigned clock = 0; clock < kCycles; ++clock) module.clock();
    const auto should = reference::at_least<float>(pipe, bound);
    ASSERT_EQ(module->f_o, should.f ? ~0u : 0u) << pipe.f << ' ' << pipe.t << ' ' << bound;
    ASSERT_EQ(module->t_o, word(should.t)) << pipe.f << ' ' << pipe.t << ' ' << bound;
    for (int k = 0; k < 3; ++k) {
      ASSERT_EQ(module->cp_o[k], word(pipe.cp[k]));
      ASSERT_EQ(module->n_o[k], word(pipe.n[k]));
    }
    held += word(should.t) != word(pipe.t) || should.f != pipe.f;
  }
  EXPECT_GT(held, 500u);
  EXPECT_LT(held, 4500u);
}

TEST(DistanceBound, ResultOfAPipe_IsRaisedToTheBound) {
  expect_at_least<DistanceAtLeastHost>();
  expect_at_least<DistanceAtLeastGates>();
}

template <class Module, class Solid>
void expect_fronts() {
  Clocked<Module> module;
  for (const Case& c : kScenes) {
    SCOPED_TRACE(c.name);
    const TriangleScene scene = c.make();
    Eigen::AlignedBox3f box;
    for (const Triangle& t : scene)
      for (const Vector3f& v : {t.v0, t.v1, t.v2}) box.extend(v);
    const auto root = reference::root_bounds<float>(box.min(), box.max());
    Solids draws(scene, 10);
    for (std::size_t i = 0; i < 100; ++i) {
      const Solid solid = draws.draw<Solid>(i);
      const auto words = to_words(solid);
      for (unsigned w = 0; w < words.size(); ++w) module->a_i[w] = word(words[w]);
      for (int k = 0; k < 3; ++k) {
        module->root_i[k] = word(root.lower[k]);
        module->root_i[3 + k] = word(root.upper[k]);
      }
      module->root_i[6] = word(root.margin);
      for (unsigned clock = 0; clock < kCycles; ++clock) module.clock();
      const auto front = reference::solid_front<float>(solid, root);
      for (int k = 0; k < 3; ++k) {
        ASSERT_EQ(module->r_o[k], word(front.upper[k])) << text(solid);
        ASSERT_EQ(module->r_o[3 + k], word(front.lower[k])) << text(solid);
      }
    }
  }
}

TEST(SolidFront, Fronts_EqualTheReference) {
  expect_fronts<SolidFrontSphere, Sphere>();
  expect_fronts<SolidFrontObb, Obb>();
  expect_fronts<SolidFrontObbGates, Obb>();
  expect_fronts<SolidFrontTriangle, Triangle>();
  expect_fronts<SolidFrontAabb, Aabb>();
}

}  // namespace
}  // namespace cde::testing
