// SPDX-License-Identifier: Apache-2.0
// Delay lines and dividers for values that come once per 2, 4 or 8 cycles, against those for values
// of every cycle.
#include <gtest/gtest.h>

#include <array>
#include <bit>

#include "TurnLines.h"
#include "clocked.hpp"

namespace cde::testing {
namespace {

/// Random words, and zeros, subnormals, ones, infinities and NaN of the three formats.
std::uint64_t operand(std::mt19937_64& engine) {
  constexpr std::array<std::uint64_t, 17> kEnds{0,
                                                1,
                                                0x03ff,
                                                0x3c00,
                                                0x7c00,
                                                0x7e01,
                                                0x7d00,
                                                0x007f'ffff,
                                                0x3f80'0000,
                                                0x7f80'0000,
                                                0x7fc0'0001,
                                                0x7fa0'0000,
                                                1ull << 51,
                                                0x3ffull << 52,
                                                0x7ffull << 52,
                                                (0xfffull << 51) + 1,
                                                0x7ff4ull << 48};
  const std::uint64_t random = engine();
  const std::uint64_t signs = engine() & 0x8000'0000'8000'8000;
  return random % 3 == 0 ? kEnds.at(random / 3 % kEnds.size()) ^ signs : random;
}

// A line has no reset: its start values come out first and may hide the first word.
TEST(TurnLines, LinesAndDividersOfTurns_GiveWordsOfEveryCycle) {
  constexpr unsigned kLongest = 130;
  Clocked<TurnLines> lines;
  std::mt19937_64 engine{Clocked<TurnLines>::kSeed};
  unsigned differed = 0;
  for (unsigned cycle = 0; cycle < 20'000; ++cycle) {
    lines->turn_i = static_cast<CData>(cycle % 8);
    lines->a_i = operand(engine);
    lines->b_i = operand(engine);
    lines.settle();
    if (cycle > kLongest)
      ASSERT_EQ(lines->differ_o, 0) << "cycle " << cycle;
    else
      differed |= unsigned{lines->differ_o};
    lines.clock();
  }
  EXPECT_EQ(differed, 0x7fffu);  // the start values differ
}

}  // namespace
}  // namespace cde::testing
