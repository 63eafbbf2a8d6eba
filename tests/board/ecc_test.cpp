// SPDX-License-Identifier: Apache-2.0
// Check bits in DDR: the effect of flipped bits with and without them.
#include <fmt/format.h>

#include "cases.hpp"
#include "cde/support/error.hpp"

namespace cde::testing {
namespace {

BoardConfig ecc_config() {
  BoardConfig c = small_config();
  c.ecc = true;
  return c;
}

class Ecc : public ::testing::Test {
 protected:
  Ecc() : board_(Board::open(ecc_config())), scene_(beam(random_, 40, 60)) {
    board_.upload(scene_.triangles);
    board_.load(scene_.rays);
    expected_ = board_.run({.mode = Mode::kAll});
  }
  void expect_same(const std::vector<Record>& records) const {
    ASSERT_EQ(records.size(), expected_.size());
    for (std::size_t i = 0; i < records.size(); ++i)
      ASSERT_TRUE(same_bits(records[i], expected_[i])) << i;
  }
  Board board_;
  Random random_;
  RayScene scene_;
  std::vector<Record> expected_;
};

TEST_F(Ecc, AnySingleBitOfASlot_IsCorrectedAndCounted) {
  for (unsigned bit = 0; bit < 288; ++bit) {
    SCOPED_TRACE(bit);
    const std::uint64_t byte = 36 * random_.below(60) + bit / 8;
    const auto mask = static_cast<std::uint8_t>(1u << bit % 8);
    board_.flip_ddr(byte, mask);
    Counters counters;
    expect_same(board_.run({.mode = Mode::kAll}, &counters));
    EXPECT_EQ(counters.corrected_words, 1u);
    board_.flip_ddr(byte, mask);
  }
  Counters counters;
  expect_same(board_.run({.mode = Mode::kAll}, &counters));
  EXPECT_EQ(counters.corrected_words, 0u);
}

TEST_F(Ecc, OneBitInManyWords_IsCorrected) {
  for (unsigned word = 0; word < 60 * 9; ++word)
    board_.flip_ddr(4 * word + random_.below(4), static_cast<std::uint8_t>(1u << random_.below(8)));
  Counters counters;
  expect_same(board_.run({.mode = Mode::kAll}, &counters));
  EXPECT_EQ(counters.corrected_words, 60u * 9);
}

TEST_F(Ecc, TwoBitsOfAWord_GiveOneErrorAndNoWrongRecord) {
  for (unsigned i = 0; i < 32 * 31 / 2; ++i) {
    unsigned one = 0, two = 0, n = i;
    while (n >= 31 - one) n -= 31 - one++;
    two = one + 1 + n;
    SCOPED_TRACE(fmt::format("bits {} and {}", one, two));
    const unsigned slot = random_.below(60);
    const std::uint64_t word = std::uint64_t{slot} * 36 + 4 * random_.below(9);
    for (const unsigned bit : {one, two})
      board_.flip_ddr(word + bit / 8, static_cast<std::uint8_t>(1u << bit % 8));
    std::vector<Record> records;
    try {
      (void)board_.run({.mode = Mode::kAll}, [&](std::span<const Record> some) {
        records.insert(records.end(), some.begin(), some.end());
      });
      FAIL() << "no error for two wrong bits";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kDevice);
      EXPECT_NE(std::string(error.what()).find("1 word of DDR"), std::string::npos) << error.what();
      ASSERT_TRUE(error.fault());
      EXPECT_EQ(error.fault()->address, 36 * slot) << error.what();
    }
    for (std::size_t k = 0; k < records.size(); ++k) {
      if (k / 40 == slot) {
        EXPECT_TRUE(records[k].bad) << k;
      } else {
        ASSERT_TRUE(same_bits(records[k], expected_[k])) << k;
      }
    }
    for (const unsigned bit : {one, two})
      board_.flip_ddr(word + bit / 8, static_cast<std::uint8_t>(1u << bit % 8));
  }
}

TEST_F(Ecc, CheckBitFlip_IsCorrectedAndCounted) {
  for (unsigned bit = 0; bit < 7; ++bit) {
    const std::uint64_t word = random_.below(9 * 60);
    board_.flip_check(word, static_cast<std::uint8_t>(1u << bit));
    Counters counters;
    expect_same(board_.run({.mode = Mode::kAll}, &counters));
    EXPECT_EQ(counters.corrected_words, 1u);
    board_.flip_check(word, static_cast<std::uint8_t>(1u << bit));
  }
  EXPECT_THROW(board_.flip_check(9000, 1), Error) << "DDR has 9,000 words only";
  EXPECT_THROW(board_.flip_check(0, 0x80), Error) << "a word has 7 check bits only";
  EXPECT_THROW(board_.flip_ddr(36'000, 1), Error);
}

TEST(WithoutEcc, FlipCheck_Throws) {
  Board board = Board::open(small_config());
  EXPECT_THROW(board.flip_check(0, 1), Error);
}

TEST(WithoutEcc, FlippedBit_ChangesRecords) {
  Board board = Board::open(small_config());
  Random random;
  const RayScene scene = beam(random, 40, 60);
  board.upload(scene.triangles);
  board.load(scene.rays);
  const auto expected = board.run({.mode = Mode::kNearest});
  for (unsigned slot = 0; slot < 60; ++slot) board.flip_ddr(36 * slot + 2, 0x40);
  const auto got = board.run({.mode = Mode::kNearest});
  std::size_t differ = 0;
  for (std::size_t i = 0; i < got.size(); ++i) differ += same_bits(got[i], expected[i]) ? 0 : 1;
  EXPECT_GT(differ, 0u) << "no flip changed a record";
}

}  // namespace
}  // namespace cde::testing
