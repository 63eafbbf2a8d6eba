// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <ostream>
#include <span>
#include <tuple>
#include <vector>

#include "board_configs.hpp"
#include "bvh_pair.hpp"
#include "cde/card/board.hpp"
#include "cde/reference/traversal.hpp"
#include "hard_rays.hpp"

/// Cards with a BVH and the expected results of traversals, for tests.
namespace cde::testing::through {

using hard::TriangleScene;

// Configurations in CMakeLists.txt.
inline BoardConfig fast_config() {
  return {.lanes = 4, .box = true, .traversal_units = 2, .nodes = 1024};
}
inline BoardConfig watertight_config() {  // the card of `cde cast`
  return {.lanes = 4, .algorithm = Algorithm::kWatertight, .box = true, .traversal_units = 2};
}
/// Gates, as the placed card: one lane for all triangles, few contexts, nodes in DDR.
inline BoardConfig gates_config() {
  return {.lanes = 1,
          .arithmetic = Arithmetic::kRtl,
          .box = true,
          .traversal_units = 1,
          .nodes = 1024,
          .node_cycles = 2,
          .node_cache = 32,
          .node_ways = 2,
          .pinned_nodes = 16,
          .contexts = 32,
          .shared_lane = 4,
          .ray_places = 64,
          .transform = Transformer::kSecondaries,
          .ddr_slots = 4000,
          .sram_records = 64};
}
/// The latencies of a placed lane (docs/background/costs.md), four traversal units with two cycles
/// per node, check bits in DDR, other pairs, a small ring.
inline BoardConfig slow_config() {
  return {.lanes = 4,
          .pairs = {Pair::kRayTriangle, Pair::kTriangleSphere},
          .box = true,
          .swap = true,
          .traversal_units = 4,
          .nodes = 1024,
          .node_cycles = 2,
          .transform = Transformer::kBoth,
          .latency = {.add = 9, .mul = 11, .div = 34, .sqrt = 32, .compare = 3},
          .ddr_slots = 2000,
          .sram_records = 64,
          .ecc = true};
}
/// Sixteen nodes on chip, the others and all slots in DDR behind small caches, with check bits.
inline BoardConfig cached_config() {
  return {.lanes = 4,
          .pairs = {Pair::kRayTriangle, Pair::kTriangleSphere},
          .box = true,
          .swap = true,
          .traversal_units = 2,
          .nodes = 1024,
          .node_cycles = 2,
          .node_cache = 32,
          .node_ways = 2,
          .pinned_nodes = 16,
          .transform = Transformer::kSecondaries,
          .ddr_slots = 4000,
          .sram_records = 64,
          .ecc = true};
}
/// Rays, spheres and OBBs, and moving objects.
inline BoardConfig solids_config() {
  return {.lanes = 8,
          .pairs = {Pair::kRayTriangle, Pair::kTriangleObb, Pair::kTriangleSphere},
          .box = true,
          .swap = true,
          .normals = true,
          .traversal_units = 2,
          .nodes = 1024,
          .transform = Transformer::kSecondaries,
          .sram_records = 64};
}
/// Triangles against triangles.
inline BoardConfig meshes_config() {
  return {.lanes = 8,
          .pairs = {Pair::kTriangleTriangle},
          .box = true,
          .normals = true,
          .traversal_units = 2,
          .nodes = 1024,
          .sram_records = 64};
}
/// Rays and spheres against spheres.
inline BoardConfig spheres_config() {
  return {.lanes = 4,
          .pairs = {Pair::kRaySphere, Pair::kSphereSphere},
          .normals = true,
          .traversal_units = 2,
          .nodes = 1024,
          .transform = Transformer::kSecondaries,
          .sram_records = 64};
}
/// Solids and triangles against boxes.
inline BoardConfig boxes_config() {
  return {.lanes = 8,
          .pairs = {Pair::kObbObb, Pair::kTriangleAabb, Pair::kSphereObb},
          .box = true,
          .swap = true,
          .normals = true,
          .traversal_units = 2,
          .nodes = 1024,
          .transform = Transformer::kSecondaries,
          .sram_records = 64};
}
/// Spheres against triangles and boxes: the card with solids that builds fastest.
inline BoardConfig sphere_pairs_config() {
  return {.lanes = 8,
          .pairs = {Pair::kTriangleSphere, Pair::kSphereObb},
          .box = true,
          .swap = true,
          .traversal_units = 2,
          .nodes = 1024,
          .sram_records = 64};
}
inline BoardConfig spheres_gates_config() {
  return {.lanes = 1,
          .arithmetic = Arithmetic::kRtl,
          .pairs = {Pair::kRaySphere, Pair::kSphereSphere, Pair::kTriangleSphere, Pair::kSphereObb},
          .box = true,
          .swap = true,
          .traversal_units = 1,
          .nodes = 1024,
          .latency = {.add = 2, .compare = 2},
          .ddr_slots = 2000,
          .sram_records = 64,
          .ecc = true};
}
inline BoardConfig on_pci_config() {
  BoardConfig c = fast_config();
  c.sram_records = 64;
  c.bus = Bus::kCycle;
  return c;
}
inline BoardConfig objects_config() {
  BoardConfig c = fast_config();
  c.transform = Transformer::kSecondaries;
  return c;
}
struct Card {
  const char* name;
  BoardConfig (*config)();
  OpenOptions options = {};
  friend std::ostream& operator<<(std::ostream& out, const Card& c) { return out << c.name; }
};
inline const Card kFast{"fast", fast_config}, kGates{"gates", gates_config},
    kSlow{"slow", slow_config}, kPci{"pci", on_pci_config},
    kWatertight{"watertight", watertight_config},
    kDdr{"ddr", fast_config, {.memory = Memory::kCycle}},
    kLate{"late", slow_config, {.ddr_latency = 300}}, kObjects{"objects", objects_config},
    kCached{"cached", cached_config, {.memory = Memory::kCycle}},
    kCachedLate{"cached_late", cached_config, {.ddr_latency = 300}};

constexpr Mode kModes[] = {Mode::kNearest, Mode::kFarthest, Mode::kAny, Mode::kHits,
                           Mode::kOccluded};

inline Record f_alone(const Record& any) {
  Record r;
  r.f = any.f;
  r.primary = any.primary;
  if (any.bad) r.bad = true, r.t = any.t, r.cp = any.cp;
  return r;
}

/// Records of the reference traversal, in the order of the card.
template <class P>
std::vector<Record> expected(reference::Traversal traversal, const std::vector<P>& rays,
                             Mode mode) {
  std::vector<Record> all;
  for (std::uint32_t i = 0; i < rays.size(); ++i) {
    for (const Record& r : traversal.trace(rays[i], i, mode == Mode::kOccluded ? Mode::kAny : mode))
      all.push_back(mode == Mode::kOccluded ? f_alone(r) : r);
  }
  if (mode == Mode::kHits)
    std::sort(all.begin(), all.end(), [](const Record& a, const Record& b) {
      return std::tuple(a.primary / 256, a.index, a.primary) <
             std::tuple(b.primary / 256, b.index, b.primary);
    });
  return all;
}

template <class P>
std::vector<Record> expected(const TriangleScene& scene, const Bvh& bvh, const std::vector<P>& rays,
                             Mode mode, Algorithm algorithm = Algorithm::kMoller) {
  return expected(reference::Traversal(scene, bvh, algorithm), rays, mode);
}

/// Checks that the card reads the same nodes as the reference. A pass of few primaries runs ahead
/// of its leaves (bvh_pkg::AHEAD) and may read more.
inline void expect_read(const Counters& c, const reference::TraversalCounts& reference,
                        std::size_t primaries) {
  if (primaries > 16) {
    EXPECT_EQ(c.nodes, reference.nodes);
    EXPECT_EQ(c.pairs, reference.secondaries);
  } else {
    EXPECT_GE(c.nodes, reference.nodes);
    EXPECT_GE(c.pairs, reference.secondaries);
  }
}

/// The query for a shape of primaries and the secondaries of the BVH.
template <class P, class Secondary>
Query query_of(Mode mode, Through through) {
  const auto [pair, swap] = bvh_pair<P, Secondary>();
  Query query{.mode = mode, .pair = pair, .swap = swap};
  query.through = through;
  return query;
}

/// All records, and the counters of the card.
template <class P>
std::vector<Record> cast(Board& board, const std::vector<P>& primaries, const Query& query,
                         Counters* counters = nullptr) {
  std::vector<Record> records;
  const Counters c = board.cast_shapes<P>(
      primaries, query,
      [&](std::span<const Record> some) {
        records.insert(records.end(), some.begin(), some.end());
      },
      false);
  if (counters != nullptr) *counters = c;
  return records;
}

inline std::size_t expect_same(const std::vector<Record>& records,
                               const std::vector<Record>& should) {
  EXPECT_EQ(records.size(), should.size());
  std::size_t different = 0, hits = 0;
  for (std::size_t i = 0; i < std::min(records.size(), should.size()); ++i) {
    hits += records[i].f;
    if (same_bits(records[i], should[i])) continue;
    if (different++ < 3)
      ADD_FAILURE() << "record " << i << " of ray " << records[i].primary << ": T " << records[i].t
                    << " of " << records[i].index << "; expected ray " << should[i].primary
                    << ", T " << should[i].t << " of " << should[i].index;
  }
  EXPECT_EQ(different, 0u);
  return hits;
}

inline std::vector<Ray> hard_rays(const TriangleScene& scene, std::size_t count) {
  hard::Rays draw(scene, 5);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    rays.push_back(draw(static_cast<unsigned>(i % hard::Rays::kKinds)));
    if (i % 61 == 7) rays.back().d.setZero();  // bad
    if (i % 127 == 9) rays.back().o.x() = std::numeric_limits<float>::quiet_NaN();
  }
  return rays;
}

}  // namespace cde::testing::through
