// SPDX-License-Identifier: Apache-2.0
// Counters of units: random events, and reads at the table's registers in between.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <span>

#include "PassCounters.h"
#include "cde/contract/registers.hpp"
#include "clocked.hpp"

namespace cde::testing {
namespace {

using namespace card;

constexpr unsigned kFirst = 2, kHere = 5;  // of the table in CMakeLists.txt
constexpr unsigned kBits = 4;              // card_pkg::COUNT_BITS

TEST(PassCounters, EveryCounter_IsReadAtItsRegister) {
  const std::span<const Register> ours(kCounterRegisters + kFirst, kHere);
  VerilatedContext context;
  PassCounters counters(&context);
  Dice dice;
  std::array<std::uint64_t, kHere> counts = {};
  std::array<unsigned, kHere> reads = {};
  unsigned elsewhere = 0, refused = 0, passes = 0, resets = 0;
  for (int clock = 0; clock < 60'000; ++clock) {
    counters.rst_i = clock == 0 || dice.once_in(2000);
    counters.clear_i = dice.once_in(1000);
    passes += counters.clear_i;
    resets += counters.rst_i;
    counters.counts_i = static_cast<IData>(dice.below(1u << kBits * kHere));
    counters.read_i = dice.once_in(2);
    counters.hit_i = !dice.once_in(8);
    counters.offset_i = static_cast<SData>(8 * dice.below(kRegEnd / 8 + 8));
    counters.clk_i = counters.clk_bus_i = 0;
    counters.eval();
    counters.clk_i = counters.clk_bus_i = 1;
    counters.eval();
    if (counters.read_i != 0) {
      const auto found = std::find(ours.begin(), ours.end(), counters.offset_i);
      const auto c = static_cast<std::size_t>(found - ours.begin());
      const bool there = c < kHere && counters.hit_i != 0;
      ASSERT_EQ(counters.rdata_o, there ? counts.at(c) : 0u)
          << "cycle " << clock << ", offset " << counters.offset_i;
      if (there) ++reads.at(c);
      refused += c < kHere && !there;
      elsewhere += c == kHere;
    }
    for (unsigned c = 0; c < kHere; ++c)
      counts.at(c) =
          counters.clear_i != 0 || counters.rst_i != 0
              ? 0
              : counts.at(c) + (unsigned{counters.counts_i} >> kBits * c & ((1u << kBits) - 1));
  }
  counters.final();
  for (unsigned c = 0; c < kHere; ++c) {
    EXPECT_GT(reads.at(c), 100u) << c;
    EXPECT_GT(counts.at(c), 0u) << c;
  }
  EXPECT_GT(elsewhere, 1000u);
  EXPECT_GT(refused, 100u);
  EXPECT_GT(passes, 10u);
  EXPECT_GT(resets, 3u);
}

/// A counter has one register, and only counters of the table have registers.
TEST(PassCounters, Registers_AreListedOnce) {
  std::array<std::uint32_t, kCounters> offsets = {};
  std::copy(std::begin(kCounterRegisters), std::end(kCounterRegisters), offsets.begin());
  std::sort(offsets.begin(), offsets.end());
  EXPECT_EQ(std::adjacent_find(offsets.begin(), offsets.end()), offsets.end());
  for (const std::uint32_t offset : offsets) EXPECT_TRUE(offset % 8 == 0 && offset < kRegEnd);
}

}  // namespace
}  // namespace cde::testing
