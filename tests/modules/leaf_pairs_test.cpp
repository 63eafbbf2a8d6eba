// SPDX-License-Identifier: Apache-2.0
// Leaves through the pipes of ray-triangle: two triangles per ray, one leaf per cycle. The module
// asserts the pipe latency, and operators of several cycles cover that assertion.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <deque>

#include "LeafPairsBadouel.h"
#include "LeafPairsPluecker.h"
#include "cde/reference/reference.hpp"
#include "clocked.hpp"
#include "hard_rays.hpp"

namespace cde::testing {
namespace {

std::uint32_t word(float x) {
  return std::bit_cast<std::uint32_t>(x);
}

/// The leaves in the order of their requests.
struct Leaf {
  std::uint32_t at;
  bool two;
  std::array<std::uint32_t, 2> index;
  std::array<Record, 2> should;
};

template <class Module>
void check(Module& m, const Leaf& leaf) {
  ASSERT_EQ(m.at_o, leaf.at);
  ASSERT_EQ(m.present_o, leaf.two ? 3u : 1u);
  for (unsigned l = 0; l < 1u + leaf.two; ++l) {
    const Record& should = leaf.should.at(l);
    ASSERT_EQ(static_cast<std::uint32_t>(m.index_o >> 32 * l), leaf.index.at(l));
    if (should.bad) continue;  // ray_queue.sv drops these rays earlier
    ASSERT_EQ(m.f_o >> l & 1, should.f) << "leaf " << leaf.at << ", lane " << l;
    if (!should.f) continue;
    ASSERT_EQ(static_cast<std::uint32_t>(m.t_o >> 32 * l), word(should.t));
    for (unsigned k = 0; k < 3; ++k) ASSERT_EQ(m.point_o[2 * k + l], word(should.cp[k]));
  }
}

template <class Module>
void expect_reference(Algorithm algorithm, std::size_t count) {
  for (const hard::Case& c : hard::kScenes) {
    SCOPED_TRACE(c.name);
    const hard::TriangleScene scene = c.make();
    hard::Rays draw(scene, 3);
    Dice dice;
    Clocked<Module> module;
    module->valid_i = 0;
    module->traversal_i = 0;
    module->rst_i = 1;
    for (unsigned clock = 0; clock < 100; ++clock) module.clock();
    module->rst_i = 0;
    std::deque<Leaf> asked;
    std::size_t given = 0, taken = 0, hits = 0;
    for (unsigned patience = 0; taken < count && patience < 200; ++patience) {
      module->valid_i = given < count && !dice.once_in(4);
      if (module->valid_i != 0) {
        const Ray ray = draw(static_cast<unsigned>(given % hard::Rays::kKinds));
        Leaf leaf{static_cast<std::uint32_t>(given), dice.once_in(2), {}, {}};
        const auto a = to_words(ray);
        for (unsigned w = 0; w < 8; ++w) module->primary_i[w] = word(a[w]);
        module->index_i = 0;
        for (unsigned l = 0; l < 2; ++l) {
          const auto i = static_cast<std::uint32_t>(dice.below(1u << 20) % scene.size());
          const auto b = to_words(scene[i]);
          for (unsigned w = 0; w < 9; ++w) module->secondaries_i[9 * l + w] = word(b[w]);
          module->index_i |= std::uint64_t{i} << 32 * l;
          leaf.index.at(l) = i;
          leaf.should.at(l) = reference::record_of(ray, scene[i], 0, i, true, algorithm);
          hits += leaf.should.at(l).f;
        }
        module->at_i = leaf.at;
        module->two_i = leaf.two;
        asked.push_back(leaf);
        ++given;
      }
      module.clock();
      if (module->valid_o == 0) continue;
      ASSERT_FALSE(asked.empty());
      check(*module.operator->(), asked.front());
      asked.pop_front();
      ++taken;
      patience = 0;
    }
    EXPECT_EQ(taken, count) << "some leaves have no result";
    EXPECT_GT(hits, 0u);
  }
}

TEST(LeafPairs, Badouel_EqualsTheReference) {
  expect_reference<LeafPairsBadouel>(Algorithm::kBadouel, 3000);
}
TEST(LeafPairs, Pluecker_EqualsTheReference) {
  expect_reference<LeafPairsPluecker>(Algorithm::kPluecker, 3000);
}

}  // namespace
}  // namespace cde::testing
