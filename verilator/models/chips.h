// The memory chips of the board: DDR and SRAM on the ports of board.sv.
#pragma once
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <deque>
#include <utility>
#include <vector>

#include "Vmodel.h"
#include "parameters.h"
#include "sparse_memory.h"

/// Called around every clock of the core, in this order: before(), the clock falls, at(), the clock
/// rises, after().
class Chips {
 public:
  explicit Chips(uint32_t ddr_latency)
      : ddr_(kDdrBytes + 64),
        check_(kEcc ? kDdrBytes / 4 + 64 : 1),
        sram_(kSramBytes * (kRecord / 28)),
        pending_(ddr_latency, kNone) {}

  void reset() {
    std::fill(pending_.begin(), pending_.end(), kNone);
    held_.clear();
    if (hang_ == kUntilReset) hang_ = 0;
  }
  /// DDR gives no data for so many clocks, all ones: until reset. What is asked for comes later.
  void hang(uint32_t clocks) { hang_ = clocks; }
  [[nodiscard]] uint64_t hung() const { return hung_; }  // clocks, so far
  SparseMemory& ddr() { return ddr_; }
  /// Check bits of DDR, a byte a word; null where there are none.
  SparseMemory* check() { return kEcc ? &check_ : nullptr; }
  SparseMemory& sram() { return sram_; }

  /// What DDR answers in this clock was asked for earlier.
  void before(Vmodel& m) {
    slot_ = clock_++ % pending_.size();
    const uint64_t word = delayed(std::exchange(pending_[slot_], kNone));
    m.ddr_valid_i = word != kNone;
    if (word == kNone) return;
    if (const uint8_t* p = ddr_.at(word * (sizeof(m.ddr_data_i) / 9), sizeof(m.ddr_data_i)))
      std::memcpy(&m.ddr_data_i, p, sizeof(m.ddr_data_i));
    if (kEcc)
      if (const uint8_t* p = check_.at(word, 9)) std::memcpy(&m.ddr_check_i, p, 9);
  }
  void at(const Vmodel& m) {
    if (m.ddr_read_o) pending_[slot_] = m.ddr_read_word_o;
    if (m.ddr_write_o)
      if (uint8_t* p = ddr_.at(m.ddr_write_addr_o, 8)) std::memcpy(p, &m.ddr_write_data_o, 8);
    if (kEcc && m.ddr_write_o) {
      constexpr uint64_t kWords = 72 / sizeof(m.ddr_data_i);
      if (uint8_t* p = check_.at(m.ddr_write_addr_o / 8 * kWords, kWords))
        std::memcpy(p, &m.ddr_write_check_o, kWords);
    }
    if (m.sram_write_o)
      if (uint8_t* p = sram_.at(m.sram_write_addr_o * kRecord, kRecord))
        std::memcpy(p, &m.sram_write_data_o, kRecord);
    fetched_ = m.sram_read_o ? sram_.at(m.sram_read_addr_o * kRecord, kRecord) : nullptr;
  }
  void after(Vmodel& m) {
    if (fetched_ != nullptr) std::memcpy(&m.sram_read_data_i, fetched_, kRecord);
  }

 private:
  /// The word whose data is given now, if `due` is the one that should be.
  uint64_t delayed(uint64_t due) {
    if (hang_ == 0 && held_.empty()) return due;
    if (due != kNone) held_.push_back(due);
    if (hang_ != 0) {
      if (hang_ != kUntilReset) --hang_;
      ++hung_;
      return kNone;
    }
    const uint64_t first = held_.front();
    held_.pop_front();
    return first;
  }

  static constexpr uint64_t kNone = ~0ull;
  static constexpr uint32_t kUntilReset = ~0u;
  static constexpr uint64_t kDdrBytes = 2'000'000'000;
  static constexpr uint64_t kSramBytes = 7 * 2097152;
  static constexpr uint64_t kRecord = sizeof(Vmodel::sram_write_data_o);
  static constexpr bool kEcc = parameter("ECC", 0) != 0;  // a byte of check bits a word
  SparseMemory ddr_, check_, sram_;
  std::vector<uint64_t> pending_;
  std::deque<uint64_t> held_;  // asked for while DDR hung
  uint32_t hang_ = 0;
  const uint8_t* fetched_ = nullptr;
  uint64_t clock_ = 0, slot_ = 0, hung_ = 0;
};
