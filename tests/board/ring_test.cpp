// The record ring under pressure: full, drained slowly, left by an exception, aborted, out of time.
#include "cases.hpp"

namespace cde::testing {
namespace {

TEST(Ring, TinyRingLosesNothing) {
  Board board = Board::open(small_config());
  ASSERT_EQ(board.sram_records(), 64u);
  Random random;
  for (const std::uint32_t drain : {1u, 3u, 64u, 1000u}) {
    SCOPED_TRACE(drain);
    const Scene scene = beam(random, 100 + random.below(157), 20);
    Counters c;
    cast_and_compare(board, scene, {.mode = Mode::kAll, .drain_records = drain}, &c);
    EXPECT_GT(c.stalls, 0u) << "the ring never filled";
    cast_and_compare(board, scene, {.mode = Mode::kHits, .drain_records = drain});
    cast_and_compare(board, scene, {});  // 64 results fit, the rest waits
  }
}

/// More records than the seven SRAM chips hold.
TEST(Ring, MoreRecordsThanTheCardHolds) {
  Board board = Board::open(host_config());
  ASSERT_EQ(board.sram_records(), 524'288u);
  Random random;
  const Scene scene = beam(random, 256, 2200);
  board.upload(scene.triangles);
  reference::Checker checker(scene.rays, scene.triangles, Mode::kAll, {}, 256, "");
  const Counters c = board.cast(scene.rays, {.mode = Mode::kAll, .drain_records = 5000},
                                [&](std::span<const Record> some) { checker.check(some); });
  checker.finish();
  EXPECT_EQ(checker.compared(), 256u * 2200);
  EXPECT_EQ(c.records, 256u * 2200);
  EXPECT_GT(c.stalls, 0u);
}

/// A host that reads the ring whenever it likes: random numbers of beats, random pauses.
TEST(Ring, RandomReaderSeesEveryRecordInOrder) {
  Board board = Board::open(small_config());
  Random random;
  const Scene scene = beam(random, 256, 30);
  board.upload(scene.triangles);
  board.load(scene.rays);
  board.write_register(card::kRegCommand, card::kModeAll);
  board.write_register(card::kRegPrimCount, 256);
  board.write_register(card::kRegSecCount, 30);
  board.write_register(card::kRegControl, card::kControlGo);
  const auto expected = reference::cast(scene.rays, scene.triangles, Mode::kAll);
  std::vector<std::uint64_t> beats;
  while (beats.size() < 4 * expected.size()) {
    if (random.below(2) == 0) board.wait(random.below(300));
    const std::uint64_t waiting = board.read_register(card::kRegRecords) * 4 - beats.size() % 4;
    ASSERT_LE(waiting, 4u * 64);
    if (waiting == 0) continue;
    std::vector<std::uint64_t> some(1 + random.below(static_cast<std::uint32_t>(waiting)));
    board.bus_read(card::kSpaceSram, 0, some);
    beats.insert(beats.end(), some.begin(), some.end());
  }
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const auto word = [&](unsigned k) {
      return static_cast<std::uint32_t>(beats[4 * i + k / 2] >> 32 * (k % 2));
    };
    ASSERT_EQ(word(card::kRecordT), std::bit_cast<std::uint32_t>(expected[i].t)) << i;
    ASSERT_EQ(word(card::kRecordIndex), expected[i].index) << i;
    ASSERT_EQ(word(card::kRecordPrimary), expected[i].primary) << i;
    ASSERT_EQ(word(card::kRecordFlags), (expected[i].f ? 1u : 0u) | (expected[i].bad ? 2u : 0u))
        << i;
    ASSERT_EQ(word(card::kRecordWords), 0u) << "the eighth word";
  }
  EXPECT_EQ(board.read_register(card::kRegRecords), 0u);
  EXPECT_EQ(board.read_register(card::kRegStatus) >> card::kStatusBusError & 1, 0u);
}

TEST(Ring, ExceptionInTheSinkLeavesTheBoardUsable) {
  Random random;
  for (const auto config : {host_config, small_config}) {
    Board board = Board::open(config());
    const Scene scene = beam(random, 256, 40);
    board.upload(scene.triangles);
    for (const std::uint64_t patience : {0u, 1000u, 3000u}) {
      std::uint64_t seen = 0;
      EXPECT_THROW(board.cast(scene.rays, {.mode = Mode::kAll, .drain_records = 16},
                              [&](std::span<const Record> some) {
                                seen += some.size();
                                if (seen > patience) throw std::runtime_error("enough");
                              }),
                   std::runtime_error);
      EXPECT_EQ(board.read_register(card::kRegRecords), 0u);
      EXPECT_EQ(board.read_register(card::kRegStatus), 0u);
    }
    cast_and_compare(board, scene, {.mode = Mode::kAll});
    cast_and_compare(board, scene, {});
  }
}

TEST(Ring, DeadlineAndWatchdog) {
  Board board = Board::open(host_config());
  Random random;
  const Scene scene = cloud(random, 256, 1000);
  board.upload(scene.triangles);
  for (const Query& query :
       {Query{.deadline_clocks = 5000}, Query{.watchdog = std::chrono::nanoseconds(1)}}) {
    const bool watchdog = query.deadline_clocks == 0;
    Scene longer = scene;
    if (watchdog) longer.triangles.resize(2000, scene.triangles[0]), board.upload(longer.triangles);
    try {
      (void)board.cast(scene.rays, query);
      FAIL() << "no timeout";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::kTimeout);
      EXPECT_NE(std::string(e.what()).find("secondaries swept"), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find(watchdog ? "watchdog" : "deadline of 5000 clocks"),
                std::string::npos)
          << e.what();
    }
    EXPECT_EQ(cast_and_compare(board, scene, {}).size(), 256u);
  }
}

/// Abort and reset at random moments of passes in every mode; then a full pass must be right.
TEST(Ring, AbortAndResetInMidPass) {
  Random random;
  for (const auto config : {host_config, small_config}) {
    Board board = Board::open(config());
    const Scene scene = beam(random, 256, 30);
    board.upload(scene.triangles);
    for (int i = 0; i < 60; ++i) {
      board.load(scene.rays);
      board.write_register(card::kRegCommand, random.below(5));
      board.write_register(card::kRegPrimCount, 1 + random.below(256));
      board.write_register(card::kRegSecCount, 1 + random.below(30));
      board.write_register(card::kRegControl, card::kControlGo);
      for (std::uint32_t n = random.below(900); n != 0; --n) {
        if (board.wait(1) == 0) break;
      }
      if (i % 3 == 0) {
        board.reset();
      } else {
        board.write_register(card::kRegControl, card::kControlAbort | card::kControlClear);
        for (int k = 0; k < 200 && (board.read_register(card::kRegStatus) & 1) != 0; ++k) {
        }
      }
      ASSERT_EQ(board.read_register(card::kRegStatus) & 1, 0u) << "busy after an abort";
      ASSERT_EQ(board.read_register(card::kRegRecords), 0u);
      if (i % 6 < 2) {
        SCOPED_TRACE(i);
        const Scene other = beam(random, 1 + random.below(256), 25);
        cast_and_compare(board, other, {.mode = static_cast<Mode>(random.below(5))});
        board.upload(scene.triangles);
      }
    }
  }
}

}  // namespace
}  // namespace cde::testing
