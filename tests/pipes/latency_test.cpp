// SPDX-License-Identifier: Apache-2.0
// Latency and throughput of the Möller pipe as the card states them.
#include <gtest/gtest.h>

#include "cde/card/board.hpp"

namespace {

using cde::BoardConfig;

TEST(Moller, SingleCycleOperators_GiveTenCycles) {
  cde::Board board = cde::Board::open(BoardConfig{});
  EXPECT_EQ(board.pipe_latency(), 10u);
}

TEST(Moller, Latency_FollowsTheOperators) {
  const BoardConfig config{.lanes = 4,
                           .latency = {.add = 2, .mul = 3, .div = 9, .compare = 2},
                           .ddr_slots = 1000,
                           .sram_records = 64};
  cde::Board board = cde::Board::open(config);
  // sub, cross (mul sub), dot (mul add add), div, scale (mul), point (add), select.
  const unsigned a = config.latency.add, m = config.latency.mul, d = config.latency.div;
  EXPECT_EQ(board.pipe_latency(), a + (m + a) + (m + 2 * a) + d + m + a + 1);
}

class Throughput : public ::testing::TestWithParam<unsigned> {};

TEST_P(Throughput, FullStream_TakesOneRowPerCycle) {
  const unsigned rays = GetParam();
  cde::Board board = cde::Board::open(BoardConfig{});
  const cde::Triangle triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  constexpr std::uint64_t kTriangles = 5000;
  board.upload(std::vector<cde::Triangle>(kTriangles, triangle));
  board.load(std::vector<cde::Ray>(rays, cde::Ray{{0.2f, 0.2f, 1}, {0, 0, -1}}));
  cde::Counters counters;
  (void)board.run({}, &counters);
  const std::uint64_t rows = (rays + board.lanes() - 1) / board.lanes();
  EXPECT_EQ(counters.rows, kTriangles * rows);
  EXPECT_LE(counters.cycles, kTriangles * rows + 200);
  EXPECT_EQ(counters.stalls, 0u);
  EXPECT_LE(counters.bubbles, 30u) << "idle only until the first triangle arrives";
}

INSTANTIATE_TEST_SUITE_P(Rays, Throughput, ::testing::Values(1u, 16u, 17u, 255u, 256u),
                         [](const auto& info) { return std::to_string(info.param); });

}  // namespace
