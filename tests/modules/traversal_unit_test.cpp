// SPDX-License-Identifier: Apache-2.0
// The order of a node's children: gates and the function of the host's arithmetic give the same
// group. Words are arbitrary, with NaNs and infinities.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <random>
#include <vector>

#include "TraversalUnitGates.h"
#include "TraversalUnitHost.h"
#include "clocked.hpp"

namespace cde::testing {
namespace {

struct Visit {
  std::array<std::uint32_t, 9> ray;
  std::array<std::uint32_t, 18> node;
  std::uint32_t floor, limit;
  bool farthest, solid;
};

/// The group: places, kinds and number of hit children, with their numbers and keys
/// (bvh_pkg::group_t).
template <class Module>
std::vector<std::uint32_t> group_of(Clocked<Module>& module, const Visit& visit) {
  std::copy(visit.ray.begin(), visit.ray.end(), &module->ray_i[0]);
  std::copy(visit.node.begin(), visit.node.end(), &module->node_i[0]);
  module->floor_i = visit.floor;
  module->limit_i = visit.limit;
  module->farthest_i = visit.farthest;
  module->solid_i = visit.solid;
  for (unsigned clock = 0; clock < 12; ++clock) module.clock();
  const auto bits = [&](unsigned from, unsigned count) {
    const unsigned word = from / 32;
    const std::uint64_t two =
        module->group_o[word] | (word < 7 ? std::uint64_t{module->group_o[word + 1]} << 32 : 0);
    return static_cast<std::uint32_t>(two >> from % 32 & ((std::uint64_t{1} << count) - 1));
  };
  std::vector<std::uint32_t> group = {bits(200, 28), bits(172, 28), bits(156, 16), bits(152, 4)};
  for (unsigned i = 0; i < group[3]; ++i) {
    group.push_back(bits(128 + 3 * i, 3));
    group.push_back(bits(16 * i, 16));
  }
  return group;
}

TEST(TraversalUnit, Gates_EqualHostArithmetic) {
  Clocked<TraversalUnitGates> gates;
  Clocked<TraversalUnitHost> host;
  std::mt19937 engine(20240611);
  Dice dice;
  const auto number = [&](float least, float most) {
    const float share = static_cast<float>(dice.below(1u << 24)) * 0x1p-24f;
    return std::bit_cast<std::uint32_t>(least + share * (most - least));
  };
  constexpr std::array<std::uint32_t, 8> kSpecial = {
      0, 0x8000'0000, 0x7f80'0000, 0xff80'0000, 0x7fc0'0000, 1, 0x7f7f'ffff, 0xff7f'ffff};
  std::array<unsigned, 9> met{};
  for (unsigned i = 0; i < 20'000; ++i) {
    Visit visit{};
    // Children in a cube of 256, rays from around it. Few distinct planes, so that ties occur.
    for (unsigned k = 0; k < 3; ++k) {
      const std::uint32_t from = number(-300, 600);
      visit.ray[k] = visit.ray[3 + k] = from;
      visit.ray[6 + k] = number(-2, 2);
      visit.node[k] = dice.once_in(2) ? 0 : number(-20, 20);
    }
    for (unsigned w = 3; w < 18; ++w) visit.node[w] = static_cast<std::uint32_t>(engine());
    visit.node[3] &= 0xff00'0000;
    for (unsigned w = 6; w < 12; ++w)
      if (dice.once_in(2)) visit.node[w] &= 0x1010'1010, visit.node[w + 6] |= 0xf0f0'f0f0;
    if (i % 8 == 0) {  // most of these are hit
      for (unsigned w = 3; w < 6; ++w) visit.node[w] |= 0xaa00'0000;
      for (unsigned w = 6; w < 12; ++w)
        visit.node[w] &= 0x0303'0303, visit.node[w + 6] |= 0xfcfc'fcfc;
    }
    visit.floor = number(-200, 100);
    visit.limit = number(0, 1000);
    visit.farthest = dice.once_in(2);
    visit.solid = dice.once_in(3);
    if (visit.solid && dice.once_in(2))  // keys of solids are signed distances
      for (unsigned k = 0; k < 3; ++k) visit.ray[6 + k] = std::bit_cast<std::uint32_t>(1.0f);
    const auto anything = [&](std::uint32_t& word) {
      if (dice.once_in(8)) word = dice.once_in(2) ? kSpecial[dice.below(8)] : engine();
    };
    if (i % 4 == 3) {
      for (auto& word : visit.ray) anything(word);
      for (unsigned w = 0; w < 4; ++w) anything(visit.node[w]);
      anything(visit.floor);
      anything(visit.limit);
    }
    const auto group = group_of(gates, visit);
    ASSERT_EQ(group_of(host, visit), group) << "visit " << i;
    ++met.at(group[3]);
  }
  for (unsigned count = 0; count <= 8; ++count) EXPECT_GT(met[count], 10u) << count << " met";
}

}  // namespace
}  // namespace cde::testing
