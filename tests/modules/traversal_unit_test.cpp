// SPDX-License-Identifier: Apache-2.0
// The order of a node's children: gates and the function of the host's arithmetic give the same
// group. Rays and nodes are within the contract. Words of solids are arbitrary, with NaNs and
// infinities.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <random>
#include <vector>

#include "TraversalUnitFourGates.h"
#include "TraversalUnitFourHost.h"
#include "TraversalUnitGates.h"
#include "TraversalUnitHost.h"
#include "TraversalUnitRaysGates.h"
#include "TraversalUnitRaysHost.h"
#include "TraversalUnitSolidsGates.h"
#include "TraversalUnitSolidsHost.h"
#include "TraversalUnitTwoGates.h"
#include "TraversalUnitTwoHost.h"
#include "cde/reference/integer_node.hpp"
#include "clocked.hpp"
#include "integer_node_cases.hpp"

namespace cde::testing {
namespace {

struct Visit {
  std::array<std::uint32_t, 9> front;
  std::array<std::uint32_t, 18> node;
  std::uint32_t floor, limit;
  bool farthest, solid;
};

std::uint32_t word(float x) {
  return std::bit_cast<std::uint32_t>(x);
}

struct Group {
  std::uint32_t reference = 0, scale = 0;       // for rays
  std::uint32_t node = 0, slot = 0, kinds = 0;  // links
  std::vector<std::uint32_t> order{}, keys{};   // of the children hit
  bool operator==(const Group&) const = default;
};

/// The words of a group (GROUP_BITS of rtl/bvh/bvh.svh), with keys of `key` bits.
template <class Words>
Group group_from(const Words& words, unsigned key, bool solid) {
  const auto bits = [&](unsigned from, unsigned count) {
    std::uint32_t value = 0;
    for (unsigned bit = 0; bit < count; ++bit)
      value |= (words[(from + bit) / 32] >> ((from + bit) % 32) & 1u) << bit;
    return value;
  };
  const unsigned order = 8 * key, count = order + 24, links = count + 4;
  Group group{.node = bits(links + 44, 28), .slot = bits(links + 16, 28), .kinds = bits(links, 16)};
  if (!solid) group.reference = bits(links + 80, 32), group.scale = bits(links + 72, 8);
  for (unsigned i = 0; i < bits(count, 4); ++i) {
    group.order.push_back(bits(order + 3 * i, 3));
    group.keys.push_back(bits(key * group.order.back(), key));
  }
  return group;
}

template <class Module>
void drive(Clocked<Module>& module, const Visit& visit) {
  std::copy(visit.front.begin(), visit.front.end(), &module->front_i[0]);
  std::copy(visit.node.begin(), visit.node.end(), &module->node_i[0]);
  module->valid_i = 1;
  module->floor_i = visit.floor;
  module->limit_i = visit.limit;
  module->farthest_i = visit.farthest;
  module->solid_i = visit.solid;
}

/// Cycles from a visit to its group, and cycles per node.
struct Latencies {
  unsigned ray, solid, cycles = 1;
};

/// One visit at a time: the group is there after exactly the latency.
template <class Module>
Group group_of(Clocked<Module>& module, const Visit& visit, unsigned key,
               const Latencies& latencies) {
  // With four cycles, gates see a half of the node at a time.
  constexpr bool kHalves = std::is_same_v<Module, TraversalUnitFourGates>;
  drive(module, visit);
  for (unsigned cycle = 0; cycle < latencies.cycles; ++cycle) {
    for (unsigned w = 0; kHalves && w < 18; ++w)
      module->node_i[w] = w / 9 == cycle / 2 ? visit.node[w] : ~visit.node[w];
    module.clock();
    module->valid_i = 0;
  }
  Visit other = visit;
  other.node[9] = ~other.node[9];  // another group in the next cycles
  drive(module, other);
  const unsigned latency = visit.solid ? latencies.solid : latencies.ray;
  for (unsigned clock = latencies.cycles; clock < latency; ++clock) {
    module.clock();
    module->valid_i = latencies.cycles == 1;
  }
  return group_from(module->group_o, key, visit.solid);
}

/// The group of the reference.
Group expected(const NodeVisit& visit) {
  const auto answer =
      reference::integer_visit(visit.ray(), visit.node, visit.floor, visit.limit, visit.farthest);
  Group group{.reference = word(answer.scale.reference),
              .scale = static_cast<std::uint32_t>(answer.scale.exponent + 127) & 255,
              .node = visit.node.first_node(),
              .slot = visit.node.first_slot(),
              .kinds = 0};
  for (unsigned c = 0; c < bvh::Node::kChildren; ++c)
    group.kinds |= static_cast<std::uint32_t>(visit.node.child(c)) << (2 * c);
  for (unsigned c = 0; c < bvh::Node::kChildren; ++c)
    if ((answer.entered >> c & 1) != 0) group.order.push_back(c);
  std::stable_sort(group.order.begin(), group.order.end(),
                   [&](unsigned a, unsigned b) { return answer.keys[a] < answer.keys[b]; });
  for (const unsigned c : group.order) group.keys.push_back(answer.keys[c]);
  return group;
}

template <class Gates, class Host>
void expect_rays(unsigned key, const Latencies& latencies, std::size_t gates_each,
                 std::size_t host_each) {
  Clocked<Gates> gates;
  Clocked<Host> host;
  gates.clock(), host.clock();  // places of delay lines start anywhere
  std::array<unsigned, 9> met{};
  for (const hard::Case& scene : hard::kScenes) {
    const hard::TriangleScene triangles = scene.make();
    NodeVisits visits(triangles, 21);
    for (std::size_t i = 0; i < host_each; ++i) {
      const NodeVisit visit = visits();
      const reference::IntegerRay ray = visit.ray();
      Visit words{.front = {},
                  .node = visit.node.words,
                  .floor = word(visit.floor),
                  .limit = word(visit.limit),
                  .farthest = visit.farthest,
                  .solid = false};
      for (unsigned k = 0; k < 3; ++k) {
        const int axis = static_cast<int>(k);
        words.front[k] = word(ray.o[axis]);
        words.front[3 + k] = word(ray.margin[axis]);
        words.front[6 + k] = word(ray.inverse[axis]);
      }
      const Group should = expected(visit);
      ASSERT_EQ(group_of(host, words, key, latencies), should) << scene.name << ", visit " << i;
      if (i < gates_each) {
        ASSERT_EQ(group_of(gates, words, key, latencies), should) << scene.name << ", visit " << i;
      }
      ++met.at(should.order.size());
    }
  }
  for (unsigned count = 0; count <= 8; ++count) EXPECT_GT(met[count], 10u) << count << " met";
}

TEST(TraversalUnit, Rays_EqualTheReference) {
  expect_rays<TraversalUnitGates, TraversalUnitHost>(16, {16, 11}, 200, 4'000);
  expect_rays<TraversalUnitRaysGates, TraversalUnitRaysHost>(12, {17, 17}, 200, 4'000);
  expect_rays<TraversalUnitTwoGates, TraversalUnitTwoHost>(12, {29, 29, 2}, 200, 4'000);
  expect_rays<TraversalUnitFourGates, TraversalUnitFourHost>(12, {33, 33, 4}, 200, 4'000);
}

template <class Gates, class Host>
void expect_solids(const Latencies& latencies) {
  Clocked<Gates> gates;
  Clocked<Host> host;
  gates.clock(), host.clock();  // places of delay lines start anywhere
  std::mt19937 engine(20240611);
  Dice dice;
  const auto number = [&](float least, float most) {
    const float share = static_cast<float>(dice.below(1u << 24)) * 0x1p-24f;
    return word(least + share * (most - least));
  };
  constexpr std::array<std::uint32_t, 8> kSpecial = {
      0, 0x8000'0000, 0x7f80'0000, 0xff80'0000, 0x7fc0'0000, 1, 0x7f7f'ffff, 0xff7f'ffff};
  std::array<unsigned, 9> met{};
  for (unsigned i = 0; i < 6'000; ++i) {
    Visit visit{};
    visit.solid = true;
    // Children in a cube of 256, solids in and around it. Few distinct planes, so that ties occur.
    for (unsigned k = 0; k < 3; ++k) {
      visit.front[k] = number(-300, 600);
      visit.front[3 + k] = dice.once_in(2) ? visit.front[k] : number(-300, 600);
      visit.node[k] = dice.once_in(2) ? 0 : number(-20, 20);
    }
    for (unsigned w = 3; w < 18; ++w) visit.node[w] = static_cast<std::uint32_t>(engine());
    visit.node[9] &= 0xff00'0000;
    for (const unsigned w : {3, 4, 5, 12, 13, 14})
      if (dice.once_in(2)) visit.node[w] &= 0x1010'1010, visit.node[w + 3] |= 0xf0f0'f0f0;
    if (i % 8 == 0) {  // most of these are hit
      for (const unsigned w : {9, 10, 11}) visit.node[w] |= 0xaa00'0000;
      for (const unsigned w : {3, 4, 5, 12, 13, 14})
        visit.node[w] &= 0x0303'0303, visit.node[w + 3] |= 0xfcfc'fcfc;
    }
    visit.limit = number(0, dice.once_in(2) ? 1000 : 100'000);
    const auto anything = [&](std::uint32_t& w) {
      if (dice.once_in(8)) w = dice.once_in(2) ? kSpecial[dice.below(8)] : engine();
    };
    if (i % 4 == 3) {
      for (unsigned w = 0; w < 6; ++w) anything(visit.front[w]);
      for (const unsigned w : {0, 1, 2, 9}) anything(visit.node[w]);
      anything(visit.limit);
    }
    const Group group = group_of(gates, visit, 16, latencies);
    ASSERT_EQ(group_of(host, visit, 16, latencies), group) << "visit " << i;
    ++met.at(group.order.size());
  }
  for (unsigned count = 0; count <= 8; ++count) EXPECT_GT(met[count], 10u) << count << " met";
}

TEST(TraversalUnit, Solids_EqualHostArithmetic) {
  expect_solids<TraversalUnitGates, TraversalUnitHost>({16, 11});
  // Two sums, four comparisons of four cycles, one cycle for hits, three for the order.
  expect_solids<TraversalUnitSolidsGates, TraversalUnitSolidsHost>({22, 22});
}

}  // namespace
}  // namespace cde::testing
