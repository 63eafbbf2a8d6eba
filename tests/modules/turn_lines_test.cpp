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

/// Random words, or words of a format with 2 to 4 bits of sign and exponent at their ends: zeros,
/// subnormals, infinities and NaN.
std::uint64_t operand(std::mt19937_64& engine) {
  const std::uint64_t random = engine();
  constexpr std::array<std::uint64_t, 6> kEnds{0,
                                               0x0001'0000'0001'0001,
                                               0x7ff0'0000'7f80'7c00,
                                               0x7ff8'0000'7fc0'7e01,
                                               0x3ff0'0000'3f80'3c00,
                                               0x8000'0000'8000'8000};
  return random % 3 == 0 ? kEnds[random / 3 % kEnds.size()] ^ (random & 0x8000'0000'8000'8000)
                         : random;
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
