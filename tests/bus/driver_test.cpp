// SPDX-License-Identifier: Apache-2.0
// The driver on the PCI card gives the records of the functional bus, also under faults.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <ostream>

#include "../board/cases.hpp"
#include "cde/support/error.hpp"

namespace cde::testing {
namespace {

OpenOptions options(const char* host, std::uint32_t burst = 4096) {
  OpenOptions o;
  o.host = *host_profile(host);
  o.bus_burst = burst;
  return o;
}

class PciDriver : public ::testing::TestWithParam<const char*> {};

TEST_P(PciDriver, EveryMode_EqualsTheReference) {
  Board board = Board::open(pci_config(), options(GetParam(), 256));
  Random random;
  const RayScene scene = cloud(random, 300, 400);
  for (const Mode mode : {Mode::kNearest, Mode::kFarthest, Mode::kAny, Mode::kAll, Mode::kHits}) {
    SCOPED_TRACE(name_of(mode));
    EXPECT_GT(cast_and_compare(board, scene, {.mode = mode}).size(), 50u);
  }
  const BusCounters c = board.bus_counters();
  EXPECT_EQ(c.transfer_retries + c.pass_retries + c.lost_interrupts + c.access_retries, 0u);
  EXPECT_GE(c.bytes_to_card, 400u * 36 + 300 * 32);
  EXPECT_GT(c.pci_data, (c.bytes_to_card + c.bytes_to_host) / 8);
  EXPECT_GT(board.time_ps(), c.pci_busy * 15'000);
}
INSTANTIATE_TEST_SUITE_P(Hosts, PciDriver, ::testing::Values("ideal", "good", "p64-2001"),
                         [](const auto& info) {
                           std::string name = info.param;
                           std::erase(name, '-');
                           return name;
                         });

struct Fault {
  const char* name;
  BusFault fault;
  std::uint32_t value;

  friend void PrintTo(const Fault& f, std::ostream* out) { *out << f.name; }
};
class PciFaults : public ::testing::TestWithParam<Fault> {};

/// Faults before an upload, before a load and during a pass: correct records, or one clear error
/// and correct records after it.
TEST_P(PciFaults, RandomFaults_EndInCorrectRecordsOrOneError) {
  Board board = Board::open(pci_config(), options("good", 256));
  Random random;
  std::uint64_t errors = 0;
  for (unsigned round = 0; round < 60; ++round) {
    const RayScene scene = cloud(random, 1 + random.below(80), 1 + random.below(300));
    const Mode mode = random.below(2) == 0 ? Mode::kAll : Mode::kNearest;
    SCOPED_TRACE(fmt::format("round {}, mode {}", round, name_of(mode)));
    const auto hurt = [&] {
      board.inject(GetParam().fault, 1 + random.below(2), GetParam().value + random.below(3));
    };
    try {
      hurt();
      board.upload(scene.triangles);
      hurt();
      board.load(scene.rays);
      hurt();
      const auto records = board.run({.mode = mode});
      const auto expected = reference::cast(scene.rays, scene.triangles, mode);
      ASSERT_EQ(records.size(), expected.size());
      for (std::size_t i = 0; i < records.size(); ++i)
        ASSERT_TRUE(same_bits(records[i], expected[i])) << "record " << i;
    } catch (const Error& error) {
      ++errors;
      ASSERT_TRUE(error.fault()) << error.what();
      EXPECT_NE(std::string(error.what()).find("cycle"), std::string::npos) << error.what();
    }
    (void)cast_and_compare(board, scene, {.mode = mode});
  }
  const BusCounters c = board.bus_counters();
  std::printf(
      "%s: %llu errors, %llu transfers repeated, %llu passes, %llu accesses, %llu lost "
      "interrupts\n",
      GetParam().name, static_cast<unsigned long long>(errors),
      static_cast<unsigned long long>(c.transfer_retries),
      static_cast<unsigned long long>(c.pass_retries),
      static_cast<unsigned long long>(c.access_retries),
      static_cast<unsigned long long>(c.lost_interrupts));
  EXPECT_EQ(errors, 0u) << "the driver must recover from two faults in a row";
}
INSTANTIATE_TEST_SUITE_P(Kinds, PciFaults,
                         ::testing::Values(Fault{"retry", BusFault::kRetry, 1},
                                           Fault{"slow", BusFault::kSlow, 1},
                                           Fault{"disconnect", BusFault::kDisconnect, 1},
                                           Fault{"disconnect_empty", BusFault::kDisconnectEmpty, 1},
                                           Fault{"parity", BusFault::kParity, 1},
                                           Fault{"target_abort", BusFault::kTargetAbort, 0},
                                           Fault{"master_abort", BusFault::kMasterAbort, 0},
                                           Fault{"lost_interrupt", BusFault::kLostInterrupt, 0},
                                           Fault{"grant", BusFault::kGrant, 1}),
                         [](const auto& info) { return info.param.name; });

/// Repeated faults at every stage of one pass while its records arrive. The driver repeats the pass
/// and delivers each record once, in order. A large ring delivers many thousands of records
/// together, a small ring only a few.
TEST(PciDriverErrors, RepeatedPass_DeliversEachRecordOnce) {
  constexpr std::size_t kRays = 256, kTriangles = 100;
  for (const bool small_ring : {true, false}) {
    SCOPED_TRACE(small_ring ? "ring of 64" : "ring of 524,288");
    BoardConfig config = small_ring ? pci_config() : host_config();
    config.bus = Bus::kCycle;
    Board board = Board::open(config, options("ideal"));
    Random random;
    const RayScene scene = beam(random, kRays, small_ring ? kTriangles / 2 : kTriangles);
    const auto expected = reference::cast(scene.rays, scene.triangles, Mode::kAll);
    ASSERT_GT(expected.size(), 8192u);
    board.upload(scene.triangles);
    board.load(scene.rays);
    std::uint64_t late = 0;
    for (const std::size_t third : {0u, 1u, 2u}) {
      const std::uint64_t before = board.bus_counters().pass_retries;
      std::vector<Record> got;
      unsigned faults = 2;
      bool after_some = false;
      const RecordSink sink = [&](std::span<const Record> some) {
        got.insert(got.end(), some.begin(), some.end());
        if (faults == 0 || got.size() <= third * expected.size() / 3) return;
        --faults;
        after_some = true;
        board.inject(BusFault::kTargetAbort, 1, 2);
      };
      (void)board.run({.mode = Mode::kAll}, sink);
      ASSERT_EQ(got.size(), expected.size());
      for (std::size_t i = 0; i < got.size(); ++i)
        ASSERT_TRUE(same_bits(got[i], expected[i])) << "record " << i;
      if (after_some) late += board.bus_counters().pass_retries - before;
    }
    EXPECT_GE(late, 3u) << "passes repeated after records were delivered";
  }
}

/// A transfer that fails in the middle of its data continues where it ended, also on the card.
TEST(PciDriverErrors, FailedTransfer_ContinuesWhereItEnded) {
  Board board = Board::open(pci_config(), options("ideal", 256));
  Random random;
  const RayScene scene = beam(random, 20, 100);
  const auto expected = reference::cast(scene.rays, scene.triangles, Mode::kAll);
  board.inject(BusFault::kTargetAbort, 2, 9);  // the descriptor has fewer data phases
  board.upload(scene.triangles);
  EXPECT_EQ(board.bus_counters().transfer_retries, 1u);
  board.load(scene.rays);
  const auto records = board.run({.mode = Mode::kAll});
  ASSERT_EQ(records.size(), expected.size());
  for (std::size_t i = 0; i < records.size(); ++i)
    ASSERT_TRUE(same_bits(records[i], expected[i])) << "record " << i;
}

/// More consecutive failures than the driver retries are an error with the device's status.
TEST(PciDriverErrors, PersistentAbort_IsOneError) {
  Board board = Board::open(pci_config(), options("ideal"));
  Random random;
  const RayScene scene = beam(random, 20, 100);
  board.inject(BusFault::kTargetAbort, 1000, 0);
  try {
    board.upload(scene.triangles);
    FAIL() << "the upload must fail";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kDevice);
    ASSERT_TRUE(error.fault());
    EXPECT_EQ(error.fault()->code, 6u) << error.what();
    EXPECT_NE(error.fault()->pci_status >> 12 & 1, 0) << "received target abort";
    EXPECT_NE(std::string(error.what()).find("target abort"), std::string::npos) << error.what();
  }
  board.inject(BusFault::kTargetAbort, 0, 0);
  board.reset();
  (void)cast_and_compare(board, scene, {});
}

// ---- Flipped bits in DDR ----

class PciEcc : public ::testing::Test {
 protected:
  PciEcc() : board_(Board::open(rich_config(Bus::kCycle), options("good"))) {
    board_.upload(scene_.triangles);
    board_.load(scene_.rays);
    expected_ = board_.run(query_);
  }
  /// Flips `mask` in a byte, or in the check bits of a word, and flips it back afterwards.
  template <class F>
  void with_flip(bool check, std::uint64_t at, unsigned mask, const F& then) {
    const auto flip = [&] {
      if (check)
        board_.flip_check(at, static_cast<std::uint8_t>(mask));
      else
        board_.flip_ddr(at, static_cast<std::uint8_t>(mask));
    };
    flip();
    then();
    flip();
  }
  void expect_corrected() {
    Counters counters;
    const auto got = board_.run(query_, &counters);
    EXPECT_EQ(counters.corrected_words, 1u);
    ASSERT_EQ(got.size(), expected_.size());
    for (std::size_t i = 0; i < got.size(); ++i)
      ASSERT_TRUE(same_bits(got[i], expected_[i])) << "record " << i;
  }

  Random random_;
  RayScene scene_ = beam(random_, 20, 60);
  Board board_;
  Query query_{.mode = Mode::kAll, .pair = Pair::kRayTriangle};
  std::vector<Record> expected_;
};

TEST_F(PciEcc, OneBit_IsCorrectedAndCounted) {
  for (unsigned bit = 0; bit < 32; ++bit)
    with_flip(false, 4 * random_.below(9 * 60) + bit / 8, 1u << bit % 8,
              [&] { expect_corrected(); });
  for (unsigned bit = 0; bit < 7; ++bit)
    with_flip(true, random_.below(9 * 60), 1u << bit, [&] { expect_corrected(); });
}

TEST_F(PciEcc, TwoBits_AreAnErrorWithAddress) {
  for (unsigned i = 0; i < 40; ++i) {
    const std::uint32_t slot = i == 0 ? 0 : i == 1 ? 59 : random_.below(60);
    const unsigned bit = random_.below(7);
    with_flip(false, 36 * slot + random_.below(36), 3u << bit, [&] {
      try {
        (void)board_.run(query_);
        FAIL() << "no error for two wrong bits";
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::kDevice);
        ASSERT_TRUE(error.fault());
        EXPECT_EQ(error.fault()->address, 36 * slot) << error.what();
        EXPECT_NE(std::string(error.what()).find(fmt::format("in secondary {} ", slot)),
                  std::string::npos)
            << error.what();
      }
    });
  }
  EXPECT_EQ(board_.run(query_).size(), expected_.size());
}

}  // namespace
}  // namespace cde::testing
