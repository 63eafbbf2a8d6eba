// SPDX-License-Identifier: Apache-2.0
// Readers share the read port of DDR. Requests are random, held or withdrawn, and memory answers
// after random delays.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <deque>
#include <optional>

#include "DdrReaderAlone.h"
#include "DdrReaders.h"
#include "clocked.hpp"

namespace cde::testing {
namespace {

constexpr unsigned kReaders = 4, kNobody = 2, kUsed = 0b1011, kDepth = 8;  // as CMakeLists.txt has

/// Words in use, from a request's address.
std::uint32_t words_of(std::uint32_t word) {
  return word % 9 + 1;
}
/// Packs a request as card_pkg::ddr_request_t: 37 bits each, from the lowest bit on the address,
/// the valid bit, and the words in use.
template <class Words>
void put(Words& words, unsigned reader, bool asks, std::uint32_t word) {
  const std::uint64_t request =
      word | std::uint64_t{asks} << 32 | std::uint64_t{words_of(word)} << 33;
  for (unsigned bit = 0; bit < 37; ++bit) {
    const unsigned at = 37 * reader + bit;
    words[at / 32] = (words[at / 32] & ~(1u << at % 32)) |
                     static_cast<std::uint32_t>(request >> bit & 1) << at % 32;
  }
}
bool asks(std::uint64_t request) {
  return (request >> 32 & 1) != 0;
}
std::uint32_t word(std::uint64_t request) {
  return static_cast<std::uint32_t>(request);
}

/// An outstanding request to DDR.
struct Asked {
  unsigned reader;
  std::uint32_t word;
  unsigned due;
};

/// Readers and memory around the module, with checks in every cycle.
class Traffic {
 public:
  /// A reader starts a request in `asks` of 16 cycles. DDR answers an old enough request in
  /// `answers` of 16 cycles.
  void run(unsigned cycles, unsigned asks, unsigned answers) {
    for (const unsigned end = clock_ + cycles; clock_ < end; ++clock_) one(asks, answers);
  }
  void reset() {
    readers_->rst_i = 1;
    readers_->ready_i = 1;
    readers_->valid_i = 0;
    readers_.clock();
    readers_->rst_i = 0;
    asked_.clear();
    waited_ = {};
  }
  /// No reader starts a request, and all responses arrive.
  void drain() {
    wanted_ = {};
    for (unsigned i = 0; !asked_.empty() && i < 1000; ++i, ++clock_) one(0, 16);
    EXPECT_TRUE(asked_.empty());
    EXPECT_EQ(answered_, taken_);
  }

  std::array<unsigned, kReaders> taken_ = {}, answered_ = {}, longest_ = {};
  unsigned contended_ = 0, full_ = 0, withdrawn_ = 0, idle_ = 0, refused_ = 0;

 private:
  void one(unsigned asks, unsigned answers) {
    drive(asks, answers);
    readers_.settle();
    check_answer();
    check_request();
    readers_.clock();
  }

  void drive(unsigned asks, unsigned answers) {
    asking_ = 0;
    readers_->words_i = 0;
    for (unsigned r = 0; r < kReaders; ++r) {
      if (wanted_.at(r) && dice_.once_in(64)) {
        wanted_.at(r).reset();
        waited_.at(r) = 0;
        ++withdrawn_;
      }
      if (!wanted_.at(r) && dice_.below(16) < asks) wanted_.at(r) = next_++;
      asking_ |= unsigned{wanted_.at(r).has_value()} << r;
      put(readers_->readers_i, r, wanted_.at(r).has_value(),
          wanted_.at(r).value_or(0xdead0000u + r));
      words_.at(r) = dice_.below(10);
      readers_->words_i |= static_cast<SData>(words_.at(r) << 4 * r);
    }
    memory_ready_ = !dice_.once_in(4);
    readers_->ready_i = memory_ready_;
    readers_->valid_i =
        !asked_.empty() && asked_.front().due <= clock_ && dice_.below(16) < answers;
  }

  void check_answer() {
    if (readers_->valid_i == 0) {
      EXPECT_EQ(readers_->valid_o, 0u);
      return;
    }
    const Asked oldest = asked_.front();
    EXPECT_EQ(readers_->valid_o, 1u << oldest.reader) << "cycle " << clock_;
    EXPECT_EQ(readers_->words_o, words_.at(oldest.reader));
    ++answered_.at(oldest.reader);
    popped_ = true;
  }

  void check_request() {
    const unsigned asking = asking_ & kUsed;
    const bool room = asked_.size() < kDepth;
    full_ += !room;
    idle_ += asking == 0;
    contended_ += (asking & (asking - 1)) != 0;
    EXPECT_EQ(asks(readers_->request_o), asking != 0 && room) << "cycle " << clock_;
    if (asks(readers_->request_o)) {
      EXPECT_EQ(readers_->request_o >> 33, words_of(word(readers_->request_o)));
    }
    if (!asks(readers_->request_o) || !memory_ready_) {
      EXPECT_EQ(readers_->ready_o, 0u);
      refused_ += asks(readers_->request_o);
    } else {
      const unsigned ready = readers_->ready_o;
      ASSERT_TRUE(ready != 0 && (ready & (ready - 1)) == 0 && (ready & ~asking) == 0) << ready;
      const auto r = static_cast<unsigned>(__builtin_ctz(ready));
      EXPECT_EQ(word(readers_->request_o), *wanted_.at(r));
      for (unsigned other = 0; other < kReaders; ++other)
        if (other != r && (asking >> other & 1) != 0)
          longest_.at(other) = std::max(longest_.at(other), ++waited_.at(other));
      asked_.push_back({r, *wanted_.at(r), clock_ + 1 + dice_.below(6)});
      wanted_.at(r).reset();
      waited_.at(r) = 0;
      ++taken_.at(r);
    }
    if (popped_) asked_.pop_front();
    popped_ = false;
  }

  Clocked<DdrReaders> readers_;
  Dice dice_;
  std::array<std::optional<std::uint32_t>, kReaders> wanted_;
  std::array<unsigned, kReaders> waited_ = {}, words_ = {};  // waited_: other requests meanwhile
  std::deque<Asked> asked_;
  std::uint32_t next_ = 0x1000;
  unsigned clock_ = 0, asking_ = 0;
  bool popped_ = false, memory_ready_ = true;
};

TEST(DdrReaders, RandomTraffic_LosesNothingAndStarvesNoReader) {
  Traffic traffic;
  traffic.reset();
  for (const auto& [asks, answers] :
       {std::pair{16u, 16u}, {16u, 4u}, {3u, 16u}, {8u, 8u}, {1u, 2u}, {16u, 1u}})
    traffic.run(4000, asks, answers);
  traffic.drain();
  for (unsigned r = 0; r < kReaders; ++r) {
    SCOPED_TRACE(r);
    if (r == kNobody) {
      EXPECT_EQ(traffic.taken_.at(r), 0u);
      continue;
    }
    EXPECT_GT(traffic.taken_.at(r), 2000u);
    EXPECT_EQ(traffic.longest_.at(r), 2u)
        << "requests of other readers served before one of this reader";
  }
  EXPECT_GT(traffic.contended_, 10'000u);
  EXPECT_GT(traffic.full_, 1000u);
  EXPECT_GT(traffic.withdrawn_, 500u);
  EXPECT_GT(traffic.idle_, 100u);
  EXPECT_GT(traffic.refused_, 1000u);
}

/// Responses outstanding at a reset reach no reader.
TEST(DdrReaders, Reset_ForgetsOutstandingResponses) {
  Traffic traffic;
  for (int i = 0; i < 20; ++i) {
    traffic.reset();
    traffic.run(30, 16, 3);
  }
  traffic.reset();
  traffic.answered_ = traffic.taken_;
  traffic.run(500, 8, 8);
  traffic.drain();
}

TEST(DdrReaders, LoneReader_IsAlwaysServed) {
  Clocked<DdrReaderAlone> readers;
  Dice dice;
  unsigned read = 0, valid = 0;
  for (int i = 0; i < 1000; ++i) {
    readers->rst_i = dice.once_in(50);
    const unsigned asking = dice.below(4), first = dice.below(1u << 31),
                   second = dice.below(1u << 31);
    put(readers->readers_i, 0, (asking & 1) != 0, first);
    put(readers->readers_i, 1, (asking & 2) != 0, second);
    readers->words_i = static_cast<CData>(dice.below(256));
    readers->valid_i = dice.once_in(2);
    readers->ready_i = dice.once_in(2);
    readers.settle();
    EXPECT_EQ(readers->ready_o, 2u * readers->ready_i);
    EXPECT_EQ(asks(readers->request_o), (asking & 2) != 0);
    EXPECT_EQ(word(readers->request_o), second);
    EXPECT_EQ(readers->valid_o, readers->valid_i << 1);
    EXPECT_EQ(readers->words_o, readers->words_i >> 4);
    read += asks(readers->request_o);
    valid += readers->valid_i;
    readers.clock();
  }
  EXPECT_TRUE(read > 300 && read < 700 && valid > 300 && valid < 700);
}

}  // namespace
}  // namespace cde::testing
