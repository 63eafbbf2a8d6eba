// SPDX-License-Identifier: Apache-2.0
// The object tables over the local bus, below the driver: what the card refuses, and that no access
// hangs it.
#include <cstring>

#include "moving_cases.hpp"

namespace cde::testing {
namespace {

using namespace card;

class ObjectTableBus : public ::testing::Test {
 protected:
  void SetUp() override {
    board_.upload(scene_.secondaries);
    board_.load(scene_.primaries);
    board_.write_register(kRegCommand, kModeNearest);
    board_.write_register(kRegPrimCount, scene_.primaries.size());
  }

  void write_range(std::uint32_t table, unsigned entry, std::uint32_t first, std::uint32_t count) {
    board_.write_register(table + entry * 64, std::uint64_t{count} << 32 | first);
  }
  void write_transform(std::uint32_t table, unsigned entry, const Transform& transform) {
    const auto words = to_words(transform);
    std::array<std::uint64_t, 6> beats;
    std::memcpy(beats.data(), words.data(), sizeof beats);
    board_.bus_write(kSpaceReg, table + entry * 64 + 8, beats);
  }
  /// Starts a pass at once: the check of the last transform may still be pending.
  bool refused(std::uint64_t objects, std::uint64_t primary_objects = 0) {
    board_.write_register(kRegObjectCount, objects);
    board_.write_register(kRegPrimObjectCount, primary_objects);
    return go_is_refused();
  }
  bool go_is_refused() {
    board_.write_register(kRegControl, kControlGo);
    const std::uint64_t status = board_.read_register(kRegStatus);
    board_.write_register(kRegControl, kControlAbort | kControlClear);
    while ((board_.read_register(kRegStatus) & 1) != 0) {
    }
    board_.write_register(kRegControl, kControlAbort | kControlClear);
    return (status >> kStatusCommandError & 1) != 0;
  }

  Random random_;
  MovingRays scene_ = rays(random_, 20, 30);
  Board board_ = Board::open(config_of(kSlowHost));
};

TEST_F(ObjectTableBus, EntriesOutOfContract_AreRefused) {
  EXPECT_TRUE(refused(0)) << "no range in the registers either";
  EXPECT_TRUE(refused(1)) << "never written";
  write_range(kObjectTable, 0, 0, 30);
  EXPECT_TRUE(refused(1)) << "no transform";
  write_transform(kObjectTable, 0, motion(random_));
  EXPECT_FALSE(refused(1));
  EXPECT_TRUE(refused(2));
  EXPECT_TRUE(refused(1025));
  EXPECT_TRUE(refused(~std::uint64_t{0}));
  EXPECT_TRUE(refused(std::uint64_t{1} << 32 | 1));
  write_transform(kObjectTable, 1, {});
  // 4,000 triangles fit DDR.
  struct Range {
    std::uint32_t first, count;
    bool fits;
  };
  for (const Range r : {Range{0, 4000, true},
                        {3999, 1, true},
                        {0, 4001, false},
                        {4000, 1, false},
                        {7, 0, false},
                        {0xffffffff, 1, false},
                        {0xffffffff, 2, false},
                        {0, 0xffffffff, false},
                        {0x80000000, 0x80000000, false}}) {
    write_range(kObjectTable, 1, r.first, r.count);
    EXPECT_EQ(refused(2), !r.fits) << r.first << " " << r.count;
  }
  write_range(kObjectTable, 1, 0, 1);
  // Go comes one cycle after the last word and waits for the check.
  for (unsigned k = 0; k < 12; ++k) {
    for (const float x : {std::numeric_limits<float>::quiet_NaN(), 1.00001f, 3e38f}) {
      Transform transform = motion(random_);
      auto words = to_words(transform);
      words[k] = x;
      transform = from_words<Transform>(words);
      board_.write_register(kRegObjectCount, 2);
      write_transform(kObjectTable, 1, transform);
      EXPECT_EQ(go_is_refused(), defect(transform).has_value()) << k << " " << x;
      write_transform(kObjectTable, 1, {});
      EXPECT_FALSE(go_is_refused());
    }
  }
  // Each of the six dot products of columns separately: one column of another length, then two
  // columns that are not perpendicular.
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) {
      Transform transform;
      if (i == j)
        transform.rotation(i, i) = 0.5f;
      else
        transform.rotation(i, j) = 0.6f, transform.rotation(j, j) = 0.8f;
      ASSERT_TRUE(defect(transform));
      board_.write_register(kRegObjectCount, 2);
      write_transform(kObjectTable, 1, transform);
      EXPECT_TRUE(go_is_refused()) << "columns " << i << " and " << j;
      write_transform(kObjectTable, 1, {});
      EXPECT_FALSE(go_is_refused());
    }
  // 256 primaries fit the register file.
  write_transform(kPrimObjectTable, 0, {});
  EXPECT_TRUE(refused(1, 1));
  write_range(kPrimObjectTable, 0, 255, 1);
  EXPECT_FALSE(refused(1, 1));
  write_range(kPrimObjectTable, 0, 255, 2);
  EXPECT_TRUE(refused(1, 1));
  EXPECT_FALSE(refused(1, 0));
}

TEST_F(ObjectTableBus, ReadsOrWritesWhileBusy_AreRefused) {
  write_range(kObjectTable, 0, 0, 4000);  // long enough for the accesses below
  write_transform(kObjectTable, 0, {});
  const auto fault = [&] {
    const std::uint64_t status = board_.read_register(kRegStatus);
    const std::uint64_t address = board_.read_register(kRegFaultAddr);
    board_.write_register(kRegControl, kControlClear);
    return (status >> kStatusBusError & 1) != 0 ? address : 0;
  };
  EXPECT_EQ(board_.read_register(kObjectTable), 0u);
  EXPECT_EQ(fault(), kObjectTable);
  EXPECT_EQ(board_.read_register(kPrimObjectTable + 8), 0u);
  EXPECT_EQ(fault(), kPrimObjectTable + 8);
  for (const std::uint32_t offset :
       {kObjectTable + 1024 * 64, kPrimObjectTable + 64 * 64, kObjectTable - 8, kObjectTable + 4}) {
    board_.write_register(offset, 0);
    EXPECT_EQ(fault(), offset);
  }
  board_.write_register(kRegObjectCount, 1);
  board_.write_register(kRegControl, kControlGo);
  for (const std::uint32_t offset :
       {kObjectTable, kPrimObjectTable + 8, std::uint32_t{kRegObjectCount},
        std::uint32_t{kRegPrimObjectCount}}) {
    board_.write_register(offset, 0);
    EXPECT_EQ(fault(), offset);
  }
  EXPECT_EQ(board_.read_register(kRegStatus) & 1, 1u) << "the pass ended before the accesses";
  board_.wait(1'000'000);
  EXPECT_EQ(board_.read_register(kRegRecords), 20u);
}

/// For any content of the tables the card answers, and the next scene is correct.
TEST_F(ObjectTableBus, Garbage_NeverHangsTheCard) {
  int started = 0;
  for (int round = 0; round < 200; ++round) {
    for (unsigned entry = 0; entry < 3; ++entry) {
      for (const std::uint32_t table : {kObjectTable, kPrimObjectTable}) {
        if (random_.below(4) != 0) write_transform(table, entry, motion(random_));
        if (random_.below(4) != 0) write_range(table, entry, random_.below(40), random_.below(30));
        if (random_.below(8) == 0) {
          const std::uint32_t beat = random_.below(8);
          board_.write_register(table + entry * 64 + beat * 8,
                                std::uint64_t{random_.bits()} << 32 | random_.bits());
        }
      }
    }
    board_.write_register(kRegObjectCount, random_.below(4));
    board_.write_register(kRegPrimObjectCount, random_.below(4));
    board_.write_register(kRegControl, kControlGo);
    board_.wait(random_.below(1500));
    started += (board_.read_register(kRegStatus) >> kStatusCommandError & 1) == 0 ? 1 : 0;
    board_.write_register(kRegControl, kControlAbort | kControlClear);
    for (int i = 0; i < 300 && (board_.read_register(kRegStatus) & 1) != 0; ++i) {
    }
    ASSERT_EQ(board_.read_register(kRegStatus) & 1, 0u);
    board_.write_register(kRegControl, kControlAbort | kControlClear);
  }
  EXPECT_GT(started, 20);
  const auto moving = objects(random_, 30, 5, false), posing = objects(random_, 20, 4, false);
  board_.set_objects(moving);
  board_.set_primary_objects(posing);
  check_pass(board_, Pair::kRayTriangle, false, scene_.primaries, scene_.secondaries, posing,
             moving);
}

/// After an abort in any cycle of posing or of the pass, the next pass is correct.
TEST_F(ObjectTableBus, AbortAtAnyCycle_NextPassIsCorrect) {
  std::vector<Object> moving = objects(random_, 30, 5, false),
                      posing = objects(random_, 20, 4, false);
  for (std::uint64_t cycles = 0; cycles < 700; cycles += cycles < 20 ? 1 : 23) {
    posing[1].transform = motion(random_);
    posing[2].count = 1;
    posing[2].first = random_.below(20);
    moving[3].transform = motion(random_);
    board_.set_objects(moving);
    board_.set_primary_objects(posing);
    board_.write_register(kRegObjectCount, moving.size());
    board_.write_register(kRegPrimObjectCount, posing.size());
    board_.write_register(kRegControl, kControlGo);
    board_.wait(cycles);
    board_.write_register(kRegControl, kControlAbort | kControlClear);
    while ((board_.read_register(kRegStatus) & 1) != 0) {
    }
    board_.write_register(kRegControl, kControlAbort | kControlClear);
    SCOPED_TRACE(cycles);
    check_pass(board_, Pair::kRayTriangle, false, scene_.primaries, scene_.secondaries, posing,
               moving, {Mode::kNearest, Mode::kAll});
  }
}

}  // namespace
}  // namespace cde::testing
