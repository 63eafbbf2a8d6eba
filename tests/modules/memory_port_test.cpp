// SPDX-License-Identifier: Apache-2.0
// Reads and writes of the board through a memory of 16 bits that stalls and answers late.
#include <gtest/gtest.h>

#include <array>
#include <deque>
#include <vector>

#include "MemoryPort.h"
#include "clocked.hpp"

namespace cde::testing {
namespace {

constexpr unsigned kWords = 9, kSize = 256;  // words of the port, and of the memory

/// The board's side and the memory's side of the port.
class Traffic {
 public:
  Traffic() : memory_(2 * kSize + 2 * kWords) {
    for (auto& half : memory_) half = static_cast<std::uint16_t>(dice_.below(1u << 16));
    should_ = memory_;
    port_->rst_i = 1;
    port_->read_i = port_->write_i = port_->valid_i = port_->ready_i = 0;
    port_.clock();
    port_->rst_i = 0;
  }

  /// In each cycle the memory is ready with a chance of `ready` in 16, and answers in `answers`.
  void run(unsigned cycles, unsigned ready, unsigned answers) {
    for (unsigned i = 0; i < cycles; ++i, ++clock_) one(ready, answers);
  }
  void drain() {
    asks_ = false;
    for (unsigned i = 0; i < 1000; ++i, ++clock_) one(16, 16);
    asks_ = true;
    EXPECT_TRUE(wanted_.empty());
    EXPECT_EQ(memory_, should_);
  }

  unsigned reads = 0, writes = 0, accesses = 0;

 private:
  struct Want {
    std::uint32_t word;
    unsigned words;
    std::array<std::uint32_t, kWords> data;
  };
  struct Answer {
    std::uint16_t data;
    unsigned due;
  };

  void one(unsigned ready, unsigned answers) {
    if (asks_ && !asking_ && dice_.once_in(3)) ask();
    port_->read_i = asking_ && !writing_;
    port_->write_i = asking_ && writing_;
    port_->ready_i = dice_.below(16) < ready;
    const bool answer =
        !answers_.empty() && answers_.front().due <= clock_ && dice_.below(16) < answers;
    port_->valid_i = answer;
    port_->data_i =
        answer ? answers_.front().data : static_cast<std::uint16_t>(dice_.below(1u << 16));
    port_.settle();
    if (answer) answers_.pop_front();
    if (asking_ && port_->ready_o != 0) take();
    if (port_->access_o != 0 && port_->ready_i != 0) access();
    if (port_->valid_o != 0) check();
    port_.clock();
  }
  void ask() {
    asking_ = true;
    writing_ = dice_.once_in(4);
    port_->read_word_i = dice_.below(kSize);
    port_->read_words_i = static_cast<CData>(1 + dice_.below(kWords));
    port_->write_addr_i = 8 * dice_.below(kSize / 2);
    port_->write_data_i = dice_.below(~0u) | std::uint64_t{dice_.below(~0u)} << 32;
  }
  /// A write counts for all later reads. Reads that are under way were taken before it.
  void take() {
    asking_ = false;
    if (writing_) {
      ++writes;
      for (unsigned h = 0; h < 4; ++h)
        should_.at(port_->write_addr_i / 2 + h) =
            static_cast<std::uint16_t>(port_->write_data_i >> 16 * h);
      return;
    }
    ++reads;
    Want want{port_->read_word_i, port_->read_words_i, {}};
    for (unsigned w = 0; w < want.words; ++w)
      want.data.at(w) = should_.at(2 * (want.word + w)) |
                        std::uint32_t{should_.at(2 * (want.word + w) + 1)} << 16;
    wanted_.push_back(want);
  }
  void access() {
    ++accesses;
    const std::uint32_t half = port_->addr_o;
    ASSERT_LT(half, memory_.size());
    if (port_->write_o != 0)
      memory_.at(half) = static_cast<std::uint16_t>(port_->data_to_memory_o);
    else
      answers_.push_back({memory_.at(half), clock_ + 1 + dice_.below(8)});
  }
  void check() {
    ASSERT_FALSE(wanted_.empty());
    const Want want = wanted_.front();
    wanted_.pop_front();
    for (unsigned w = 0; w < want.words; ++w)
      ASSERT_EQ(port_->data_o[w], want.data.at(w)) << "word " << want.word + w;
  }

  Clocked<MemoryPort> port_;
  Dice dice_;
  std::vector<std::uint16_t> memory_, should_;
  std::deque<Want> wanted_;
  std::deque<Answer> answers_;
  unsigned clock_ = 0;
  bool asks_ = true, asking_ = false, writing_ = false;
};

TEST(MemoryPort, RandomTraffic_EqualsTheMemory) {
  Traffic traffic;
  for (const auto& [ready, answers] : {std::pair{16u, 16u}, {4u, 16u}, {16u, 4u}, {9u, 9u}})
    traffic.run(20'000, ready, answers);
  traffic.drain();
  EXPECT_GT(traffic.reads, 1000u);
  EXPECT_GT(traffic.writes, 300u);
}

/// A memory that is always ready has an access in almost every cycle.
TEST(MemoryPort, BusyPort_WastesFewCycles) {
  Traffic traffic;
  traffic.run(10'000, 16, 16);
  EXPECT_GT(traffic.accesses, 8'000u);
}

}  // namespace
}  // namespace cde::testing
