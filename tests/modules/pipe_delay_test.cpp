// SPDX-License-Identifier: Apache-2.0
// Delay lines in memories against delay lines in registers.
#include <gtest/gtest.h>

#include "PipeDelayLines.h"
#include "clocked.hpp"

namespace cde::testing {
namespace {

// A line has no reset: its start values come out first and may hide the first word.
TEST(PipeDelay, MemoryLines_DelayLikeRegisterLines) {
  constexpr int kLongest = 61;
  Clocked<PipeDelayLines> lines;
  std::mt19937_64 engine{Clocked<PipeDelayLines>::kSeed};
  unsigned differed = 0;
  for (int clock = 0; clock < 5000; ++clock) {
    lines->d_i = engine() >> 27;  // 37 bits
    lines.clock();
    if (clock > kLongest)
      ASSERT_EQ(lines->differ_o, 0) << "cycle " << clock;
    else
      differed |= unsigned{lines->differ_o};
  }
  EXPECT_EQ(differed, 0x7fu);  // the start values differ
}

}  // namespace
}  // namespace cde::testing
