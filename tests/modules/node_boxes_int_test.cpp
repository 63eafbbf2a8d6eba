// SPDX-License-Identifier: Apache-2.0
// The node in whole numbers in gates against the reference, bit by bit: one node per cycle or per
// two, with random idle cycles.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <optional>

#include "KeyLimitGates.h"
#include "KeyLimitHost.h"
#include "NodeBoxesIntFourGates.h"
#include "NodeBoxesIntFourHost.h"
#include "NodeBoxesIntGates.h"
#include "NodeBoxesIntHost.h"
#include "NodeBoxesIntNarrow.h"
#include "NodeBoxesIntTwoGates.h"
#include "NodeBoxesIntTwoHost.h"
#include "cde/reference/integer_node.hpp"
#include "clocked.hpp"
#include "integer_node_cases.hpp"

namespace cde::testing {
namespace {

using reference::IntegerFormat;
using reference::IntegerVisit;

bool full() {
  return std::getenv("CDE_FULL") != nullptr;
}

std::uint32_t word(float x) {
  return std::bit_cast<std::uint32_t>(x);
}

/// Keys of 12 bits, as words of the module's output.
std::array<std::uint32_t, 3> packed(const IntegerVisit& visit) {
  std::array<std::uint32_t, 3> words{};
  for (unsigned bit = 0; bit < 96; ++bit)
    words[bit / 32] |= (visit.keys[bit / 12] >> bit % 12 & 1u) << bit % 32;
  return words;
}

/// Visits of all scenes, `count` in all, one per `cycles` cycles.
template <class Module>
void expect_reference(unsigned latency, std::size_t count, const IntegerFormat& format = {},
                      unsigned cycles = 1) {
  Clocked<Module> module;
  module.clock();  // places of delay lines start anywhere
  Dice dice;
  struct Expected {
    std::size_t number;
    IntegerVisit visit;
  };
  std::deque<std::optional<Expected>> expected;
  std::size_t entered = 0, checked = 0;
  unsigned busy = 0;  // further cycles of the node at the inputs
  decltype(bvh::Node::words) words{};
  const auto show_half = [&](unsigned half) {  // anything in the other one
    for (unsigned w = 0; w < words.size(); ++w)
      module->node_i[w] = w / (words.size() / 2) == half ? words[w] : dice.below(~0u);
  };
  for (const hard::Case& scene : hard::kScenes) {
    const hard::TriangleScene triangles = scene.make();
    NodeVisits visits(triangles, 11);
    for (std::size_t i = 0; i < count / std::size(hard::kScenes);) {
      if (busy != 0) {  // the same inputs
        --busy;
        module->valid_i = 0;
        if (cycles == 4 && busy == 1) show_half(1);
        expected.emplace_back();
      } else if (dice.once_in(16)) {  // an idle cycle: anything at the inputs
        for (unsigned w = 0; w < 9; ++w) module->ray_i[w] = dice.below(~0u);
        for (unsigned w = 0; w < 18; ++w) module->node_i[w] = dice.below(~0u);
        module->valid_i = 0;
        expected.emplace_back();
      } else {
        const NodeVisit visit = visits();
        const reference::IntegerRay ray = visit.ray();
        for (unsigned k = 0; k < 3; ++k) {
          const int axis = static_cast<int>(k);
          module->ray_i[k] = word(ray.o[axis]);
          module->ray_i[3 + k] = word(ray.margin[axis]);
          module->ray_i[6 + k] = word(ray.inverse[axis]);
        }
        words = visit.node.words;
        std::copy(words.begin(), words.end(), &module->node_i[0]);
        if (cycles == 4) show_half(0);
        module->floor_i = word(visit.floor);
        module->limit_i = word(visit.limit);
        module->farthest_i = visit.farthest;
        module->valid_i = 1;
        busy = cycles - 1;
        expected.push_back(
            Expected{i++, reference::integer_visit(ray, visit.node, visit.floor, visit.limit,
                                                   visit.farthest, format)});
      }
      module.clock();
      if (expected.size() < latency) continue;
      if (const auto& should = expected.front()) {
        const IntegerVisit& v = should->visit;
        const auto where = fmt::format("{}, visit {}", scene.name, should->number);
        ASSERT_EQ(module->reference_o, word(v.scale.reference)) << where;
        ASSERT_EQ(module->scale_o, v.scale.exponent + 127) << where;
        ASSERT_EQ(module->entered_o, v.entered) << where;
        const auto keys = packed(v);
        for (unsigned w = 0; w < 3; ++w) ASSERT_EQ(module->key_o[w], keys[w]) << where;
        ++checked;
        entered += static_cast<std::size_t>(std::popcount(v.entered));
      }
      expected.pop_front();
    }
  }
  EXPECT_GT(checked, count - latency - 8);
  EXPECT_GT(entered, count);
  fmt::print("{} nodes, {} children entered\n", checked, entered);
}

/// CDE_FULL=1: four million nodes in all.
TEST(NodeBoxesInt, Gates_EqualTheReference) {
  expect_reference<NodeBoxesIntGates>(3 + 2 + 10, full() ? 400'000 : 40'000);
}
TEST(NodeBoxesInt, HostArithmetic_EqualsTheReference) {
  expect_reference<NodeBoxesIntHost>(3 + 10, full() ? 3'200'000 : 200'000);
}
TEST(NodeBoxesInt, NarrowNumbers_EqualTheReference) {
  expect_reference<NodeBoxesIntNarrow>(3 + 10, full() ? 400'000 : 40'000, {12, 4});
}
TEST(NodeBoxesInt, TwoCyclesPerNode_EqualTheReference) {
  expect_reference<NodeBoxesIntTwoGates>(3 + 2 + 13, full() ? 400'000 : 40'000, {}, 2);
  expect_reference<NodeBoxesIntTwoHost>(2 + 13, full() ? 400'000 : 40'000, {}, 2);
}
TEST(NodeBoxesInt, HalvesInTurn_EqualTheReference) {
  expect_reference<NodeBoxesIntFourGates>(3 + 2 + 17, full() ? 400'000 : 40'000, {}, 4);
  expect_reference<NodeBoxesIntFourHost>(5 + 15, full() ? 400'000 : 40'000, {}, 4);
}

/// Limits for T of any size, and for T whose keys are a few units from a whole number.
template <class Module>
void expect_key_limits(std::size_t count) {
  constexpr unsigned kLatency = 7;
  Clocked<Module> module;
  module->valid_i = 1;
  hard::Draw draw(5);
  for (const bool farthest : {false, true}) {
    std::deque<unsigned> expected;
    std::array<std::size_t, 3> kinds{};  // least, between, most
    for (std::size_t i = 0; i < count; ++i) {
      const int exponent = static_cast<int>(draw.below(120)) - 70;
      const float reference = draw(-1, 1) * draw.power(exponent - 10, exponent + 24);
      const double unit = std::ldexp(1.0, exponent + 4);
      const double near = (static_cast<double>(draw.below(5'000)) - 2'500) * unit;
      float t = static_cast<float>(reference + near);
      if (draw.below(3) == 0) t = std::nextafter(t, draw.below(2) == 0 ? 0x1p100f : -0x1p100f);
      if (draw.below(8) == 0) t = draw(-1, 1) * draw.power(-60, 40);
      if (draw.below(16) == 0) t = draw.below(2) == 0 ? HUGE_VALF : -HUGE_VALF;
      module->time_i = word(t);
      module->reference_i = word(reference);
      module->scale_i = static_cast<CData>(exponent + 127);
      module->farthest_i = farthest;
      expected.push_back(reference::key_limit({reference, exponent}, t, farthest));
      module.clock();
      if (expected.size() < kLatency) continue;
      const unsigned should = expected.front();
      ASSERT_EQ(module->limit_o, should) << "case " << i << " - " << kLatency - 1;
      ++kinds[should == 0 ? 0 : should == 4095 ? 2 : 1];
      expected.pop_front();
    }
    for (const std::size_t kind : kinds) EXPECT_GT(kind, count / 20);
  }
}

TEST(KeyLimit, Limits_EqualTheReference) {
  expect_key_limits<KeyLimitGates>(200'000);
  expect_key_limits<KeyLimitHost>(200'000);
}

}  // namespace
}  // namespace cde::testing
