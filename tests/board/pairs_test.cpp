// SPDX-License-Identifier: Apache-2.0
// Ray against triangle, pair by pair on the board: bit-identical to the mirror reference.
#include <fmt/format.h>
#include <ostream>

#include "cases.hpp"

namespace cde::testing {
namespace {

struct BoardKind {
  const char* name;
  BoardConfig (*config)();
  std::size_t packets;  ///< of 256 x `triangles` pairs
  std::size_t triangles;

  friend void PrintTo(const BoardKind& k, std::ostream* out) { *out << k.name; }
};

class BoardPairs : public ::testing::TestWithParam<BoardKind> {};

/// A million pairs on the full boards, over scales from 2^-50 to 2^50.
TEST_P(BoardPairs, RandomPairs_MatchBitForBit) {
  Board board = Board::open(GetParam().config());
  Random random;
  std::uint64_t pairs = 0, hits = 0;
  for (std::size_t i = 0; i < GetParam().packets; ++i) {
    const int exponent = i % 2 == 0 ? 0 : static_cast<int>(random.below(61)) - 30;
    const RayScene scene = beam(random, 256, GetParam().triangles, std::ldexp(1.0f, exponent));
    for (const Record& r : cast_and_compare(board, scene, {.mode = Mode::kAll}))
      hits += r.f ? 1 : 0, ++pairs;
  }
  const double share = static_cast<double>(hits) / static_cast<double>(pairs);
  fmt::print("{} of {} records match the reference, {:.1f} % hits\n", pairs, pairs, 100 * share);
  EXPECT_EQ(pairs, GetParam().packets * 256 * GetParam().triangles);
  EXPECT_GT(share, 0.3);
  EXPECT_LT(share, 0.7);
}

TEST_P(BoardPairs, DirectedPairs_MatchBitForBit) {
  Board board = Board::open(GetParam().config());
  const RayScene scene = directed();
  std::size_t hits = 0, bad = 0;
  const auto records = cast_and_compare(board, scene, {.mode = Mode::kAll});
  for (const Record& r : records) hits += r.f ? 1 : 0, bad += r.bad ? 1 : 0;
  fmt::print("{} records match the reference: {} hits, {} bad\n", records.size(), hits, bad);
  EXPECT_GT(hits, records.size() / 10);
  EXPECT_GT(bad, records.size() / 10);
  EXPECT_LT(hits + bad, records.size());
}

/// The same pairs, one secondary stream, through each reduction.
TEST_P(BoardPairs, DirectedCases_ReduceCorrectly) {
  Board board = Board::open(GetParam().config());
  for (const Mode mode : {Mode::kNearest, Mode::kFarthest, Mode::kAny, Mode::kHits}) {
    SCOPED_TRACE(name_of(mode));
    EXPECT_FALSE(cast_and_compare(board, directed(), {.mode = mode}).empty());
  }
}

INSTANTIATE_TEST_SUITE_P(Boards, BoardPairs,
                         ::testing::Values(BoardKind{"Host", host_config, 8, 500},
                                           BoardKind{"Rtl", rtl_config, 8, 500},
                                           BoardKind{"SmallAndSlow", small_config, 4, 100}),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace cde::testing
