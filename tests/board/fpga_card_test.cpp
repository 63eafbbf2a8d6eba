// SPDX-License-Identifier: Apache-2.0
// The top for one FPGA, in gates with open clock gates: record ring on chip, and a memory of 16
// bits for triangles, nodes and slots.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <vector>

#include "../expect_error.hpp"
#include "bvh_cards.hpp"
#include "cde/card/board.hpp"

namespace cde::testing {
namespace {

using namespace hard;
using namespace through;

/// Latencies that an FPGA has.
BoardConfig fpga_config() {
  BoardConfig config = gates_config();
  config.transform = Transformer::kNone;
  config.shared_lane = 8;
  config.contexts = 16;
  config.node_cycles = 4;
  config.latency = {.add = 9, .mul = 10, .div = 34, .sqrt = 32, .compare = 2};
  return config;
}

/// A board of the top `fpga_card`, whose parameters are a board's.
Board open_fpga_card(std::uint32_t latency) {
  const BoardConfig config = fpga_config();
  OpenOptions options;
  options.file = model_path("fpga_card", config.parameters());
  options.config_hash = model_hash("fpga_card", config.parameters());
  options.ddr_latency = latency;
  return Board::open(config, options);
}

std::vector<Record> cast_on(Board& board, const std::vector<Ray>& rays, Through through) {
  return board.cast(rays, {.pair = Pair::kRayTriangle, .through = through});
}

TEST(FpgaCard, TreeAndSweep_EqualTheReference) {
  const unsigned rays_of_scene = std::getenv("CDE_FULL") != nullptr ? 60 : 16;
  for (const std::uint32_t latency : {1u, 40u}) {
    Board board = open_fpga_card(latency);
    unsigned all = 0;
    for (const Case& c : kScenes) {
      SCOPED_TRACE(c.name);
      TriangleScene scene = c.make();
      if (scene.size() > 400) scene.resize(400);  // nodes and slots fit behind them
      const Bvh bvh = Bvh::build(scene);
      const std::vector<Ray> rays = hard_rays(scene, rays_of_scene);
      const std::vector<Record> should = expected(scene, bvh, rays, Mode::kNearest);
      board.upload(scene, bvh);
      const unsigned hits = expect_same(cast_on(board, rays, Through::kBvh), should);
      EXPECT_EQ(expect_same(cast_on(board, rays, Through::kBruteForce), should), hits);
      all += hits;
    }
    EXPECT_GT(all, 2 * rays_of_scene);
  }
}

/// A triangle of nine words takes 18 cycles of the memory, and less than two cycles are lost.
TEST(FpgaCard, Sweep_TakesTheCyclesOfTheMemory) {
  Board board = open_fpga_card(20);
  const TriangleScene scene = kScenes[0].make();
  board.upload(scene);
  const std::vector<Ray> ray = {{{0, 0, 10}, {0, 0, -1}}};
  const Counters counters = board.cast(ray, {.pair = Pair::kRayTriangle}, [](auto) {});
  const double per_triangle =
      static_cast<double>(counters.cycles) / static_cast<double>(scene.size());
  EXPECT_GE(per_triangle, 18);
  EXPECT_LT(per_triangle, 20);
}

/// The model of the memory takes the cycles of memory_port.sv, and host arithmetic takes the cycles
/// of gates.
TEST(FpgaCard, BoardWithANarrowMemory_TakesTheSameCycles) {
  const bool all = std::getenv("CDE_FULL") != nullptr;
  for (const std::uint32_t latency : {20u, 1u, 40u}) {
    if (latency != 20 && !all) continue;
    Board card = open_fpga_card(latency);
    BoardConfig config = fpga_config();
    config.arithmetic = Arithmetic::kHost;
    Board board = Board::open(config, {.memory = Memory::kNarrow, .ddr_latency = latency});
    for (const Case& c : kScenes) {
      SCOPED_TRACE(fmt::format("{}, latency {}", c.name, latency));
      TriangleScene scene = c.make();
      if (scene.size() > (all ? 100 : 30)) scene.resize(all ? 100 : 30);
      const Bvh bvh = Bvh::build(scene);
      const std::vector<Ray> rays = hard_rays(scene, 16);
      for (Board* b : {&card, &board}) b->upload(scene, bvh);
      for (const Through through : {Through::kBvh, Through::kBruteForce}) {
        const Query query{.pair = Pair::kRayTriangle, .through = through};
        const Counters of_card = card.cast(rays, query, [](auto) {});
        const Counters of_board = board.cast(rays, query, [](auto) {});
        // They may begin in different turns of the lane.
        EXPECT_NEAR(static_cast<double>(of_card.cycles), static_cast<double>(of_board.cycles),
                    config.shared_lane)
            << (through == Through::kBvh);
        EXPECT_EQ(of_card.fetched_nodes, of_board.fetched_nodes);
      }
    }
  }
}

/// The card has 64 places for rays.
TEST(FpgaCard, MoreRaysThanPlaces_AreStreamed) {
  BoardConfig config = fpga_config();
  config.arithmetic = Arithmetic::kHost;
  Board board = Board::open(config, {.memory = Memory::kNarrow});
  TriangleScene scene = kScenes[0].make();
  scene.resize(100);
  const Bvh bvh = Bvh::build(scene);
  const std::vector<Ray> rays = hard_rays(scene, 10 * config.ray_places + 1);
  board.upload(scene, bvh);
  EXPECT_GT(
      expect_same(cast_on(board, rays, Through::kBvh), expected(scene, bvh, rays, Mode::kNearest)),
      100u);
}

TEST(FpgaCard, NarrowMemoryWithCheckBits_IsRefused) {
  expect_error(ErrorCode::kUsage, "16 bits",
               [] { (void)Board::open({.ecc = true}, {.memory = Memory::kNarrow}); });
}

}  // namespace
}  // namespace cde::testing
