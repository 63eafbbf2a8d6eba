// SPDX-License-Identifier: Apache-2.0
// Cards that do not answer and engines that hang, through the public interface. Results are correct
// records after a retry, or one clear error and correct records after reset().
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>

#include "../board/cases.hpp"
#include "../printed.hpp"
#include "cde/contract/pci.hpp"
#include "cde/support/error.hpp"

namespace cde::testing {
namespace {

struct Raised {
  ErrorCode code;
  std::string what;
  std::optional<DeviceFault> fault;
};
std::optional<Raised> raised(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return Raised{error.code(), error.what(), error.fault()};
  }
  return std::nullopt;
}
void expect_in(const std::string& part, const std::string& text) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
}

// ---- A card that does not answer ----

TEST(CardOutage, ShortOutage_EndsInCorrectRecords) {
  Board board = Board::open(pci_config());
  Random random;
  for (unsigned round = 0; round < 40; ++round) {
    const RayScene scene = beam(random, 1 + random.below(40), 1 + random.below(40));
    board.inject(BusFault::kNoAnswer, 1 + random.below(4));
    (void)cast_and_compare(board, scene, {.mode = round % 2 != 0 ? Mode::kAll : Mode::kNearest});
    (void)board.cycles();
  }
  EXPECT_GE(board.bus_counters().access_retries, 60u);
}

class PciStall : public ::testing::Test {
 protected:
  explicit PciStall(Bus bus = Bus::kCycle)
      : board(Board::open(rich_config(bus))), scene(beam(random, 20, 30)) {
    fill();
  }
  ~PciStall() override { EXPECT_EQ(board.bus_violation(), ""); }

  void fill() {
    board.upload(scene.triangles);
    board.load(scene.rays);
    board.load_second_shapes<Sphere>(spheres);
    board.set_objects(objects);
    board.set_primary_objects(primary_objects);
  }
  /// Every call that accesses the card.
  std::vector<std::pair<const char*, std::function<void()>>> calls() {
    const Query query{.pair = Pair::kRayTriangle};
    return {
        {"upload", [&] { board.upload(scene.triangles); }},
        {"upload_shapes", [&] { board.upload_shapes<Triangle>(scene.triangles); }},
        {"update_shapes", [&] { board.update_shapes<Triangle>(0, scene.triangles); }},
        {"set_objects", [&] { board.set_objects(objects); }},
        {"move_object", [&] { board.move_object(0, {}); }},
        {"set_primary_objects", [&] { board.set_primary_objects(primary_objects); }},
        {"move_primary_object", [&] { board.move_primary_object(0, {}); }},
        {"load", [&] { board.load(scene.rays); }},
        {"load_shapes", [&] { board.load_shapes<Ray>(scene.rays); }},
        {"load_second_shapes", [&] { board.load_second_shapes<Sphere>(spheres); }},
        {"run", [=, this] { (void)board.run(query); }},
        {"run to a sink", [=, this] { board.run(query, [](std::span<const Record>) {}); }},
        {"cast", [=, this] { (void)board.cast(scene.rays, query); }},
        {"read_register", [&] { (void)board.read_register(card::kRegId); }},
        {"write_register", [&] { board.write_register(card::kRegControl, 0); }},
        {"bus_write", [&] { board.bus_write(card::kSpaceDdr, 0, beats); }},
        {"bus_read", [&] { board.bus_read(card::kSpaceSram, 0, beats); }},
        {"wait", [&] { board.wait(1000); }},
    };
  }
  void expect_right_after_reset() {
    board.reset();
    EXPECT_THROW((void)board.run({.pair = Pair::kRayTriangle}), Error) << "the rays were dropped";
    (void)cast_and_compare(board, scene, {.pair = Pair::kRayTriangle});
    fill();
    EXPECT_EQ(board.run({.pair = Pair::kRayTriangle}).size(), scene.rays.size());
  }

  Random random;
  Board board;
  RayScene scene;
  std::vector<Sphere> spheres{{.c = {0, 0, 1}, .r = 0.5f}};
  std::vector<Object> objects{{.first = 0, .count = 30}};
  std::vector<Object> primary_objects{{.first = 0, .count = 20}};
  std::vector<std::uint64_t> beats{1, 2, 3};
};

/// Runs on either bus.
class LostCard : public PciStall, public ::testing::WithParamInterface<Bus> {
 protected:
  LostCard() : PciStall(GetParam()) {}
};

/// Any call may detect the loss, and all later calls then report the same error. The last call,
/// wait(), does not access the card when it sees an interrupt, so it does not always detect the
/// loss.
TEST_P(LostCard, EveryCall_GivesTheSameErrorUntilReset) {
  const std::size_t all = calls().size();
  for (std::size_t first = 0; first + 1 < all; ++first) {
    const auto call = calls();
    SCOPED_TRACE(call[first].first);
    board.inject(BusFault::kNoAnswer, kUntilReset);
    const std::uint64_t before = board.cycles();
    const auto met = raised(call[first].second);
    ASSERT_TRUE(met);
    EXPECT_EQ(met->code, ErrorCode::kDevice);
    ASSERT_TRUE(met->fault);
    EXPECT_EQ(met->fault->code, pci::kCodeMasterAbort);
    EXPECT_EQ(met->fault->pci_status, 0xffff);
    EXPECT_LT(met->fault->address, 0x10000u) << "offset in BAR0";
    EXPECT_GE(met->fault->cycle, before);
    expect_in("lost until reset()", met->what);
    expect_in(fmt::format("cycle {}", met->fault->cycle), met->what);
    board.inject(BusFault::kNoAnswer, 0);  // the card answers again, but its state is unknown
    for (const auto& [name, other] : call) {
      const auto again = raised(other);
      ASSERT_TRUE(again) << name;
      EXPECT_EQ(again->what, met->what) << name;
      EXPECT_EQ(again->code, met->code) << name;
    }
    expect_right_after_reset();
  }
}

TEST_P(LostCard, LossMidPass_IsAnError) {
  for (unsigned round = 0; round < 10; ++round) {
    unsigned pieces = 0;
    const auto met = raised([&] {
      board.run({.mode = Mode::kAll, .pair = Pair::kRayTriangle, .drain_records = 8},
                [&](std::span<const Record>) {
                  if (pieces++ == round) board.inject(BusFault::kNoAnswer, kUntilReset);
                });
    });
    ASSERT_TRUE(met);
    expect_in("does not answer", met->what);
    EXPECT_EQ(raised([&] { board.load(scene.rays); })->what, met->what);
    expect_right_after_reset();
  }
}

TEST_P(LostCard, LossThroughResets_StaysLost) {
  board.inject(BusFault::kNoAnswer, 1000);
  ASSERT_TRUE(raised([&] { board.load(scene.rays); }));
  unsigned resets = 0;
  while (const auto met = raised([&] { board.reset(); })) {
    expect_in("does not answer", met->what);
    ASSERT_LT(++resets, 1000u);
    ASSERT_TRUE(raised([&] { board.load(scene.rays); }));
  }
  EXPECT_GT(resets, 100u) << "each attempt takes at most six transactions";
  (void)cast_and_compare(board, scene, {.pair = Pair::kRayTriangle});
}

INSTANTIATE_TEST_SUITE_P(Buses, LostCard, ::testing::Values(Bus::kFunctional, Bus::kCycle),
                         [](const auto& info) {
                           return info.param == Bus::kCycle ? "Cycle" : "Functional";
                         });

/// Retried accesses are counted on either bus.
TEST_P(LostCard, ShortOutage_CountsRetries) {
  const std::uint64_t before = board.bus_counters().access_retries;
  for (unsigned round = 0; round < 10; ++round) {
    board.inject(BusFault::kNoAnswer, 1 + random.below(4));
    (void)cast_and_compare(board, scene, {.pair = Pair::kRayTriangle});
    board.inject(BusFault::kNoAnswer, 0);
  }
  const BusCounters c = board.bus_counters();
  EXPECT_GE(c.access_retries - before, 10u);
  EXPECT_GE(c.faults[static_cast<std::size_t>(BusFault::kNoAnswer)], 10u);
}

// ---- Interrupts ----

/// Starts a pass of one pair by hand and waits for its interrupt.
void one_pair(Board& board) {
  board.write_register(card::kRegCommand, 0);
  board.write_register(card::kRegPrimCount, 1);
  board.write_register(card::kRegSecFirst, 0);
  board.write_register(card::kRegSecCount, 1);
  board.write_register(card::kRegControl, card::kControlGo);
  EXPECT_LT(board.wait(100'000), 100'000u);
}

/// The clear is a posted write: it may still be under way when the driver starts to wait.
TEST_P(LostCard, InterruptBeforeAClear_DoesNotCount) {
  board.set_objects({});
  board.set_primary_objects({});
  for (const bool lost : {false, true}) {
    SCOPED_TRACE(lost ? "interrupt lost, found by polling" : "interrupt seen");
    if (lost && GetParam() == Bus::kCycle) board.inject(BusFault::kLostInterrupt, 1);
    one_pair(board);
    EXPECT_LT(board.wait(5000), 5000u) << "the interrupt was not cleared";
    board.write_register(card::kRegControl, card::kControlClear);
    EXPECT_GE(board.wait(5000), 5000u);
    one_pair(board);  // the next one does count
    board.write_register(card::kRegControl, card::kControlClear);
  }
  EXPECT_EQ(board.bus_counters().lost_interrupts, GetParam() == Bus::kCycle ? 1u : 0u);
}

/// If the card cannot read a descriptor, it writes no completion record. The ring halts, and the
/// interrupt of the halt can also be lost.
TEST_F(PciStall, InterruptOfAHaltedRing_IsCounted) {
  for (const unsigned lost : {0u, 1u}) {
    const BusCounters before = board.bus_counters();
    board.inject(BusFault::kMasterAbort, 1);
    board.inject(BusFault::kLostInterrupt, lost);
    board.upload(scene.triangles);
    const BusCounters after = board.bus_counters();
    EXPECT_EQ(after.transfer_retries - before.transfer_retries, 1u);
    EXPECT_EQ(after.lost_interrupts - before.lost_interrupts, lost);
  }
}

// ---- DMA engines and buses that hang ----

TEST_F(PciStall, GrantNeverGiven_IsATimeout) {
  board.inject(BusFault::kNoGrant, kUntilReset);
  const std::uint64_t before = board.time_ps();
  const auto met = raised([&] { board.upload(scene.triangles); });
  ASSERT_TRUE(met);
  EXPECT_EQ(met->code, ErrorCode::kTimeout);
  ASSERT_TRUE(met->fault);
  EXPECT_EQ(met->fault->address, 0x2000u) << "mapped address of the data";
  expect_in("DMA descriptor", met->what);
  expect_in("modelled time", met->what);
  EXPECT_GT(board.time_ps() - before, 10'000'000'000u);
  EXPECT_LT(board.time_ps() - before, 30'000'000'000u);
  for (const auto& [name, other] : calls()) {
    const auto again = raised(other);
    ASSERT_TRUE(again) << name;
    EXPECT_EQ(again->what, met->what) << name;
  }
  expect_right_after_reset();
}

TEST_F(PciStall, GrantGivenLate_GivesCorrectRecords) {
  board.inject(BusFault::kNoGrant, 10'000);
  (void)cast_and_compare(board, scene, {.pair = Pair::kRayTriangle});
}

/// Host memory that retries forever: the card's retry limit ends it, and nothing is lost.
TEST_F(PciStall, EndlessRetries_AreADeviceError) {
  board.inject(BusFault::kRetry, kUntilReset);
  const auto met = raised([&] { board.upload(scene.triangles); });
  ASSERT_TRUE(met);
  EXPECT_EQ(met->code, ErrorCode::kDevice);
  ASSERT_TRUE(met->fault);
  EXPECT_EQ(met->fault->code, pci::kCodeRetryLimit);
  expect_in("too many retries", met->what);
  board.inject(BusFault::kRetry, 0);
  (void)cast_and_compare(board, scene, {.pair = Pair::kRayTriangle});
}

/// More retries than the card's limit, fewer than the driver's limit.
TEST_F(PciStall, RetryStorm_GivesCorrectRecords) {
  board.inject(BusFault::kRetry, 40'000);
  (void)cast_and_compare(board, scene, {.pair = Pair::kRayTriangle});
  EXPECT_GE(board.bus_counters().transfer_retries, 2u);
}

/// A target that inserts wait states forever: the host itself no longer gets the bus.
TEST_F(PciStall, EndlessWaitStates_LoseTheCard) {
  board.inject(BusFault::kSlow, 1, ~0u);
  const auto met = raised([&] { board.upload(scene.triangles); });
  ASSERT_TRUE(met);
  ASSERT_TRUE(met->fault);
  EXPECT_EQ(met->fault->pci_status, 0xffff);
  expect_in("lost until reset()", met->what);
  EXPECT_EQ(raised([&] { board.load(scene.rays); })->what, met->what);
  expect_right_after_reset();
}

TEST(BusWatchdog, WatchdogInWallTime_EndsATransfer) {
  OpenOptions options;
  options.watchdog = std::chrono::microseconds(1);
  Board board = Board::open(pci_config(), options);
  board.inject(BusFault::kNoGrant, kUntilReset);
  Random random;
  const RayScene scene = beam(random, 20, 30);
  const auto met = raised([&] { board.upload(scene.triangles); });
  ASSERT_TRUE(met);
  EXPECT_EQ(met->code, ErrorCode::kTimeout);
  expect_in("watchdog", met->what);
}

// ---- An engine that hangs ----

class EngineHang : public ::testing::TestWithParam<Bus> {
 protected:
  EngineHang() : board(Board::open(rich_config(GetParam()))), scene(beam(random, 20, 60)) {
    board.upload(scene.triangles);
    board.load(scene.rays);
    board.set_objects(std::vector<Object>{{.first = 0, .count = 60}});
    expected = board.run(query);
  }
  void expect_same() {
    const auto got = board.run(query);
    ASSERT_EQ(got.size(), expected.size());
    for (std::size_t i = 0; i < got.size(); ++i)
      ASSERT_TRUE(same_bits(got[i], expected[i])) << "record " << i;
  }
  Random random;
  Board board;
  RayScene scene;
  Query query{.mode = Mode::kAll, .pair = Pair::kRayTriangle};
  std::vector<Record> expected;
};

TEST_P(EngineHang, ShortHang_IsWaitedFor) {
  for (const std::uint32_t cycles : {1u, 2u, 19u, 20u, 21u, 100u, 5000u}) {
    SCOPED_TRACE(cycles);
    Counters counters;
    board.inject(BusFault::kHang, cycles);
    (void)board.run(query, &counters);
    // On PCI the pass begins after accesses to its registers.
    if (cycles >= 5000) {
      EXPECT_GT(counters.bubbles, 2500u);
    }
    expect_same();
  }
}

/// The deadline in modelled time ends the pass. The abort waits for memory and ends with it.
TEST_P(EngineHang, Deadline_EndsThePass) {
  Query hasty = query;
  hasty.deadline_cycles = 20'000;
  board.inject(BusFault::kHang, 21'000);
  const auto met = raised([&] { (void)board.run(hasty); });
  ASSERT_TRUE(met);
  EXPECT_EQ(met->code, ErrorCode::kTimeout);
  ASSERT_TRUE(met->fault);
  EXPECT_GE(met->fault->cycle, 20'000u);
  expect_in("deadline of 20000 cycles", met->what);
  expect_same();
}

/// Only a reset ends this hang. The next pass loads rays and objects again.
TEST_P(EngineHang, AbortThatDoesNotEnd_BecomesAReset) {
  board.move_object(0, {.translation = {0.125f, 0, 0}});
  expected = board.run(query);
  board.inject(BusFault::kHang, kUntilReset);
  const auto met = raised([&] { (void)board.run(query); });
  ASSERT_TRUE(met);
  EXPECT_EQ(met->code, ErrorCode::kTimeout);
  expect_in("0 of 60 secondaries tested", met->what);
  expect_same();
}

TEST_P(EngineHang, Watchdog_EndsThePass) {
  Query patient = query;
  patient.deadline_cycles = std::uint64_t{1} << 40;
  patient.watchdog = std::chrono::milliseconds(50);
  board.inject(BusFault::kHang, kUntilReset);
  const auto start = std::chrono::steady_clock::now();
  const auto met = raised([&] { (void)board.run(patient); });
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(60));
  ASSERT_TRUE(met);
  EXPECT_EQ(met->code, ErrorCode::kTimeout);
  expect_in("watchdog of 0.05 s", met->what);
  expect_same();
}

/// The tests of buses that can also fail.
class EngineHangWithBusFaults : public EngineHang {};

/// A bus fault during recovery must not lose any restored state.
TEST_P(EngineHangWithBusFaults, InterruptedRecovery_IsResumed) {
  board.inject(BusFault::kHang, kUntilReset);
  ASSERT_TRUE(raised([&] { (void)board.run(query); }));
  board.inject(BusFault::kTargetAbort, kUntilReset, 0);
  ASSERT_TRUE(raised([&] { (void)board.run(query); }));
  board.inject(BusFault::kTargetAbort, 0);
  expect_same();
}

INSTANTIATE_TEST_SUITE_P(Buses, EngineHang, ::testing::Values(Bus::kFunctional, Bus::kCycle),
                         [](const auto& info) {
                           return info.param == Bus::kCycle ? "Cycle" : "Functional";
                         });
INSTANTIATE_TEST_SUITE_P(Buses, EngineHangWithBusFaults, ::testing::Values(Bus::kCycle),
                         [](const auto&) { return "Cycle"; });

// ---- Names of faults ----

TEST(BusFaults, Names_ReadBackEqual) {
  for (std::uint32_t kind = 0; kind < kBusFaults; ++kind) {
    const auto fault = static_cast<BusFault>(kind);
    EXPECT_EQ(fault_named(name_of(fault)), fault);
  }
  EXPECT_FALSE(fault_named("none"));
}

TEST(BusFaults, FunctionalBus_SupportsTwoFaults) {
  Board board = Board::open(small_config());
  for (std::uint32_t kind = 0; kind < kBusFaults; ++kind) {
    const auto fault = static_cast<BusFault>(kind);
    const auto met = raised([&] { board.inject(fault, 0); });
    ASSERT_EQ(met.has_value(), fault != BusFault::kHang && fault != BusFault::kNoAnswer)
        << name_of(fault);
    if (met) expect_in(fmt::format("no fault '{}'", name_of(fault)), met->what);
  }
}

}  // namespace
}  // namespace cde::testing
