// SPDX-License-Identifier: Apache-2.0
// Invalid accesses over the card's local bus. A refused access sets its error, reports its address
// and changes nothing.
#include <fmt/format.h>

#include <limits>

#include "cases.hpp"
#include "cde/contract/records.hpp"

namespace cde::testing {
namespace {

using namespace card;

class Registers : public ::testing::Test {
 protected:
  void SetUp() override {
    Random random;
    scene_ = beam(random, 256, 500);
    board_.upload(scene_.triangles);
    board_.load(scene_.rays);
  }

  std::uint64_t status() { return board_.read_register(kRegStatus); }
  void clear() { board_.write_register(kRegControl, kControlClear); }
  static std::uint64_t bit(unsigned number) { return std::uint64_t{1} << number; }

  /// Expects that the last access was refused, with this fault address.
  void expect_refused(Space space, std::uint32_t offset) {
    SCOPED_TRACE(fmt::format("space {} offset {:#x}", static_cast<int>(space), offset));
    EXPECT_NE(status() & bit(kStatusBusError), 0u);
    EXPECT_EQ(board_.read_register(kRegFaultAddr), kFaultSpace(space) | kFaultAddr(offset));
    clear();
    EXPECT_EQ(status() & bit(kStatusBusError), 0u);
  }
  void expect_write_refused(Space space, std::uint32_t offset) {
    const std::uint64_t beat = 0x0123456789abcdef;
    board_.bus_write(space, offset, {&beat, 1});
    expect_refused(space, offset);
  }
  void expect_read_refused(Space space, std::uint32_t offset) {
    std::uint64_t beat = 1;
    board_.bus_read(space, offset, {&beat, 1});
    EXPECT_EQ(beat, 0u);
    expect_refused(space, offset);
  }

  void start(std::uint64_t command, std::uint64_t primaries, std::uint64_t first,
             std::uint64_t count) {
    board_.write_register(kRegCommand, command);
    board_.write_register(kRegPrimCount, primaries);
    board_.write_register(kRegSecFirst, first);
    board_.write_register(kRegSecCount, count);
    board_.write_register(kRegControl, kControlGo);
  }

  Board board_ = Board::open(small_config());
  RayScene scene_;
};

TEST_F(Registers, ReadOnlyOrUnmapped_IsRefused) {
  for (const std::uint32_t r :
       {kRegId,        kRegCaps,      kRegConfigHash,  kRegCaps2,   kRegCapacity,  kRegStatus,
        kRegRecords,   kRegFaultAddr, kRegCycles,      kRegRows,    kRegStalls,    kRegBubbles,
        kRegBadPrim,   kRegBadSec,    kRegSecondaries, kRegWritten, kRegWriteback, kRegCaps3,
        kRegUncertain, kRegNodes,     kRegLeaves,      kRegTested,  kRegRoot,      kRegNodeCaps,
        kRegNodeCount, kRegRayCount,  kRegRays,        kRegDeepest, kRegNodeFault, kRegNewRoot,
        kRegNodeFlip,  kRegSlotCount, kRegNodeFirst,   kRegPairs}) {
    const std::uint64_t before = board_.read_register(r);
    expect_write_refused(kSpaceReg, r);
    if (r != kRegFaultAddr) {
      EXPECT_EQ(board_.read_register(r), before) << r;
    }
  }
  expect_write_refused(kSpaceReg, kRegIterations + 8);  // unmapped
  for (const std::uint32_t offset : {std::uint32_t{kRegEnd}, 0x1000u, 0x80000000u, 0xfffffff8u}) {
    expect_write_refused(kSpaceReg, offset);
    expect_read_refused(kSpaceReg, offset);
  }
}

TEST_F(Registers, UnalignedAccess_IsRefused) {
  for (const std::uint32_t low : {1u, 2u, 4u, 7u}) {
    expect_write_refused(kSpaceReg, kRegCommand + low);
    expect_read_refused(kSpaceReg, kRegId + low);
    expect_write_refused(kSpacePrim, 8 + low);
    expect_write_refused(kSpaceDdr, 16 + low);
  }
}

TEST_F(Registers, AccessBeyondTheMemories_IsRefused) {
  expect_write_refused(kSpacePrim, 256 * 32);
  expect_write_refused(kSpacePrim, 0x80000000u);
  expect_write_refused(kSpaceDdr, 36'000);  // 1,000 slots
  expect_write_refused(kSpaceDdr, 0xfffffff8u);
  expect_read_refused(kSpacePrim, 0);
  expect_read_refused(kSpaceDdr, 0);
  expect_write_refused(kSpaceSram, 0);
  const std::uint64_t beat = 0;
  board_.bus_write(kSpaceDdr, 35'992, {&beat, 1});  // the last beat inside
  EXPECT_EQ(status(), 0u);
}

TEST_F(Registers, UnknownSpaces_AreRefused) {
  start(kModeNearest, 8, 0, 20);  // state that refused accesses must not change
  board_.wait(100'000);
  const std::uint64_t command = board_.read_register(kRegCommand);
  ASSERT_EQ(board_.read_register(kRegRecords), 8u);
  clear();
  unsigned spaces = 0;
  for (std::uint32_t space = kSpaceNodes; space < 1u << kSpaceBits; ++space, ++spaces)
    for (const std::uint32_t offset : {std::uint32_t{0}, std::uint32_t{kRegCommand}, 0xfffffff8u}) {
      expect_write_refused(static_cast<Space>(space), offset);
      expect_read_refused(static_cast<Space>(space), offset);
    }
  EXPECT_EQ(spaces, 4u);
  EXPECT_EQ(board_.read_register(kRegCommand), command);
  EXPECT_EQ(board_.read_register(kRegRecords), 8u);
  std::vector<std::uint64_t> beats(8 / 2 * 7);
  board_.bus_read(kSpaceSram, 0, beats);
  EXPECT_EQ(status(), 0u);
  cast_and_compare(board_, scene_, {});
}

TEST_F(Registers, ReadOfAnEmptyRing_IsRefused) {
  expect_read_refused(kSpaceSram, 0);
  EXPECT_EQ(board_.read_register(kRegRecords), 0u);
  // Also after the last record of a pass.
  start(kModeNearest, 8, 0, 20);
  board_.wait(100'000);
  std::vector<std::uint64_t> beats(8 / 2 * 7);
  board_.bus_read(kSpaceSram, 0, beats);
  EXPECT_EQ(status() & bit(kStatusBusError), 0u);
  expect_read_refused(kSpaceSram, 0);
}

TEST_F(Registers, SeveralFaults_KeepTheFirst) {
  board_.write_register(kRegId, 1);
  board_.write_register(kRegCaps, 1);
  EXPECT_EQ(board_.read_register(kRegFaultAddr), kRegId);
  clear();
}

TEST_F(Registers, CommandsOutOfRange_AreRefused) {
  struct Command {
    std::uint64_t command, primaries, first, count;
  };
  constexpr std::uint64_t kHuge = ~std::uint64_t{0}, kWrap = std::uint64_t{1} << 32;
  for (const Command& c :
       {Command{5, 1, 0, 1}, Command{7, 1, 0, 1}, Command{1u << 8, 1, 0, 1},
        Command{0xf00, 1, 0, 1}, Command{0, 0, 0, 1}, Command{0, 257, 0, 1},
        Command{0, kHuge, 0, 1}, Command{0, kWrap + 1, 0, 1}, Command{0, 1, 0, 0},
        Command{0, 1, 0, 1001}, Command{0, 1, 1000, 1}, Command{0, 1, 999, 2},
        Command{0, 1, 0, kHuge}, Command{0, 1, kHuge, 1}, Command{0, 1, kHuge, kHuge},
        Command{0, 1, 0xffffffff, 2}, Command{0, 1, 0, kWrap + 1}, Command{0, 1, kWrap, 1}}) {
    SCOPED_TRACE(fmt::format("command {:#x} primaries {} first {} count {}", c.command, c.primaries,
                             c.first, c.count));
    start(c.command, c.primaries, c.first, c.count);
    EXPECT_EQ(status(), bit(kStatusCommandError) | bit(kStatusIrq));
    clear();
    EXPECT_EQ(status(), 0u);
  }
  start(kModeNearest, 1, 999, 1);
  board_.wait(100'000);
  EXPECT_EQ(status() & bit(kStatusDone), bit(kStatusDone));
}

/// Unwritten slots violate the contract. They are not rays of zeros.
TEST_F(Registers, UnwrittenPrimaries_AreBad) {
  board_.reset();
  board_.load(std::span(scene_.rays).first(2));
  start(kModeNearest, 4, 0, 20);
  board_.wait(100'000);
  ASSERT_NE(status() & bit(kStatusDone), 0u);
  EXPECT_EQ(board_.read_register(kRegBadPrim), 2u);
  std::vector<std::uint64_t> beats(4 / 2 * 7);
  board_.bus_read(kSpaceSram, 0, beats);
  for (unsigned i = 0; i < 4; ++i) {
    const unsigned word = 7 * i + kRecordFlags;
    EXPECT_EQ(beats[word / 2] >> word % 2 * 32 >> kFlagBad & 1, i < 2 ? 0u : 1u) << i;
  }
}

/// A read directly after the write of a count waits for the check. The last rays are still being
/// checked at first.
TEST_F(Registers, BadPrimaries_AreCountedUpToTheCountJustWritten) {
  for (std::size_t i = 0; i < scene_.rays.size(); i += 3)
    scene_.rays[i].d = {std::numeric_limits<float>::quiet_NaN(), 0, 0};
  board_.load(scene_.rays);
  for (const unsigned count : {1u, 0u, 4u, 200u, 3u, 17u, 64u, 255u, 256u, 2u}) {
    board_.write_register(kRegPrimCount, count);
    EXPECT_EQ(board_.read_register(kRegBadPrim), (count + 2) / 3) << count;
  }
}

TEST_F(Registers, WritesWhileBusy_AreRefusedAndHarmless) {
  start(kModeNearest, 256, 0, 500);
  expect_write_refused(kSpaceReg, kRegPrimCount);  // directly after the go
  for (const std::uint32_t r :
       {std::uint32_t{kRegCommand}, std::uint32_t{kRegPrimCount}, std::uint32_t{kRegSecFirst},
        std::uint32_t{kRegSecCount}, kRegStencil + 8u}) {
    const std::uint64_t before = board_.read_register(r);
    expect_write_refused(kSpaceReg, r);
    EXPECT_EQ(board_.read_register(r), before) << r;
  }
  expect_write_refused(kSpacePrim, 64);
  expect_write_refused(kSpaceDdr, 64);
  board_.write_register(kRegControl, kControlGo);  // a second go
  EXPECT_NE(status() & bit(kStatusCommandError), 0u);
  clear();
  ASSERT_NE(status() & bit(kStatusBusy), 0u) << "the pass ended before the accesses";
  for (unsigned looks = 0;; ++looks) {
    ASSERT_LT(looks, 1000u) << "the pass neither ends nor fills the ring";
    board_.wait(1000);
    if ((status() & bit(kStatusBusy)) == 0 || board_.read_register(kRegRecords) == 64) break;
  }
  // 256 records pass through the ring of 64.
  std::vector<std::uint64_t> beats(256 / 2 * 7);
  unsigned looks = 0;
  for (std::size_t got = 0; got < beats.size();) {
    ASSERT_LT(++looks, 1000u) << got << " of " << beats.size() << " beats came";
    board_.wait(300);
    const std::size_t n = board_.read_register(kRegRecords) / 2 * 7;
    board_.bus_read(kSpaceSram, 0, std::span(beats).subspan(got, n));
    got += n;
  }
  const auto expected = reference::cast(scene_.rays, scene_.triangles);
  for (std::size_t i = 0; i < 256; ++i)
    ASSERT_EQ(beats[(7 * i + kRecordT) / 2] >> (7 * i + kRecordT) % 2 * 32 & 0xffffffff,
              std::bit_cast<std::uint32_t>(expected[i].t))
        << i;
}

TEST_F(Registers, AbortWithoutAPass_IsHarmless) {
  for (int i = 0; i < 3; ++i) board_.write_register(kRegControl, kControlAbort);
  EXPECT_EQ(status(), 0u);
  cast_and_compare(board_, scene_, {});
}

TEST_F(Registers, RandomAccesses_NeverHangTheCard) {
  Random random;
  for (int round = 0; round < 20; ++round) {
    for (int i = 0; i < 200; ++i) {
      const auto space = static_cast<Space>(random.below(1 << kSpaceBits));
      const std::uint32_t offset = random.below(4) == 0 ? random.bits() : random.below(0x110);
      std::uint64_t beat = random.below(2) == 0
                               ? random.below(300)
                               : std::uint64_t{random.bits()} << 32 | random.bits();
      if (random.below(2) == 0) {
        board_.bus_write(space, offset, {&beat, 1});
      } else {
        board_.bus_read(space, offset, {&beat, 1});
      }
    }
    board_.write_register(kRegControl, kControlAbort | kControlClear);
    for (int k = 0; k < 200 && (status() & 1) != 0; ++k) {
    }
    board_.write_register(kRegControl, kControlAbort | kControlClear);
    ASSERT_EQ(status(), 0u);
    SCOPED_TRACE(round);
    cast_and_compare(board_, scene_, {.mode = static_cast<Mode>(round % 5)});
  }
}

}  // namespace
}  // namespace cde::testing
