// SPDX-License-Identifier: Apache-2.0
// The record ring under pressure: full, slowly drained, left by an exception, aborted, timed out.
#include "cases.hpp"
#include "cde/contract/records.hpp"

namespace cde::testing {
namespace {

TEST(RecordRing, TinyRing_LosesNothing) {
  Board board = Board::open(small_config());
  ASSERT_EQ(board.sram_records(), 64u);
  Random random;
  for (const std::uint32_t drain : {1u, 3u, 64u, 1000u}) {
    SCOPED_TRACE(drain);
    const RayScene scene = beam(random, 100 + random.below(157), 20);
    Counters c;
    cast_and_compare(board, scene, {.mode = Mode::kAll, .drain_records = drain}, &c);
    EXPECT_GT(c.stalls, 0u) << "the ring never filled";
    cast_and_compare(board, scene, {.mode = Mode::kHits, .drain_records = drain});
    cast_and_compare(board, scene, {});  // 64 results fit, the others wait
  }
}

/// More records than the seven SRAM chips hold.
TEST(RecordRing, MoreRecordsThanTheRing_AreAllDelivered) {
  Board board = Board::open(host_config());
  ASSERT_EQ(board.sram_records(), 524'288u);
  Random random;
  const RayScene scene = beam(random, 256, 3000);
  board.upload(scene.triangles);
  reference::Checker checker(scene.rays, scene.triangles, Mode::kAll, {}, 256, "");
  const Counters c = board.cast(scene.rays, {.mode = Mode::kAll, .drain_records = 5000},
                                [&](std::span<const Record> some) { checker.check(some); });
  checker.finish();
  EXPECT_EQ(checker.compared(), 256u * 3000);
  EXPECT_EQ(c.records, 256u * 3000);
  EXPECT_GT(c.stalls, 0u);
}

bool refused(Board& board) {
  return (board.read_register(card::kRegStatus) >> card::kStatusBusError & 1) != 0;
}

/// A host that reads the ring at random: random numbers of beats, random pauses. A beat that two
/// records share is available when both records are, or when the pass ends.
void read_randomly(const RayScene& scene, std::size_t triangles) {
  Board board = Board::open(small_config());
  Random random;
  board.upload(scene.triangles);
  board.load(scene.rays);
  board.write_register(card::kRegCommand, card::kModeAll);
  board.write_register(card::kRegPrimCount, scene.rays.size());
  board.write_register(card::kRegSecCount, triangles);
  const auto expected =
      reference::cast(scene.rays, std::span(scene.triangles).first(triangles), Mode::kAll);
  const std::size_t wanted = (card::kRecordWords * expected.size() + 1) / 2;
  for (int pass = 0; pass < 2; ++pass) {  // the second pass also begins with a whole beat
    board.write_register(card::kRegControl, card::kControlGo);
    std::vector<std::uint32_t> words;
    // Ends the test if the card gives no more records, or if their count stands still.
    for (unsigned looks = 0; words.size() < 2 * wanted; ++looks) {
      ASSERT_LT(looks, 1000u) << words.size() << " of " << 2 * wanted << " words came";
      if (random.below(2) == 0) board.wait(random.below(300));
      const bool over = (board.read_register(card::kRegStatus) >> card::kStatusBusy & 1) == 0;
      const std::uint64_t entries = board.read_register(card::kRegRecords);
      ASSERT_LE(entries, 64u);
      // Words in the ring that were not read yet, and the whole beats among them.
      const std::uint64_t there = card::kRecordWords * entries - words.size() % card::kRecordWords;
      const std::uint64_t beats = over ? (there + 1) / 2 : there / 2;
      if (beats == 0) continue;
      looks = 0;
      std::vector<std::uint64_t> some(1 + random.below(static_cast<std::uint32_t>(beats)));
      board.bus_read(card::kSpaceSram, 0, some);
      for (const std::uint64_t beat : some)
        for (const unsigned half : {0u, 32u})
          words.push_back(static_cast<std::uint32_t>(beat >> half));
    }
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const std::uint32_t* word = &words[card::kRecordWords * i];
      ASSERT_EQ(word[card::kRecordT], std::bit_cast<std::uint32_t>(expected[i].t)) << i;
      ASSERT_EQ(word[card::kRecordIndex], expected[i].index) << i;
      ASSERT_EQ(word[card::kRecordPrimary], expected[i].primary) << i;
      ASSERT_EQ(word[card::kRecordFlags], (expected[i].f ? 1u : 0u) | (expected[i].bad ? 2u : 0u))
          << i;
    }
    for (std::size_t i = card::kRecordWords * expected.size(); i < words.size(); ++i)
      ASSERT_EQ(words[i], 0u) << "padding after the last record";
    EXPECT_EQ(board.read_register(card::kRegRecords), 0u);
    EXPECT_FALSE(refused(board));
    std::array<std::uint64_t, 1> more{};
    board.bus_read(card::kSpaceSram, 0, more);
    EXPECT_TRUE(refused(board));
    board.write_register(card::kRegControl, card::kControlClear);
  }
}

TEST(RecordRing, RandomReader_SeesEveryRecordInOrder) {
  Random random;
  read_randomly(beam(random, 256, 30), 30);
  read_randomly(beam(random, 151, 21), 21);  // an odd number of records
}

/// During a pass, the last word of a lone record waits for the next record. Reading it is refused,
/// like reading an empty ring.
TEST(RecordRing, BeatOfTwoRecords_IsReadableWhenBothExist) {
  // A core so slow that the host can see single records arrive.
  Board board = Board::open(small_config(), {.clock_period_ps = 1'000'000});
  Random random;
  const RayScene scene = beam(random, 256, 20);
  board.upload(scene.triangles);
  board.load(scene.rays);
  board.write_register(card::kRegCommand, card::kModeAll);
  board.write_register(card::kRegPrimCount, 256);
  board.write_register(card::kRegSecCount, 20);
  // One ray of 256: one record per 64 cycles.
  for (unsigned base = 0; base < 4; ++base)
    board.write_register(card::kRegStencil + 8 * base, base == 0 ? ~1ull : ~0ull);
  board.write_register(card::kRegControl, card::kControlGo);
  for (unsigned cycles = 0; board.read_register(card::kRegRecords) == 0; ++cycles) {
    ASSERT_LT(cycles, 100'000u) << "no record came";
    board.wait(1);
  }
  std::array<std::uint64_t, 3> whole{};
  board.bus_read(card::kSpaceSram, 0, whole);
  EXPECT_FALSE(refused(board));
  std::array<std::uint64_t, 1> shared{~0ull};
  board.bus_read(card::kSpaceSram, 0, shared);
  ASSERT_EQ(board.read_register(card::kRegRecords), 1u) << "the next record came too early";
  EXPECT_TRUE(refused(board));
  EXPECT_EQ(shared[0], 0u);
  board.write_register(card::kRegControl, card::kControlClear);
  // The refused read lost nothing.
  EXPECT_FALSE(refused(board));
  board.wait(64 * 20 + 1000);
  EXPECT_EQ(board.read_register(card::kRegRecords), 20u);
  std::array<std::uint64_t, 70 - 3> rest{};
  board.bus_read(card::kSpaceSram, 0, rest);
  EXPECT_FALSE(refused(board));
  const auto expected =
      reference::cast(std::span(scene.rays).first(1), scene.triangles, Mode::kAll);
  EXPECT_EQ(rest[0] >> 32, std::bit_cast<std::uint32_t>(expected[1].cp[0]));
  EXPECT_EQ(rest.back() >> 32, 0u) << "primary of the last record";
  EXPECT_EQ(rest.back() & 0xffffffff, std::bit_cast<std::uint32_t>(expected[19].t));
}

TEST(RecordRing, ExceptionInTheSink_LeavesTheBoardUsable) {
  Random random;
  for (const auto config : {host_config, small_config}) {
    Board board = Board::open(config());
    const RayScene scene = beam(random, 256, 40);
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

TEST(RecordRing, DeadlineOrWatchdog_EndsThePass) {
  Board board = Board::open(host_config());
  Random random;
  const RayScene scene = cloud(random, 256, 1000);
  board.upload(scene.triangles);
  for (const Query& query :
       {Query{.deadline_cycles = 5000}, Query{.watchdog = std::chrono::nanoseconds(1)}}) {
    const bool watchdog = query.deadline_cycles == 0;
    RayScene longer = scene;
    if (watchdog) longer.triangles.resize(2000, scene.triangles[0]), board.upload(longer.triangles);
    try {
      (void)board.cast(scene.rays, query);
      FAIL() << "no timeout";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::kTimeout);
      EXPECT_NE(std::string(e.what()).find("secondaries tested"), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find(watchdog ? "watchdog" : "deadline of 5000 cycles"),
                std::string::npos)
          << e.what();
    }
    EXPECT_EQ(cast_and_compare(board, scene, {}).size(), 256u);
  }
}

/// Abort and reset at random cycles of passes in every mode; the next full pass is correct.
TEST(RecordRing, AbortOrResetMidPass_NextPassIsCorrect) {
  Random random;
  for (const auto config : {host_config, small_config}) {
    Board board = Board::open(config());
    const RayScene scene = beam(random, 256, 30);
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
        const RayScene other = beam(random, 1 + random.below(256), 25);
        cast_and_compare(board, other, {.mode = static_cast<Mode>(random.below(5))});
        board.upload(scene.triangles);
      }
    }
  }
}

}  // namespace
}  // namespace cde::testing
